"""All minima of a hand and their merges from the table of all cells: m^3 of them, for m to 80.

What ``icage.cells.sublevels`` was at first. It asks no cell whether it holds a hand and computes
every pass and every least point by itself; only the pass value is the planner's.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from icage.cells.free_space import FreeSpace
from icage.cells.kernels.columns import (
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_SLOT,
    EDGE_TO,
    LOW_LEVEL,
    MERGE_LOSE,
)
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.search import birth
from icage.cells.kernels.tree import merge
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT
from tests.oracles.geometry import Floats

MOST_PIECES = 80
"""Pieces of the plane beyond which the table would take more than a GB."""


def births_and_merges(outline: Outline, hand: HandShape) -> Floats:
    """(m, 2) = sigma of every minimum, level at which it merges with a deeper one; by sigma.

    A pinched hand is the deepest minimum of all. inf: it never merges.
    """
    free_space = FreeSpace.around(outline, hand)
    assert free_space.pieces.total <= MOST_PIECES
    low, edges, values = _all_passes(
        free_space.pieces, free_space.z, free_space.cap, free_space.worst
    )
    joined = merge(low, edges, values, np.inf)
    ended = np.full(len(low), np.inf)
    ended[joined.merges[:, MERGE_LOSE]] = joined.lows[:, LOW_LEVEL]
    # at the cap every hand has escaped: a cell born there has its passes beyond the table
    cut = DEPTH_CUT * outline.diameter
    held = np.flatnonzero((low > 0.0) & (low < free_space.cap - cut))
    kept = held[ended[held] - low[held] > cut]
    rows = np.column_stack([low[kept], ended[kept]])
    return rows[np.lexsort((rows[:, 1], rows[:, 0]))]


@numba.njit
def _all_passes(pieces: Any, z: Any, cap: Any, worst: Any) -> Any:
    """Births of all cells (m^3,), and all passes as ``merge`` wants them.

    Cell (a, b, c) has the number (a m + b) m + c.
    """
    m = len(pieces.ptr) - 1
    room = new_room()
    low = np.empty(m * m * m)
    edges = np.empty((3 * m * m * len(pieces.slot_vertex) // 2 + 1, 4), np.int64)
    values = np.empty(len(edges))
    cell = np.empty(3, np.int64)
    step = np.array([m * m, m, 1])
    e = 0
    for number in range(m * m * m):
        cell[0], cell[1], cell[2] = number // (m * m), number // m % m, number % m
        low[number] = birth(pieces, z, cell, cap, worst, room).sigma
        if low[number] == np.inf:
            continue
        for i in range(3):
            for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
                if pieces.slot_neighbour[s] <= cell[i]:
                    continue
                value = pass_value(pieces, z, facet_of(pieces, cell, i, s), cap, worst, room).sigma
                if value == np.inf:
                    continue
                edges[e, EDGE_FROM] = number
                edges[e, EDGE_TO] = number + (pieces.slot_neighbour[s] - cell[i]) * step[i]
                edges[e, EDGE_FINGER], edges[e, EDGE_SLOT] = i, s
                values[e] = value
                e += 1
    return low, edges[:e], values[:e]
