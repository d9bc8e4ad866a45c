"""Polygons that stand in for the true curve of disc fingers, and what is solved from them.

Coarse polygons, an outer one (tangents) and an inner one (chords), name the minima and punctures;
they are solved on the true curve; the inner polygon is drawn again through the contacts of its
punctures, until no new ones appear, and through those that the outer one names when it is drawn
through the same contacts. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.discs.arc_stops import RESTING
from icage.discs.brackets import local_cage_on, quadrant_chord
from icage.discs.critical import Critical, CriticalHands
from icage.discs.curve import TrueCurve
from icage.discs.hidden import hidden_minima
from icage.discs.offsets import directions_on_arcs, offsets
from icage.discs.true_levels import REACH, SAME, TrueLevels, true_levels
from icage.errors import GeometryError
from icage.method import LocalCage, Method
from icage.outline import Outline

_COARSE = 4
"""Segments a quadrant of the outer polygon that only bounds a level, tried first. For one that
names features 4 are too few: of 600 targets two then had a wrong sigma_first or one grasp twice."""

_ROUNDS = 4
"""Times that an inner polygon is drawn again through new punctures."""

_PASSES = 8
"""Times that an inner polygon is drawn again through punctures that an outer one has named. More
than one only if that many levels are equal but for a chord's error."""

_THROUGH = 1e-6
"""[diameter] A polygon goes through a contact if it was drawn through a point this near to it."""

TIGHT = 1e-6
"""[1] Where a polygon's level is lower by more (relative) than that of its puncture on the true
curve, another puncture may lie between, unless polygon after polygon leads to the same levels."""

INSIDE = 1e-9
"""[1] A solved level may be this little (relative) outside its bracket: rounding."""


class Solved(NamedTuple):
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


class Bound(NamedTuple):
    """What encloses the solved levels from above, and the levels solved from tangents."""

    local_cage: LocalCage
    levels: TrueLevels
    """Of the outer polygon that names features."""
    own: Solved | None
    """The last outer polygon whose own levels are not those that it encloses, but solved."""


@dataclass(frozen=True, slots=True)
class Polygons:
    """The polygons of one resolution that stand in for the true curve."""

    curve: TrueCurve
    critical: CriticalHands
    method: Method
    contacts: FloatArray
    true: FloatArray
    target: Critical | None
    resting: FloatArray
    """Those of the contacts ``true`` (k, 2) that are on an arc."""
    segments: int

    def levels(self) -> tuple[Solved | Cage | None, Bound | None]:
        """The levels from chords and what encloses them; see ``inner_levels`` and ``bound``."""
        outer = self.outer_levels()
        through = self.begin(outer)
        for _ in range(_PASSES - 1):
            inner = self.inner_levels(through)
            if not isinstance(inner, Solved):
                return inner, None
            bound = self.bound(outer, inner)
            more = self.named_by(bound, inner)
            if not len(more):
                return inner, bound
            through = np.vstack([inner.through, more])
        inner = self.inner_levels(through)
        return inner, self.bound(outer, inner) if isinstance(inner, Solved) else None

    def outer_levels(self, through: FloatArray | None = None) -> Solved | None:
        """The levels from the tangents through the target; None if these do not hold it."""
        if through is None:
            through = self.resting
        local_cage = self._local_cage(self._outer_polygon(self.segments, through), self.segments)
        if local_cage is None:
            return None
        cage = self._cage(local_cage)
        if cage.status == "not_a_cage":
            return None
        return self._solved(local_cage, cage, through, self.segments)

    def begin(self, outer: Solved | None) -> FloatArray:
        """Contacts (k, 2) on arcs that an inner polygon is drawn through first."""
        through = self.resting
        if outer is not None:
            through = np.vstack([through, self._new_on_arcs(outer, through, hidden=True)])
        return through

    def inner_levels(self, through: FloatArray) -> Solved | Cage | None:
        """The levels from chords through these contacts (k, 2) and those of their own punctures.

        A cage, or rather none, if that ends the matter; None if only finer polygons can tell.
        """
        found: Solved | None = None
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
            cage = self._cage(local_cage)
            if cage.status == "not_a_cage":
                return replace(cage, contacts=self.contacts)
            found = self._solved(local_cage, cage, through, self.segments)
            new = self._new_on_arcs(found, through)
            if not len(new):
                break
            # other punctures of the same levels: symmetry
            if last is not None and agree(last, found.levels):
                found = found._replace(again=True)
                break
            last = found.levels
            through = np.vstack([through, new])
        return found

    def bound(self, coarse: Solved | None, inner: Solved) -> Bound | None:
        """The outer polygon that encloses the levels of an inner one; None without one."""
        levels = inner.levels
        if coarse is None or not (levels.first_solved and levels.max_solved):
            return None
        if not agree(levels, coarse.levels):
            coarse = self.outer_levels(inner.through)
            if coarse is None:
                return None
        outer, through = coarse.local_cage, coarse.through
        own: Solved | None = None
        more = inner.through[len(through) :]
        for _ in range(_ROUNDS):
            if _encloses(outer, levels):
                break
            if len(more):
                through = np.vstack([through, more])
                drawn = self._drawn_close(through, levels.sigma_max)
                if drawn is None:
                    return None
                outer, segments = drawn
                if _encloses(outer, levels):
                    break
                cage = self._cage(outer)
                if cage.status == "not_a_cage":
                    break
                own = self._solved(outer, cage, through, segments)
            else:
                own = coarse
            more = self._new_on_arcs(own, through)
            # others of the same level are only drawn through, others of another one tell more
            if not len(more) or not agree(own.levels, levels):
                break
        return Bound(outer, coarse.levels, own)

    def _drawn_close(
        self, through: FloatArray, level: float | None
    ) -> tuple[LocalCage, int] | None:
        """The outer polygon through these contacts (k, 2), and its segments: few if these will do.

        None if the target is held by none.
        """
        found: list[tuple[LocalCage, int]] = []
        for segments in (_COARSE, self.segments):
            polygon = self._outer_polygon(segments, through)
            local_cage = self._local_cage(polygon, segments)
            if local_cage is not None:
                found.append((local_cage, segments))
                if near(_finite(local_cage.sigma_max), level, TIGHT):
                    break
        return min(found, key=lambda one: one[0].sigma_max, default=None)

    def named_by(self, bound: Bound | None, inner: Solved) -> FloatArray:
        """Contacts (k, 2) of other punctures that the outer polygon takes for the levels.

        Of two punctures on one way out the higher one is the level. Where they are nearly equal an
        inner polygon through the contacts of the lower one alone may have them the other way round.
        """
        if bound is None or bound.own is None or agree(bound.own.levels, inner.levels):
            return np.empty((0, 2))
        return self._new_on_arcs(bound.own, inner.through)

    def _cage(self, local_cage: LocalCage) -> Cage:
        """The cage on one polygon; its way out is not asked for, the bound from above has one."""
        return local_cage.cage(self.contacts, self.curve.outline, self.curve.radius, way=False)

    def _local_cage(self, polygon: Outline, segments: int) -> LocalCage | None:
        """What is round the target, which rests on short chords or else anywhere on long ones."""
        chords = [0.0]
        if len(self.resting):
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

    def _solved(
        self, local_cage: LocalCage, cage: Cage, through: FloatArray, segments: int
    ) -> Solved:
        sagitta = self.curve.sagitta(segments)
        levels = true_levels(self.critical, cage, sagitta, self.target)
        return Solved(local_cage, cage, levels, through, sagitta)

    def _new_on_arcs(
        self, found: Solved, through: FloatArray, *, hidden: bool = False
    ) -> FloatArray:
        """Contacts (k, 2) on arcs that the polygons are to be drawn through and were not.

        Those of the first and of the last puncture, and, if ``hidden``, of minima that the
        polygon hides.
        """
        levels = found.levels
        ends = [*levels.punctures[:1], *levels.punctures[1:][-1:]]
        wanted = [self.true, *(p.contacts for p in ends)]
        reach = REACH * found.sagitta
        apart = SAME * self.critical.size
        for one in hidden_minima(self.critical, found.cage, reach) if hidden else []:
            if all(np.abs(one.contacts - g.contacts).max() > apart for g in levels.grasps):
                wanted.append(one.contacts)
        kept: list[FloatArray] = list(through)
        for point in self.curve.on_arcs(np.vstack(wanted)):
            if all(np.hypot(*(point - q)) > _THROUGH * self.critical.size for q in kept):
                kept.append(point)
        return np.array(kept[len(through) :]).reshape(-1, 2)


def near(level: float | None, other: float | None, gap: float) -> bool:
    """Whether two levels, or none, are this near (relative)."""
    if level is None or other is None:
        return level == other
    return abs(level / other - 1.0) <= gap


def _finite(level: float) -> float | None:
    return level if np.isfinite(level) else None


def _encloses(outer: LocalCage, levels: TrueLevels) -> bool:
    """Whether the levels of an outer polygon are the solved ones: nothing is left between."""
    if not near(_finite(outer.sigma_max), levels.sigma_max, INSIDE):
        return False
    first = levels.sigma_first
    return first == levels.sigma_max or near(_finite(outer.sigma_first), first, INSIDE)


def agree(one: TrueLevels, other: TrueLevels) -> bool:
    """Whether two polygons have led to the same levels."""
    return near(one.sigma_first, other.sigma_first, INSIDE) and near(
        one.sigma_max, other.sigma_max, INSIDE
    )
