"""The cage for disc fingers: brackets from inner and outer polygons at several resolutions.

sigma_max grows with the obstacle: chords give a lower bound, tangents an upper one, and both are
refined until they agree. sigma_first does not (a larger obstacle can make a minimum or destroy
one), so no polygon bounds it: the smallest value met is the one to trust. [docs/theory.md, Sec. 4]

A method that misses connections (``ContactSpace(tunnels=False)``, for teaching) misses others on
the next polygon, so that its levels need not grow with the obstacle. Where they do not, the two
that should be the bracket are reported smaller first; both may be too high.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, GraspMinimum, Puncture, not_a_cage
from icage.discs.offsets import directions_on_arcs, offsets
from icage.discs.true_curve import refine
from icage.errors import GeometryError
from icage.geometry.way_out import least_gap_on
from icage.hand import HandShape
from icage.method import LocalCage, Method
from icage.outline import Outline
from icage.tolerance import (
    LEVEL,
    NOT_A_CAGE,
    SIGMA_FIRST_SPREAD,
    SIGMA_MAX_GAP,
    TARGET_SHIFT,
    TARGET_TURN,
)

RESOLUTIONS = (16, 24, 32)
"""Segments per quadrant at which sigma_first is always looked at."""

FINER = (64, 128, 256)
"""... and those that follow while the bracket of sigma_max is too wide."""

_LAST_DIGIT = 1e-12
"""[1] Levels of two polygons this close are one: rounding of the same straight edges."""


_ROUNDING = 1e-9
"""[diameter] By no more than this is an inner level above an outer one without an error of ours."""


@dataclass(frozen=True, slots=True)
class ArcLocalCage:
    """One polygon that stands in for the true curve, and what was found round it."""

    segments: int
    inner: bool
    local_cage: LocalCage
    sagitta: float

    @property
    def sigma_max(self) -> float:
        """Escape level on this polygon, [unit]; inf if there is none."""
        return self.local_cage.sigma_max

    @property
    def sigma_first(self) -> float:
        """First level on this polygon, [unit]; the escape level if nothing comes before it."""
        return self.local_cage.sigma_first


def plan_by_resolutions(
    outline: Outline, hand: HandShape, contacts: FloatArray, radius: float, method: Method
) -> Cage:
    """The cage of disc fingers whose centres stand on checked ``contacts`` (3, 2)."""
    true = _true_target(outline, hand, contacts, radius)
    local_cages, closed = _local_cages(outline, hand, true, radius, method)
    lower = [local_cage for local_cage in local_cages if local_cage.inner]
    if not lower:
        inner = offsets(outline, radius, 32).inner
        return replace(method.cage(inner, hand, contacts, outline, radius), contacts=contacts)
    # of equal levels the finest polygon, whatever the last digit says
    top = max(local_cage.sigma_max for local_cage in lower) * (1.0 - _LAST_DIGIT)
    basis = max(
        (k for k in lower if k.sigma_max >= top), key=lambda local_cage: local_cage.segments
    )
    cage = basis.local_cage.cage(contacts, outline, radius)
    if cage.status == "not_a_cage":
        return replace(cage, contacts=contacts)
    sigma_0 = float(np.hypot(*(true[1] - true[0])))
    if basis.sigma_max / sigma_0 - 1.0 < NOT_A_CAGE:
        most = min((k.sigma_max for k in local_cages if not k.inner), default=np.inf)
        why = f"too shallow to tell: sigma_max / sigma_0 is at most {most / sigma_0:.9g}"
        return not_a_cage(outline, hand, contacts, why, radius)
    return _bracketed(cage, local_cages, basis, true, contacts, closed, method.complete)


def _true_target(
    outline: Outline, hand: HandShape, contacts: FloatArray, radius: float
) -> FloatArray:
    """The target on the true curve if a contact lies on an arc, else as given."""
    if not directions_on_arcs(outline, radius, contacts):
        return contacts
    solved = refine(outline, hand, radius, contacts)
    if solved is None:
        return contacts
    near = float(np.hypot(*(solved - contacts).T).max()) <= TARGET_SHIFT * outline.diameter
    return solved if near else contacts


def _local_cages(
    outline: Outline, hand: HandShape, true: FloatArray, radius: float, method: Method
) -> tuple[list[ArcLocalCage], int]:
    """Inner and outer polygons, refined until sigma_max is bracketed."""
    through = directions_on_arcs(outline, radius, true)
    local_cages: list[ArcLocalCage] = []
    closed = 0
    for segments in (*RESOLUTIONS, *FINER):
        if segments in FINER and _narrow(local_cages):
            break
        grown = offsets(outline, radius, segments, through)
        closed = grown.closed_pockets
        chord = quadrant_chord(radius, segments) if through else 0.0
        for inner, polygon in ((True, grown.inner), (False, grown.outer)):
            found = local_cage_on(polygon, hand, true, chord, method)
            if found is not None:
                local_cages.append(ArcLocalCage(segments, inner, found, grown.sagitta))
        if not local_cages:
            break
    return local_cages, closed


def _narrow(local_cages: list[ArcLocalCage]) -> bool:
    low = max((k.sigma_max for k in local_cages if k.inner), default=0.0)
    high = min((k.sigma_max for k in local_cages if not k.inner), default=np.inf)
    return low > 0.0 and (low == high or high / low - 1.0 < SIGMA_MAX_GAP)


def quadrant_chord(radius: float, segments: int) -> float:
    """Longest chord of an arc with so many segments a quadrant, [unit], or a little more."""
    return radius * 0.5 * np.pi / segments


def local_cage_on(
    polygon: Outline, hand: HandShape, true: FloatArray, chord: float, method: Method
) -> LocalCage | None:
    """What is round the target on a polygon; None if it is not held.

    ``chord`` [unit] is the length of the chord that a contact on an arc rests on, anywhere; 0 if
    there is none.
    """
    part = chord / polygon.diameter
    return method.local_cage(
        polygon, hand, true, max(TARGET_SHIFT, part), max(TARGET_TURN, 10.0 * part)
    )


def _bracketed(
    cage: Cage,
    local_cages: list[ArcLocalCage],
    basis: ArcLocalCage,
    true: FloatArray,
    contacts: FloatArray,
    closed: int,
    complete: bool,
) -> Cage:
    """The cage of the basis polygon with the brackets and the true grasps put in."""
    low = basis.sigma_max
    outer = [local_cage for local_cage in local_cages if not local_cage.inner]
    best_outer = min(outer, key=lambda local_cage: local_cage.sigma_max) if outer else None
    high = best_outer.sigma_max if best_outer is not None else np.inf
    if low > high * (1.0 + 1e-9):
        # rounding is that of the coordinates, beside which the hand may be tiny
        if complete and low - high > _ROUNDING * cage.outline.diameter:
            raise GeometryError(f"inner sigma_max {low} above outer {high}: a planner's error")
        low, high = high, low
    high = max(low, high)
    # on chords the target itself lies a little below the true one, and so may its neighbours
    sigma_0 = float(np.hypot(*(true[1] - true[0])))
    firsts = [max(sigma_0, local_cage.sigma_first) for local_cage in local_cages]
    first, first_upper = min(*firsts, low), max(firsts)
    if all(local_cage.sigma_first == local_cage.sigma_max for local_cage in local_cages):
        # nothing comes before the escape anywhere: then its bracket, which is narrower, holds
        first, first_upper = low, high
    elif first >= low * (1.0 - _LAST_DIGIT):
        first = low  # an escape level of another polygon, an ulp lower
    converged = first == first_upper or first_upper / first - 1.0 <= SIGMA_FIRST_SPREAD
    grasps = _on_true_curve(cage, true)
    path, gap = cage.escape_path, cage.min_finger_gap
    way = best_outer.local_cage.escape_path() if best_outer is not None else None
    if way is not None:
        path = np.vstack([grasps[0].placement.as_array(), way[0]])
        gap = least_gap_on(cage.hand, path)
    return replace(
        cage,
        contacts=grasps[0].contacts,
        sigma_0=grasps[0].sigma,
        sigma_first=_finite(first),
        sigma_max=_finite(low),
        sigma_max_lower=_finite(low),
        sigma_max_upper=_finite(high),
        sigma_first_upper=_finite(first_upper),
        sigma_first_converged=converged,
        adjusted_by=float(np.hypot(*(grasps[0].contacts - contacts).T).max()),
        punctures=_punctures(cage, first, _first_contacts(local_cages, cage, first)),
        grasps=grasps,
        escape_path=path,
        min_finger_gap=gap,
        warnings=(*cage.warnings, *_warnings(local_cages, low, high, converged, closed)),
        work=None if cage.work is None else replace(cage.work, sagitta=basis.sagitta),
    )


def _finite(level: float) -> float | None:
    return float(level) if np.isfinite(level) else None


def _on_true_curve(cage: Cage, true: FloatArray) -> tuple[GraspMinimum, ...]:
    """The grasps of the basis polygon; those that touch an arc solved on the true curve."""
    outline, hand, radius = cage.outline, cage.hand, cage.finger_radius
    grasps: list[GraspMinimum] = []
    for grasp in cage.grasps:
        contacts: FloatArray | None = None
        if grasp.target:
            contacts = true if directions_on_arcs(outline, radius, true) else None
        elif grasp.plateau is None:
            solved = refine(outline, hand, radius, grasp.contacts)
            if solved is not None:
                moved = float(np.hypot(*(solved - grasp.contacts).T).max())
                contacts = solved if moved < 0.2 * radius else None
        if contacts is not None:
            sigma = float(np.hypot(*(contacts[1] - contacts[0])))
            grasp = replace(grasp, contacts=contacts, sigma=sigma)
        grasps.append(grasp)
    return tuple(grasps)


def _first_contacts(local_cages: list[ArcLocalCage], cage: Cage, first: float) -> FloatArray | None:
    """Contacts (3, 2) of the first puncture of the polygon whose sigma_first is taken."""
    for local_cage in local_cages:
        if local_cage.sigma_first == first:
            own = local_cage.local_cage.cage(cage.contacts, cage.outline, cage.finger_radius)
            return own.punctures[0].contacts if own.punctures else None
    return None


def _punctures(cage: Cage, first: float, contacts: FloatArray | None) -> tuple[Puncture, ...]:
    """The punctures of the basis polygon, the first of them at sigma_first on these contacts."""
    head = cage.punctures[0] if cage.punctures else None
    if head is None or not np.isfinite(first):
        return cage.punctures
    if abs(head.sigma / first - 1.0) <= SIGMA_FIRST_SPREAD and head.kind == "intermediate":
        at = head.contacts if contacts is None else contacts
        return (replace(head, sigma=first, contacts=at), *cage.punctures[1:])
    if head.sigma <= first * (1.0 + 2.0 * LEVEL):
        return cage.punctures
    at = head.contacts if contacts is None else contacts
    new = replace(head, sigma=first, kind="intermediate", joins=(), contacts=at)
    return (new, *cage.punctures)


def _warnings(
    local_cages: list[ArcLocalCage], low: float, high: float, converged: bool, closed: int
) -> tuple[str, ...]:
    told = ["the levels are those of polygons, not solved on the true curve"]
    if closed:
        told.append(f"the finger's radius closes {closed} pocket(s) of the outline")
    if not (low == high or high / low - 1.0 < SIGMA_MAX_GAP):
        told.append(f"sigma_max is bracketed by {low:.9g} and {high:.9g} only")
    if not converged:
        spread = ", ".join(
            f"{k.segments}{'i' if k.inner else 'o'}: {k.sigma_first:.6g}" for k in local_cages
        )
        told.append(f"sigma_first depends on the arc resolution ({spread}); the smallest is used")
    return tuple(told)
