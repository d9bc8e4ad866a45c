"""Escape levels of cells outside the cage, with a memory; and hands that escape at a glance."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.cells.kernels.search import GAVE_UP, SIGHT, explore
from icage.cells.kernels.shrink import pivot
from icage.kernels.compiled import compiled
from icage.kernels.storage import hash_slot

EMPTY = 1024


@compiled
def new_memory():
    """(keys, levels): the table of known cells; levels (n, 2) = exact (nan: unknown), at most."""
    return np.full(EMPTY, -1, np.int64), np.full((EMPTY, 2), np.nan)


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
    for k in range(len(placements)):
        dx, dy, wx, wy = placements[k]
        free[k] = pivot(pieces, z, dx, dy, wx, wy, SIGHT * pieces.scale) >= 0
    return free


@compiled
def escape_levels(pieces, z, cells, sigma, cap, worst, limit, memory_keys, memory_levels):
    """Escape level (n,) of each cell (n, 3), or any level at or below ``sigma`` if it escapes so.

    Cells that a search enters before its last new maximum escape exactly at the final level,
    those after it no later. nan where the search gave up. Returns (levels, memory keys, memory
    levels).
    """
    m = len(pieces.ptr) - 1
    keys = memory_keys
    known = memory_levels
    count = 0
    for at in range(len(keys)):
        count += keys[at] != -1
    levels = np.empty(len(cells))
    for k in range(len(cells)):
        key = (cells[k, 0] * m + cells[k, 1]) * m + cells[k, 2]
        at = hash_slot(keys, key)
        if keys[at] != -1:
            if known[at, 1] <= sigma[k]:
                levels[k] = known[at, 1]
                continue
            if not np.isnan(known[at, 0]):
                levels[k] = known[at, 0]
                continue
        found = explore(pieces, z, cells[k], 0.0, cap, worst, np.inf, limit)
        level = found[1]
        if found[0] == GAVE_UP:
            levels[k] = np.nan
            continue
        nodes = found[3]
        node_level = found[4]
        levels[k] = level
        for n in range(len(nodes)):
            key = (nodes[n, 0] * m + nodes[n, 1]) * m + nodes[n, 2]
            at = hash_slot(keys, key)
            if keys[at] == -1:
                keys[at] = key
                known[at, 0] = np.nan
                known[at, 1] = np.inf
                count += 1
            if n == 0 or node_level[n] < level:
                known[at, 0] = level
            known[at, 1] = min(known[at, 1], level)
            if 2 * count > len(keys):
                keys, known = _grown(keys, known)
    return levels, keys, known
