"""Bounds of the levels on a slightly larger polygon: the way out that is known, looked at again.

An outer polygon has its corners right above those of an inner one, so both are cut into the same
pieces, and the way out of the one is mostly one of the other, over passes that are a little higher.
The highest of them bounds the escape level from above, whatever else a search would find; only
below the first level is searched. Our own. [docs/decisions/0012-true-curves.md]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cells.free_space import Configuration, FreeSpace, Search, search
from icage.cells.kernels.along import Way, way_through
from icage.cells.kernels.columns import EDGE_FROM, NODE_EDGE, PASS_SIGMA, RECORD_LEVEL, RECORD_NODE
from icage.cells.kernels.facet import CLEARANCE
from icage.cells.minima import path_edges, way_to_a_pinch
from icage.geometry.exterior import Beside, pieces_beside
from icage.outline import Outline

_IN_ONE_PIECE = 3
"""What ``Way.standing`` is where no finger has to stand."""

_ABOVE_FIRST = 1e-6
"""[1] The search for the first level goes this little (relative) above where it should be."""


@dataclass(frozen=True, slots=True)
class BoundAbove:
    """A way out around a polygon. See ``icage.method.UpperBound``."""

    free_space: FreeSpace
    start: Configuration
    way: Way
    sigma_first: float
    first_contacts: FloatArray | None
    """(3, 2) at the first level; None where that is the escape level."""

    @property
    def sigma_max(self) -> float:
        """The highest pass of the way."""
        return float(self.way.passes[:, PASS_SIGMA].max())

    def escape_path(self) -> tuple[FloatArray, float] | None:
        """Placements to a pinched hand and the least finger gap."""
        points = [Configuration(complex(*h[:2]), complex(*h[2:])) for h in self.way.hands.tolist()]
        standing = self.way.standing % _IN_ONE_PIECE
        return way_to_a_pinch(self.free_space, [self.start, *points], standing)


def bound_above(
    found: Search, polygon: Outline, contacts: FloatArray, first: float
) -> BoundAbove | None:
    """What the way out that a search has found is on a polygon with corners right above its own.

    None if it is none, or if the pieces do not tell. ``first`` is where the first level should be,
    [unit], inf if the escape comes first.
    """
    edges = path_edges(found) if found.escaped else []
    cut = pieces_beside(found.free_space.pieces, polygon, found.free_space.hand) if edges else None
    if cut is None:
        return None
    cells = np.vstack([found.cells[found.edges[edges, EDGE_FROM]], found.cells[-1:]])
    free_space = FreeSpace.of_pieces(polygon, found.free_space.hand, cut.pieces, cut.origin)
    d, w = complex(*(contacts[0] - cut.origin)), complex(*(contacts[1] - contacts[0]))
    hand = np.array([d.real, d.imag, w.real, w.imag])
    way = way_through(
        cut.pieces, free_space.z, hand, cells[:-1], found.edges[edges], cells[-1], free_space.cap,
        free_space.worst,
    )  # fmt: skip
    if not way.begins or way.standing < 0 or not _keeps_clear(cut, cells, way, free_space):
        return None
    start, level = Configuration(d, w), float(way.passes[:, PASS_SIGMA].max())
    if first >= level:
        return BoundAbove(free_space, start, way, level, None)
    lower = _first_level(free_space, cut.bent, cells[0], abs(w), first)
    return None if lower is None else BoundAbove(free_space, start, way, *lower)


def _keeps_clear(cut: Beside, cells: IntArray, way: Way, free_space: FreeSpace) -> bool:
    """Whether the way keeps to the convex part of pieces that are not convex.

    At every pass it does so on both sides, and in between it is straight.
    """
    d, w = way.hands[:, :2] @ [1.0, 1.0j], way.hands[:, 2:] @ [1.0, 1.0j]
    fingers = d[:, None] + w[:, None] * free_space.hand.z
    pieces = cut.pieces
    for piece in np.flatnonzero(cut.bent):
        at = fingers[(cells[:-1] == piece) | (cells[1:] == piece)]
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            corner = pieces.slot_vertex[s]
            gap = pieces.normal_x[s] * (at.real - pieces.x[corner])
            gap += pieces.normal_y[s] * (at.imag - pieces.y[corner])
            if (gap < -CLEARANCE * pieces.scale).any():
                return False
    return True


def _first_level(
    free_space: FreeSpace, bent: BoolArray, cell: IntArray, sigma_0: float, first: float
) -> tuple[float, FloatArray] | None:
    """The first level and contacts (3, 2) there, up to where it should be.

    None if there is none, or the pieces do not tell.
    """
    found = search(free_space, cell, sigma_0, stop_above=first * (1.0 + _ABOVE_FIRST))
    pieces = free_space.pieces
    if bent.any():
        near = bent.copy()
        owner = np.repeat(np.arange(pieces.total), np.diff(pieces.ptr))
        beside = pieces.slot_neighbour
        near[owner[(beside >= 0) & bent[beside]]] = True
        if near[found.cells].any():
            return None
    record = found.first_record()
    if record is None:
        return None
    edge = int(found.nodes[int(found.records[record, RECORD_NODE]), NODE_EDGE])
    contacts = free_space.contacts(found.edge_configuration(edge))
    return float(found.records[record, RECORD_LEVEL]), contacts
