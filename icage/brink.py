"""Where closing may stop although an arbitrarily small push leads on: hands that stand on a brink.

The forces on a hand may balance with a finger exactly at the end of an edge, or with a disc where
an edge goes over into the arc round its vertex. Sigma has a minimum there to one side and none to
the other, so the hand is in no level; but who comes along the edge stops. A minimum right beside
such an end, too shallow to count as one, is the same. Our own. [docs/theory.md, Sec. 2.7]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from icage.arrays import FloatArray, IntArray, read_only
from icage.cells.free_space import Configuration
from icage.cells.kernels.columns import BIRTH_WX, BORN_FINGER, BORN_SLOT
from icage.cells.kernels.facet import middles_on_facets
from icage.cells.kernels.plateau import translations
from icage.cells.kernels.unpushed import unpushed
from icage.cells.work import CageWork
from icage.geometry.exterior import Pieces
from icage.geometry.kernels.pieces import WALL
from icage.geometry.near_frame import NearFrame
from icage.near_hands import are_beside
from icage.tolerance import DEPTH_CUT, LEVEL, PLATEAU
from icage.values import Value

if TYPE_CHECKING:
    from icage.cage import Cage

_PUSHED: Final = 1e-5
"""[1] Share of the motor's pull that does not drive a hand on: fingers a hair (``wedge.FIT``)
thicker or thinner may take it away."""

_NEARLY: Final = 0.1
"""[1] The same on chords in place of arcs, whose normals are off by half of what a chord turns."""


@dataclass(frozen=True, slots=True, eq=False)
class Brink(Value):
    """The least hand below sigma_first, short of the target, that balances and is no minimum.

    Attributes
    ----------
    sigma:
        [unit] Its size: below it closing ends only in the target.
    contacts:
        (fingers, 2) its finger centres.
    """

    sigma: float
    contacts: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", read_only(np.array(self.contacts, dtype=np.float64)))


def brink_of(cage: Cage, work: CageWork) -> Brink | None:
    """The least brink of a cage below its sigma_first, or None.

    Such a hand is the least one of a cell that holds its better side, and the forces of what its
    fingers touch balance there without those of the edges that pieces share. Every cell of the
    target's component below sigma_first is looked at. With discs, Newton's method finds the hands
    that balance on the true curve beside these least ones; what is no grasp of the plan is a brink.
    """
    nodes, level = work.below_first(cage.sigma_first)
    if not len(nodes):
        return None
    size = cage.outline.diameter
    # a hand as small as the target is the target, on its plateau perhaps
    least = cage.sigma_0 + 2.0 * DEPTH_CUT * size
    points = cage.finger_radius == 0.0
    found = _on_edges(cage, work, nodes, level) if points else _on_true_curve(cage, work, nodes)
    stops = [one for one in found if one.sigma > least]
    if not stops:
        return None
    hands = np.array([one.contacts for one in stops])
    near = are_beside(hands, cage.contacts, size).tolist()
    others = [one for one, own in zip(stops, near, strict=True) if not own]
    return min(others, key=lambda one: one.sigma, default=None)


def _on_edges(cage: Cage, work: CageWork, nodes: IntArray, level: FloatArray) -> Iterator[Brink]:
    """Hands of point fingers that balance, of these nodes (n,) with their levels (n,) [unit]."""
    free_space = work.search.free_space
    pieces, z = free_space.pieces, free_space.z
    hands, share = _least_and_unpushed(work, nodes)
    frame = NearFrame.of(cage.outline)
    for k in np.flatnonzero(share <= _PUSHED).tolist():
        d_x, d_y, w_x, w_y = hands[k].tolist()
        cell = np.ascontiguousarray(work.search.cells[nodes[k]])
        corners = translations(pieces, z, cell, w_x, w_y)
        if len(corners) and np.ptp(corners, axis=0).max() > PLATEAU * pieces.diameter:
            continue  # it slides: a shelf
        at = Configuration(complex(d_x, d_y), complex(w_x, w_y))
        yield Brink(float(level[k]), frame.back(free_space.contacts(at)))


def _least_and_unpushed(work: CageWork, nodes: IntArray) -> tuple[FloatArray, FloatArray]:
    """The least hands (n, 4) of nodes, and the shares (n,) of the motor's pull that drive them."""
    free_space, tree = work.search.free_space, work.tree
    pieces, z = free_space.pieces, free_space.z
    cells = np.ascontiguousarray(work.search.cells[nodes])
    hands = middles_on_facets(
        pieces, z, cells, tree.birth_at[nodes, BORN_FINGER], tree.birth_at[nodes, BORN_SLOT],
        tree.birth[nodes, BIRTH_WX:],
    )  # fmt: skip
    return hands, unpushed(pieces, z, cells, hands, *_hollow_corners(pieces))


def _hollow_corners(pieces: Pieces) -> tuple[IntArray, IntArray]:
    """The slots of the edges that end and begin in vertices (n,) that are hollow, -1 elsewhere."""
    walls = np.flatnonzero(pieces.slot_neighbour == WALL)
    ends_at, begins_at = np.full((2, len(pieces.x)), -1, np.int64)
    ends_at[pieces.wall_to] = begins_at[pieces.wall_from] = walls
    a, b = pieces.normal_x + 1j * pieces.normal_y, ends_at >= 0
    hollow = b & ((a[ends_at].conj() * a[begins_at]).imag > 0.0)
    return np.where(hollow, ends_at, -1), np.where(hollow, begins_at, -1)


def _on_true_curve(cage: Cage, work: CageWork, nodes: IntArray) -> Iterator[Brink]:
    """Hands of discs that balance on the true curve beside the least ones of these nodes (n,)."""
    from icage.discs.critical import CriticalHands
    from icage.discs.true_levels import REACH, SAME

    size, frame = cage.outline.diameter, NearFrame.of(cage.outline)
    critical = CriticalHands(frame.outline_into(cage.outline), cage.finger_radius, cage.hand)
    top = np.inf if cage.sigma_first is None else cage.sigma_first * (1.0 - LEVEL)
    reach = REACH * work.sagitta + SAME * size
    hands = work.least_hands_of(nodes)
    # a grasp of the plan that hands below sigma_first lie at is none but a brink: closing along the
    # true curve from where the polygon has a minimum came to a stop on it
    grasps = [frame.into(grasp.contacts) for grasp in cage.grasps]
    grasps = [one for one in grasps if np.abs(hands - one).max(axis=(1, 2)).min() > reach]
    # what is found there is the target
    away = ~are_beside(hands, frame.into(cage.contacts), size)
    likely = away & (_least_and_unpushed(work, nodes)[1] <= _NEARLY)
    for stop in critical.stops_near(hands[away], hands[likely], reach):
        # level: it slides, on a shelf
        if stop.level or stop.sigma >= top:
            continue
        if all(np.abs(stop.contacts - known).max() > SAME * size for known in grasps):
            yield Brink(stop.sigma, frame.back(stop.contacts))
