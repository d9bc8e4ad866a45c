"""The cage for disc fingers: levels solved on the true curve, two polygons as the certificate.

Coarse polygons, an outer one (tangents) and an inner one (chords), name the minima and punctures;
they are solved on the true curve; the inner polygon is drawn again through the contacts of its
punctures, until no new ones appear. Chords or tangents alone can hide a shallow minimum, so
the levels solved from either have to be the same. Then the escape levels of both polygons, drawn
through the same contacts, enclose the solved one. Where one of this fails finer polygons are tried,
and what does not come out at all is left to ``icage.discs.brackets``, which says between which
polygons' levels the truth lies. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, not_a_cage
from icage.discs.arc_stops import RESTING
from icage.discs.brackets import local_cage_on, plan_by_resolutions, quadrant_chord
from icage.discs.critical import Critical, CriticalHands
from icage.discs.curve import TrueCurve
from icage.discs.hidden import hidden_minima
from icage.discs.offsets import check_disc_contacts, directions_on_arcs, offsets
from icage.discs.true_levels import REACH, SAME, TrueLevels, true_levels
from icage.errors import GeometryError
from icage.geometry.way_out import least_gap_on
from icage.hand import HandShape
from icage.method import LocalCage, Method
from icage.outline import Outline
from icage.tolerance import NOT_A_CAGE, SIGMA_MAX_GAP, TARGET_SHIFT

SEGMENTS = (8, 24, 64)
"""Segments a quadrant of the coarse polygons, and of those that are tried where a level stays
unsolved, the two polygons disagree or the bracket is wide."""

_COARSE = 4
"""Segments a quadrant of the outer polygon that only bounds a level, tried first. For one that
names features 4 are too few: of 600 targets two then had a wrong sigma_first or one grasp twice."""

_ROUNDS = 4
"""Times that an inner polygon is drawn again through new punctures."""

_THROUGH = 1e-6
"""[diameter] A polygon goes through a contact if it was drawn through a point this near to it."""

_TIGHT = 1e-6
"""[1] Where a polygon's level is lower by more (relative) than that of its puncture on the true
curve, another puncture may lie between, unless polygon after polygon leads to the same levels."""

_INSIDE = 1e-9
"""[1] A solved level may be this little (relative) outside its bracket: rounding."""


def plan_discs(
    outline: Outline, hand: HandShape, contacts: FloatArray, radius: float, method: Method
) -> Cage:
    """The cage of disc fingers whose centres stand on ``contacts`` (3, 2)."""
    try:
        curve = TrueCurve.of(outline, radius)
        curve.inner(SEGMENTS[0])
    except GeometryError:
        check_disc_contacts(outline, radius, contacts)
        return plan_by_resolutions(outline, hand, contacts, radius, method)
    check_disc_contacts(outline, radius, contacts, curve)
    critical = CriticalHands(outline, radius, hand)
    target = _target(critical, contacts)
    true = contacts if target is None else target.contacts
    for segments in SEGMENTS:
        look = _Polygons(curve, critical, method, contacts, true, target, segments)
        outer = look.outer_levels()
        inner = look.inner_levels(outer)
        if isinstance(inner, Cage):
            return inner
        if inner is None:
            break
        cage = look.enclosed(outer, inner)
        if cage is not None:
            return cage
    return plan_by_resolutions(outline, hand, contacts, radius, method)


def _target(critical: CriticalHands, contacts: FloatArray) -> Critical | None:
    """The minimum on the true curve that the contacts are meant for."""
    found = critical.minimum(contacts, 2.0 * TARGET_SHIFT * critical.size)
    if found is None or found.level:
        return None
    far = float(np.hypot(*(found.contacts - contacts).T).max())
    return found if far <= TARGET_SHIFT * critical.size else None


class _Solved(NamedTuple):
    """What was found round the target on one polygon, and its levels solved on the true curve.

    ``again`` says whether another polygon before it had led to the same levels.
    """

    local_cage: LocalCage
    cage: Cage
    levels: TrueLevels
    through: FloatArray
    """(k, 2) contacts on arcs that the polygon was drawn through."""
    sagitta: float
    """[unit] How far the polygon lies off the curve at most."""
    again: bool = False


@dataclass(frozen=True, slots=True)
class _Polygons:
    """The polygons of one resolution that stand in for the true curve."""

    curve: TrueCurve
    critical: CriticalHands
    method: Method
    contacts: FloatArray
    true: FloatArray
    target: Critical | None
    segments: int

    def outer_levels(self, through: FloatArray | None = None) -> _Solved | None:
        """The levels from the tangents through the target; None if these do not hold it."""
        if through is None:
            through = self.curve.on_arcs(self.true)
        local_cage = self._local_cage(self._outer_polygon(self.segments, through), self.segments)
        if local_cage is None:
            return None
        cage = local_cage.cage(self.contacts, self.curve.outline, self.curve.radius)
        if cage.status == "not_a_cage":
            return None
        return self._solved(local_cage, cage, through)

    def inner_levels(self, outer: _Solved | None) -> _Solved | Cage | None:
        """The levels from chords through the contacts of their own punctures.

        A cage, or rather none, if that ends the matter; None if only finer polygons can tell.
        """
        through = self.curve.on_arcs(self.true)
        if outer is not None:
            through = np.vstack([through, self._new_on_arcs(outer, through, hidden=True)])
        found: _Solved | None = None
        last: TrueLevels | None = None
        for _ in range(_ROUNDS):
            polygon = self.curve.inner(self.segments, through)
            local_cage = self._local_cage(polygon, self.segments)
            if local_cage is None:
                if self.target is not None:
                    return None
                hand, curve = self.critical.hand, self.curve
                cage = self.method.cage(polygon, hand, self.contacts, curve.outline, curve.radius)
                return replace(cage, contacts=self.contacts)
            cage = local_cage.cage(self.contacts, self.curve.outline, self.curve.radius)
            if cage.status == "not_a_cage":
                return replace(cage, contacts=self.contacts)
            found = self._solved(local_cage, cage, through)
            new = self._new_on_arcs(found, through)
            # other punctures of the same levels: symmetry
            if last is not None and _agree(last, found.levels):
                found = found._replace(again=True)
                break
            if not len(new):
                break
            last = found.levels
            through = np.vstack([through, new])
        return found

    def enclosed(self, coarse: _Solved | None, inner: _Solved) -> Cage | None:
        """The cage of the solved levels, if both polygons agree to it and enclose it; else None."""
        cage, levels = inner.cage, inner.levels
        if coarse is None or not (levels.first_solved and levels.max_solved):
            return None
        if not _agree(levels, coarse.levels):
            coarse = self.outer_levels(inner.through)
            if coarse is None or not _agree(levels, coarse.levels):
                return None
        wide = SIGMA_MAX_GAP if inner.again else _TIGHT
        if not (
            _near(cage.sigma_max, levels.sigma_max, wide)
            and _near(levels.polygon_first, levels.sigma_first, wide)
        ):
            return None  # another puncture may be as near
        outer: LocalCage | None = coarse.local_cage
        if len(inner.through) > len(coarse.through) and not _near(
            outer.sigma_max, levels.sigma_max, _TIGHT
        ):
            for segments in (_COARSE, self.segments):
                polygon = self._outer_polygon(segments, inner.through)
                outer = self._local_cage(polygon, segments)
                if outer is not None and _near(outer.sigma_max, levels.sigma_max, _TIGHT):
                    break
        if outer is None:
            return None
        low, high, solved = cage.sigma_max, outer.sigma_max, levels.sigma_max
        if low is None or solved is None:
            return None if np.isfinite(high) else self._finished(inner, None, None)
        if not (np.isfinite(high) and _near(high, solved, SIGMA_MAX_GAP)):
            return None
        if not low * (1.0 - _INSIDE) <= solved <= high * (1.0 + _INSIDE):
            return None
        if solved / levels.sigma_0 - 1.0 < NOT_A_CAGE:
            why = f"too shallow to tell: sigma_max / sigma_0 is at most {high / levels.sigma_0:.9g}"
            outline, radius = self.curve.outline, self.curve.radius
            return not_a_cage(outline, self.critical.hand, self.contacts, why, radius)
        return self._finished(inner, max(high, solved), outer)

    def _finished(self, inner: _Solved, upper: float | None, outer: LocalCage | None) -> Cage:
        cage, levels = inner.cage, inner.levels
        target = levels.grasps[0].contacts
        path, gap = cage.escape_path, cage.min_finger_gap
        way = None if outer is None else outer.escape_path()
        if way is not None:
            path = np.vstack([levels.grasps[0].placement.as_array(), way[0]])
            gap = least_gap_on(cage.hand, path)
        work = cage.work
        if work is not None:
            work = replace(
                work,
                minimum_node=tuple(work.minimum_node[k] for k in levels.origin),
                polygon_first=np.inf if levels.polygon_joins is None else levels.polygon_joins,
                sagitta=inner.sagitta,
            )
        return replace(
            cage,
            contacts=target,
            sigma_0=levels.sigma_0,
            sigma_first=levels.sigma_first,
            sigma_max=levels.sigma_max,
            sigma_max_lower=cage.sigma_max,
            sigma_max_upper=upper,
            sigma_first_upper=levels.sigma_first,
            sigma_first_converged=True,
            adjusted_by=float(np.hypot(*(target - self.contacts).T).max()),
            punctures=levels.punctures,
            grasps=levels.grasps,
            escape_path=path,
            min_finger_gap=gap,
            warnings=_warnings(self.curve, levels),
            work=work,
        )

    def _local_cage(self, polygon: Outline, segments: int) -> LocalCage | None:
        """What is round the target, which rests on short chords or else anywhere on long ones."""
        chords = [0.0]
        if len(self.curve.on_arcs(self.true)):
            radius = self.curve.radius
            chords = [2.0 * RESTING * radius, quadrant_chord(radius, segments)]
        for chord in chords:
            found = local_cage_on(polygon, self.critical.hand, self.true, chord, self.method)
            if found is not None:
                return found
        return None

    def _outer_polygon(self, segments: int, through: FloatArray) -> Outline:
        """Tangents through these contacts; where two of them cross, the union of them all."""
        curve = self.curve
        try:
            return curve.outer(segments, through)
        except GeometryError:
            arcs = directions_on_arcs(curve.outline, curve.radius, through)
            return offsets(curve.outline, curve.radius, segments, arcs).outer

    def _solved(self, local_cage: LocalCage, cage: Cage, through: FloatArray) -> _Solved:
        sagitta = self.curve.sagitta(self.segments)
        levels = true_levels(self.critical, cage, sagitta, self.target)
        return _Solved(local_cage, cage, levels, through, sagitta)

    def _new_on_arcs(
        self, found: _Solved, through: FloatArray, *, hidden: bool = False
    ) -> FloatArray:
        """Contacts (k, 2) on arcs that the polygons are to be drawn through and were not.

        Those of the first and of the last puncture, and, if ``hidden``, of minima that the
        polygon hides.
        """
        levels = found.levels
        ends = [*levels.punctures[:1], *levels.punctures[1:][-1:]]
        wanted = [self.true, *(p.contacts for p in ends)]
        reach = REACH * found.sagitta
        near = SAME * self.critical.size
        for one in hidden_minima(self.critical, found.cage, reach) if hidden else []:
            if all(np.abs(one.contacts - g.contacts).max() > near for g in levels.grasps):
                wanted.append(one.contacts)
        kept: list[FloatArray] = list(through)
        for point in self.curve.on_arcs(np.vstack(wanted)):
            if all(np.hypot(*(point - q)) > _THROUGH * self.critical.size for q in kept):
                kept.append(point)
        return np.array(kept[len(through) :]).reshape(-1, 2)


def _near(level: float | None, other: float | None, gap: float) -> bool:
    """Whether two levels, or none, are this near (relative)."""
    if level is None or other is None:
        return level == other
    return abs(level / other - 1.0) <= gap


def _agree(one: TrueLevels, other: TrueLevels) -> bool:
    """Whether two polygons have led to the same levels."""
    return _near(one.sigma_first, other.sigma_first, _INSIDE) and _near(
        one.sigma_max, other.sigma_max, _INSIDE
    )


def _warnings(curve: TrueCurve, levels: TrueLevels) -> tuple[str, ...]:
    told: list[str] = []
    if levels.rough_first != levels.sigma_first:
        rough = "no level" if levels.rough_first is None else f"{levels.rough_first:.9g}"
        told.append(
            "sigma_first depends on how deep a minimum must be to count: "
            f"{levels.sigma_first:.9g} (1e-10 of the diameter, used), {rough} (1e-6)"
        )
    if curve.closed_pockets:
        told.append(f"the finger's radius closes {curve.closed_pockets} pocket(s) of the outline")
    if levels.unsolved:
        ids = ", ".join(str(k) for k in levels.unsolved)
        told.append(f"grasp(s) {ids} are those of a polygon, not solved on the true curve")
    return tuple(told)
