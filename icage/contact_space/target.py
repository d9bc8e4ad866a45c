"""The target in contact space: the strict minimum of sigma next to the contacts asked for."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from icage.arrays import ComplexArray, FloatArray, IntArray
from icage.contact_space.exploration import Exploration, Plane, explore_from
from icage.errors import GraspError
from icage.tolerance import DEPTH_CUT, NOT_A_CAGE, PASS_ERROR, PLATEAU, SAME_POINT

_MOST = 100_000
"""Regions round a target that can be looked at in half a minute: many pieces may meet in a vertex
of a fine fan."""


@dataclass(frozen=True, slots=True)
class ContactTarget:
    """A local minimum: the region to start from, the hand (4,) = d, w, and how far it was.

    ``slide`` is the length of the valley it lies in, [unit]; 0 for a strict minimum.
    """

    region: IntArray
    hand: FloatArray
    sigma_0: float
    moved: float
    slide: float


def regions_near(plane: Plane, contacts: FloatArray, reach: float) -> IntArray:
    """Regions (k, 4) whose edges and piece come within ``reach`` [unit] of the contacts (3, 2).

    Raises
    ------
    GraspError:
        They are more than ``_MOST``: to leave some out could miss the target.
    """
    space = plane.space
    edges: list[IntArray] = []
    pieces: list[IntArray] = []
    for x, y in contacts - plane.origin:
        off_x, off_y = x - space.edge_x, y - space.edge_y
        t = np.clip(off_x * space.edge_tx + off_y * space.edge_ty, 0.0, space.edge_length)
        gap = np.hypot(off_x - t * space.edge_tx, off_y - t * space.edge_ty)
        edges.append(np.flatnonzero(gap <= reach))
        inside = space.slot_nx * (x - space.slot_x) + space.slot_ny * (y - space.slot_y)
        pieces.append(np.flatnonzero(np.minimum.reduceat(inside, space.ptr[:-1]) >= -reach))
    rows = [
        (i, *row)
        for i in range(3)
        for row in product(edges[i], edges[(i + 1) % 3], pieces[(i + 2) % 3])
    ]
    if len(rows) > _MOST:
        raise GraspError(
            f"{len(rows)} regions meet round the contacts; at most {_MOST} fit: too many "
            "vertices lie within a hair of them, simplify the outline"
        )
    return np.array(rows, dtype=np.int64).reshape(-1, 4)


def find_contact_target(
    plane: Plane, contacts: FloatArray, *, reach: float, turn: float
) -> ContactTarget | None:
    """The local minimum nearest to the contacts (3, 2), or None.

    ``reach`` [diameter] bounds how far a finger may be from it, ``turn`` [rad] the hand's angle.
    """
    size = plane.outline.diameter
    wanted = contacts[:, 0] + 1j * contacts[:, 1] - complex(*plane.origin)
    near: list[ContactTarget] = []
    for region in regions_near(plane, contacts, 2.0 * reach * size):
        if not len(plane.corners(region)):
            continue
        low, ends = plane.least(region)
        hand, slide = _nearest(plane, ends, wanted)
        moved = float(np.abs(plane.fingers(hand) - wanted).max()) / size
        turned = abs(np.angle(complex(hand[2], hand[3]) * np.conj(wanted[1] - wanted[0])))
        if moved <= reach and turned <= turn and low > plane.space.pinch:
            near.append(ContactTarget(region, hand, low, moved, slide))
    near.sort(key=lambda t: (round(t.moved, 12), t.sigma_0, t.region.tolist()))
    shut: ContactTarget | None = None
    seen: set[tuple[int, ...]] = set()
    for target in near:
        if tuple(target.region.tolist()) in seen:
            continue
        if target.slide:
            return shut or target
        around = _search_to_the_cut(plane, target)
        if not _is_minimum(around, target):
            continue
        if not _isolated(around, target):
            return _valley_through(plane, target, near) or target
        # where more fingers are held than are needed, a point of free space may be left behind,
        # shut off from the minimum beside it: that one is meant
        shut = shut or target
        seen |= {tuple(row) for row in around.regions[:, :4].tolist()}
    return shut


def _valley_through(
    plane: Plane, target: ContactTarget, near: list[ContactTarget]
) -> ContactTarget | None:
    """The valley that ends in a minimum, where one does.

    A finger in a concave corner is on two edges. The hand that may slide along one of them is all
    that a region of the other one has of the valley, and rounding says which of both comes first.
    """
    size = plane.outline.diameter
    fingers = plane.fingers(target.hand)
    for other in near:
        level = abs(other.sigma_0 - target.sigma_0) <= PASS_ERROR * size
        if other.slide and level:
            apart = np.abs(plane.fingers(other.hand) - fingers).max()
            if apart <= SAME_POINT * size:
                return other
    return None


def _nearest(plane: Plane, ends: FloatArray, wanted: ComplexArray) -> tuple[FloatArray, float]:
    """The hand of a valley whose finger 1 is nearest to the wanted one, and the valley's length."""
    side = ends[1] - ends[0]
    square = float(side @ side)
    slide = float(np.hypot(side[0], side[1]))
    if square == 0.0 or slide <= PLATEAU * plane.outline.diameter:
        return 0.5 * (ends[0] + ends[1]), 0.0
    off = np.array([wanted[0].real, wanted[0].imag]) - ends[0, :2]
    t = float(np.clip(off @ side[:2] / (side[:2] @ side[:2]), 0.0, 1.0))
    return ends[0] + t * side, slide


def _search_to_the_cut(plane: Plane, target: ContactTarget) -> Exploration:
    """What lies round a minimum up to the depth cut."""
    top = target.sigma_0 + DEPTH_CUT * plane.outline.diameter
    return explore_from(plane, target.region, both_ways=False, stop_above=top)


def _is_minimum(around: Exploration, target: ContactTarget) -> bool:
    """Whether nothing deeper can be reached without opening by more than the depth cut.

    ``around`` is the search up to the cut.
    """
    cut = DEPTH_CUT * around.plane.outline.diameter
    return not around.escaped and float(around.nodes[:, 0].min()) >= target.sigma_0 - cut


def _isolated(around: Exploration, target: ContactTarget) -> bool:
    """Whether a hand of this least sigma can do nothing; ``around`` is the search up to the cut."""
    if around.escaped or len(around.left):
        return False
    # that search took tunnel edges downwards only
    top = target.sigma_0 * (1.0 + 2.0 * NOT_A_CAGE)
    found = explore_from(around.plane, target.region, stop_above=top)
    if found.escaped or len(found.left):
        return False
    return largest_sigma(found) <= target.sigma_0 * (1.0 + NOT_A_CAGE)


def largest_sigma(found: Exploration) -> float:
    """Largest sigma of everything explored: sigma is convex, so at a corner of a region."""
    plane = found.plane
    largest = 0.0
    for region in found.regions:
        for s, u in plane.corners(region):
            largest = max(largest, float(np.hypot(*plane.hand_at(region, s, u)[2:])))
    return largest
