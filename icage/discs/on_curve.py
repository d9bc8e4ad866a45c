"""The cage for disc fingers: levels solved on the true curve, two polygons as the certificate.

A coarse inner polygon (chords) names the minima and punctures; they are solved on the true curve;
the polygon is drawn again through the contacts of its punctures, until no new ones appear. Then its
escape level and that of an outer polygon (tangents) through the same contacts enclose the solved
one. What does not come out so is left to ``icage.discs.brackets``, which says between which
polygons' levels the truth lies. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, not_a_cage
from icage.discs.brackets import plan_by_resolutions
from icage.discs.critical import Critical, CurveFeatures
from icage.discs.curve import TrueCurve
from icage.discs.offsets import check_disc_contacts, directions_on_arcs, offsets
from icage.discs.true_levels import TrueLevels, true_levels
from icage.errors import GeometryError
from icage.geometry.statics import no_depth_reason
from icage.geometry.way_out import least_gap_on
from icage.hand import HandShape
from icage.method import LocalCage, Method
from icage.outline import Outline
from icage.tolerance import NOT_A_CAGE, SIGMA_MAX_GAP, TARGET_SHIFT, TARGET_TURN

SEGMENTS = (8, 32)
"""Segments a quadrant of the coarse polygons, and of those that are tried where a level stays
unsolved or the bracket wide."""

_ROUNDS = 4
"""Times that an inner polygon is drawn again through new punctures."""

_THROUGH = 1e-6
"""[diameter] A polygon goes through a contact if it was drawn through a point this near to it."""

_INSIDE = 1e-9
"""[1] A solved level may be this little (relative) outside its bracket: rounding."""


@dataclass(frozen=True, slots=True)
class _Inner:
    """An inner polygon's cage and the levels solved from it."""

    cage: Cage
    levels: TrueLevels
    through: FloatArray
    segments: int


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
    features = CurveFeatures(outline, radius, hand)
    target = _target(features, contacts)
    true = contacts if target is None else target.contacts
    for segments in SEGMENTS:
        inner = _solved_inner(curve, features, hand, contacts, true, target, method, segments)
        if isinstance(inner, Cage):
            return inner
        if inner is None:
            break
        cage = _enclosed(curve, hand, contacts, true, inner, method)
        if cage is not None:
            return cage
    return plan_by_resolutions(outline, hand, contacts, radius, method)


def _target(features: CurveFeatures, contacts: FloatArray) -> Critical | None:
    """The minimum on the true curve that the contacts are meant for."""
    found = features.minimum(contacts, 2.0 * TARGET_SHIFT * features.size)
    if found is None or found.level:
        return None
    far = float(np.hypot(*(found.contacts - contacts).T).max())
    return found if far <= TARGET_SHIFT * features.size else None


def _local_cage(
    polygon: Outline, curve: TrueCurve, hand: HandShape, true: FloatArray, segments: int,
    method: Method,
) -> LocalCage | None:  # fmt: skip
    # on chords a contact of an arc may rest anywhere on its own chord
    arc = curve.radius if len(curve.on_arcs(true)) else 0.0
    chord = 2.0 * arc * 0.5 * np.pi / segments / polygon.diameter
    reach, turn = max(TARGET_SHIFT, chord), max(TARGET_TURN, 10.0 * chord)
    return method.local_cage(polygon, hand, true, reach, turn)


def _solved_inner(
    curve: TrueCurve, features: CurveFeatures, hand: HandShape, contacts: FloatArray,
    true: FloatArray, target: Critical | None, method: Method, segments: int,
) -> _Inner | Cage | None:  # fmt: skip
    """The inner polygon through the contacts of its own punctures, or what ends the matter."""
    through = curve.on_arcs(true)
    sagitta = curve.sagitta(segments)
    found: _Inner | None = None
    last: tuple[float | None, ...] = ()
    for _ in range(_ROUNDS):
        polygon = curve.inner(segments, through)
        local_cage = _local_cage(polygon, curve, hand, true, segments, method)
        if local_cage is None:
            if target is not None:
                return None
            cage = method.cage(polygon, hand, contacts, curve.outline, curve.radius)
            return replace(cage, contacts=contacts)
        cage = local_cage.cage(contacts, curve.outline, curve.radius)
        if cage.status == "not_a_cage":
            return replace(cage, contacts=contacts)
        if cage.work is not None:
            cage = replace(cage, work=replace(cage.work, sagitta=sagitta))
        levels = true_levels(features, cage, sagitta, target)
        found = _Inner(cage, levels, through, segments)
        new = _not_yet(curve.on_arcs(_puncture_contacts(levels)), through, features.size)
        solved = (levels.sigma_first, levels.sigma_max)
        if not len(new) or _same(last, solved):  # other punctures of the same levels: symmetry
            break
        last = solved
        through = np.vstack([through, new])
    return found


def _same(before: tuple[float | None, ...], now: tuple[float | None, ...]) -> bool:
    """Whether the levels of two polygons are the same."""
    return len(before) == len(now) and all(
        a == b or (a is not None and b is not None and abs(a / b - 1.0) <= _INSIDE)
        for a, b in zip(before, now, strict=True)
    )


def _puncture_contacts(levels: TrueLevels) -> FloatArray:
    """Finger centres (k, 2) of the first and of the last puncture."""
    ends = [*levels.punctures[:1], *levels.punctures[1:][-1:]]
    return np.vstack([p.contacts for p in ends]) if ends else np.zeros((0, 2))


def _not_yet(points: FloatArray, through: FloatArray, size: float) -> FloatArray:
    """Those of the points (k, 2) that are none of ``through`` (m, 2)."""
    kept: list[FloatArray] = list(through)
    for p in points:
        if all(np.hypot(*(p - q)) > _THROUGH * size for q in kept):
            kept.append(p)
    return np.array(kept[len(through) :]).reshape(-1, 2)


def _enclosed(
    curve: TrueCurve, hand: HandShape, contacts: FloatArray, true: FloatArray, inner: _Inner,
    method: Method,
) -> Cage | None:  # fmt: skip
    """The cage of the solved levels, if an outer polygon and the inner one enclose them."""
    cage, levels = inner.cage, inner.levels
    if not levels.first_solved or not levels.max_solved:
        return None
    polygon = _outer_polygon(curve, inner)
    outer = _local_cage(polygon, curve, hand, true, inner.segments, method)
    if outer is None:
        return None
    low, high, solved = cage.sigma_max, outer.sigma_max, levels.sigma_max
    path, gap = cage.escape_path, cage.min_finger_gap
    if low is None or solved is None:
        if np.isfinite(high):
            raise GeometryError("an outer polygon lets the object go that an inner one holds")
    else:
        if not np.isfinite(high) or low > high * (1.0 + _INSIDE):
            return None
        if not low * (1.0 - _INSIDE) <= solved <= high * (1.0 + _INSIDE):
            return None
        if high / low - 1.0 > SIGMA_MAX_GAP:
            return None
        if solved / levels.sigma_0 - 1.0 < NOT_A_CAGE:
            why = no_depth_reason(solved / levels.sigma_0)
            return not_a_cage(curve.outline, hand, contacts, why, curve.radius)
        way = outer.escape_path()
        if way is not None:
            path = np.vstack([levels.grasps[0].placement.as_array(), way[0]])
            gap = least_gap_on(cage.hand, path)
        high = max(high, solved)
    return replace(
        cage,
        contacts=levels.grasps[0].contacts,
        sigma_0=levels.sigma_0,
        sigma_first=levels.sigma_first,
        sigma_max=solved,
        sigma_max_lower=low,
        sigma_max_upper=None if solved is None else high,
        sigma_first_upper=levels.sigma_first,
        sigma_first_converged=True,
        adjusted_by=float(np.hypot(*(levels.grasps[0].contacts - contacts).T).max()),
        punctures=levels.punctures,
        grasps=levels.grasps,
        escape_path=path,
        min_finger_gap=gap,
        warnings=_warnings(curve, levels),
        work=None
        if cage.work is None
        else replace(
            cage.work,
            minimum_node=tuple(cage.work.minimum_node[k] for k in levels.origin),
            polygon_first=cage.sigma_first,
        ),
    )


def _outer_polygon(curve: TrueCurve, inner: _Inner) -> Outline:
    """Tangents through the same contacts; where two of them cross, the union of them all."""
    try:
        return curve.outer(inner.segments, inner.through)
    except GeometryError:
        arcs = directions_on_arcs(curve.outline, curve.radius, inner.through)
        return offsets(curve.outline, curve.radius, inner.segments, arcs).outer


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
