"""Escape levels of cells outside the cage, with a memory; and hands that escape at a glance."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.search import GAVE_UP, SIGHT, explore
from icage.cells.kernels.shrink import pivot
from icage.kernels.compiled import compiled
from icage.kernels.storage import hash_slot

EMPTY = 1024
"""Places in a new table."""

EXACT, AT_MOST = 0, 1
"""Columns of the known levels: the escape level (nan: unknown), and a bound from above."""


class Memory(NamedTuple):
    """The table of known cells: keys (n,), -1 where free, and levels (n, 2)."""

    keys: np.ndarray
    levels: np.ndarray


class Escapes(NamedTuple):
    """Escape levels (n,) of the cells asked about, nan where the search gave up; what is known."""

    levels: np.ndarray
    memory: Memory


@compiled
def new_memory():
    """An empty table."""
    return Memory(np.full(EMPTY, -1, np.int64), np.full((EMPTY, 2), np.nan))


@compiled
def _grown(keys, levels):
    bigger = np.full(2 * len(keys), -1, np.int64)
    store = np.full((2 * len(keys), 2), np.nan)
    for at in range(len(keys)):
        if keys[at] != -1:
            to = hash_slot(bigger, keys[at])
            bigger[to] = keys[at]
            store[to] = levels[at]
    return bigger, store


@compiled
def shrinkable(pieces, z, placements):
    """Which hands (n, 4) = d_x, d_y, w_x, w_y can shrink to a point at once."""
    free = np.zeros(len(placements), np.bool_)
    barred = np.zeros(3, np.int64)
    for k in range(len(placements)):
        dx, dy, wx, wy = placements[k]
        free[k] = pivot(pieces, z, dx, dy, wx, wy, SIGHT * pieces.scale, barred) >= 0
    return free


@compiled
def escape_levels(pieces, z, cells, sigma, cap, worst, limit, memory):
    """Escape level (n,) of each cell (n, 3), or any level at or below ``sigma`` if it escapes so.

    Cells that a search enters before its last new maximum escape exactly at the final level,
    those after it no later.
    """
    m = len(pieces.ptr) - 1
    keys = memory.keys
    known = memory.levels
    count = 0
    for at in range(len(keys)):
        count += keys[at] != -1
    levels = np.empty(len(cells))
    for k in range(len(cells)):
        key = (cells[k, 0] * m + cells[k, 1]) * m + cells[k, 2]
        at = hash_slot(keys, key)
        if keys[at] != -1:
            if known[at, AT_MOST] <= sigma[k]:
                levels[k] = known[at, AT_MOST]
                continue
            if not np.isnan(known[at, EXACT]):
                levels[k] = known[at, EXACT]
                continue
        found = explore(pieces, z, cells[k], 0.0, cap, worst, np.inf, limit, np.inf)
        level = found.level
        if found.outcome == GAVE_UP:
            levels[k] = np.nan
            continue
        nodes = found.nodes
        levels[k] = level
        for n in range(len(nodes)):
            key = (nodes[n, 0] * m + nodes[n, 1]) * m + nodes[n, 2]
            at = hash_slot(keys, key)
            if keys[at] == -1:
                keys[at] = key
                known[at, EXACT] = np.nan
                known[at, AT_MOST] = np.inf
                count += 1
            if n == 0 or found.node_level[n] < level:
                known[at, EXACT] = level
            known[at, AT_MOST] = min(known[at, AT_MOST], level)
            if 2 * count > len(keys):
                keys, known = _grown(keys, known)
    return Escapes(levels, Memory(keys, known))
