"""The cage for disc fingers: levels solved on the true curve, two polygons as the certificate.

Coarse polygons, an outer one (tangents) and an inner one (chords), name the minima and punctures;
they are solved on the true curve; the inner polygon is drawn again through the contacts of its
punctures, until no new ones appear. Chords or tangents alone can hide a shallow minimum, so
the levels solved from either have to be the same. Then the escape levels of both polygons, drawn
through the same contacts, enclose the solved one; whatever else the outer one names as a puncture,
the inner one is drawn through, too. Where one of this fails finer polygons are tried,
and what does not come out at all is left to ``icage.discs.brackets``, which says between which
polygons' levels the truth lies. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, not_a_cage
from icage.discs.brackets import plan_by_resolutions
from icage.discs.critical import Critical, CriticalHands
from icage.discs.curve import TrueCurve
from icage.discs.offsets import check_disc_contacts
from icage.discs.standing_in import INSIDE, TIGHT, Bound, Polygons, Solved, agree, near
from icage.discs.true_levels import TrueLevels
from icage.errors import GeometryError
from icage.geometry.statics import contacts_reason
from icage.geometry.way_out import least_gap_on
from icage.hand import HandShape
from icage.method import LocalCage, Method
from icage.outline import Outline
from icage.tolerance import NOT_A_CAGE, SIGMA_MAX_GAP, TARGET_SHIFT

SEGMENTS = (8, 24, 64)
"""Segments a quadrant of the coarse polygons, and of those that are tried where a level stays
unsolved, the two polygons disagree or the bracket is wide."""


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
    resting = curve.on_arcs(true)
    for segments in SEGMENTS:
        look = Polygons(curve, critical, method, contacts, true, target, resting, segments)
        inner, bound = look.levels()
        if isinstance(inner, Cage):
            return inner
        if inner is None:
            break
        cage = _enclosed(look, bound, inner)
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


def _enclosed(look: Polygons, bound: Bound | None, inner: Solved) -> Cage | None:
    """The cage of the solved levels, if both polygons agree to it and enclose it; else None."""
    cage, levels = inner.cage, inner.levels
    if _adjusted_by(look, levels) > TARGET_SHIFT * look.curve.outline.diameter:
        # it was looked for along a whole chord, which is more than is promised
        outline, radius = look.curve.outline, look.curve.radius
        polygon = look.curve.inner(look.segments, inner.through)
        why = contacts_reason(polygon, look.contacts)
        return not_a_cage(outline, look.critical.hand, look.contacts, why, radius)
    if bound is None or not agree(levels, bound.levels):
        return None
    wide = SIGMA_MAX_GAP if inner.again else TIGHT
    if not (
        near(cage.sigma_max, levels.sigma_max, wide)
        and near(levels.polygon_first, levels.sigma_first, wide)
    ):
        return None  # another puncture may be as near
    outer = bound.local_cage
    low, high, solved = cage.sigma_max, outer.sigma_max, levels.sigma_max
    if low is None or solved is None:
        return None if np.isfinite(high) else _finished(look, inner, None, None)
    if not (np.isfinite(high) and near(high, solved, SIGMA_MAX_GAP)):
        return None
    if not low * (1.0 - INSIDE) <= solved <= high * (1.0 + INSIDE):
        return None
    if solved / levels.sigma_0 - 1.0 < NOT_A_CAGE:
        why = f"too shallow to tell: sigma_max / sigma_0 is at most {high / levels.sigma_0:.9g}"
        outline, radius = look.curve.outline, look.curve.radius
        return not_a_cage(outline, look.critical.hand, look.contacts, why, radius)
    return _finished(look, inner, max(high, solved), outer)


def _finished(look: Polygons, inner: Solved, upper: float | None, outer: LocalCage | None) -> Cage:
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
        adjusted_by=_adjusted_by(look, levels),
        punctures=levels.punctures,
        grasps=levels.grasps,
        escape_path=path,
        min_finger_gap=gap,
        warnings=_warnings(look.curve, levels),
        work=work,
    )


def _adjusted_by(look: Polygons, levels: TrueLevels) -> float:
    """How far a finger of the target is from where it was asked to be at most, [unit]."""
    return float(np.hypot(*(levels.grasps[0].contacts - look.contacts).T).max())


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
