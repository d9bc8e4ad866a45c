"""The region of one finger below a level: a sandwich for every cell that is not yet covered.

Our own.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.facet import BASE_COLUMNS, MAX_BASE, facet_of, finger_on_segment
from icage.cells.kernels.sandwich import CORNERS, sandwich
from icage.kernels.compiled import compiled


class Sandwiches(NamedTuple):
    """Inner and outer polygons: corners (k, 2) one after another, counts (n,), a cell each."""

    inner: np.ndarray
    inner_counts: np.ndarray
    outer: np.ndarray
    outer_counts: np.ndarray


@compiled
def _covered(outer, m, inner_store, inner_start, inner_count, held, n_held, slack):
    """Whether one of the earlier inner polygons of the same piece holds the whole outer one."""
    for h in range(n_held):
        at = held[h]
        n = inner_count[at]
        if n < 3:
            continue
        start = inner_start[at]
        holds = True
        for a in range(m):
            for c in range(n):
                d = c + 1 if c + 1 < n else 0
                ax = inner_store[start + c, 0]
                ay = inner_store[start + c, 1]
                bx = inner_store[start + d, 0]
                by = inner_store[start + d, 1]
                side = np.hypot(bx - ax, by - ay)
                cross = (bx - ax) * (outer[1, a] - ay) - (by - ay) * (outer[0, a] - ax)
                if cross < -slack * side:
                    holds = False
                    break
            if not holds:
                break
        if holds:
            return True
    return False


@compiled
def least_points(pieces, z, i, cells, wx, wy, standing, slots):
    """Where finger i is at the least sigma of every cell (n, 3): points (n, 2).

    There w = (wx, wy) and the finger ``standing`` is on the edge ``slots`` of its piece.
    """
    points = np.empty((len(cells), 2))
    base = np.empty((MAX_BASE, BASE_COLUMNS))
    for row in range(len(cells)):
        a = standing[row]
        facet = facet_of(pieces, cells[row], a, slots[row])
        ends = finger_on_segment(pieces, z, facet, wx[row], wy[row], base)
        ux = z[i, 0] - z[a, 0]
        uy = z[i, 1] - z[a, 1]
        points[row, 0] = 0.5 * (ends.x_lo + ends.x_hi) + wx[row] * ux - wy[row] * uy
        points[row, 1] = 0.5 * (ends.y_lo + ends.y_hi) + wx[row] * uy + wy[row] * ux
    return points


@compiled
def all_sandwiches(pieces, z, i, nodes, points, level, enough, slack):
    """Sandwiches of finger i over all nodes (n, 3), with a starting position (n, 2) in each.

    Sets that an earlier one of the same piece covers to within ``slack`` are left out.
    """
    inner_store = np.empty((1024, 2))
    outer_store = np.empty((1024, 2))
    inner_count = np.empty(len(nodes), np.int64)
    outer_count = np.empty(len(nodes), np.int64)
    inner_start = np.empty(len(nodes), np.int64)
    last = np.full(len(pieces.ptr) - 1, -1, np.int64)  # chains of kept sets by piece
    chain = np.empty(len(nodes), np.int64)
    held = np.empty(len(nodes), np.int64)
    inner = np.empty((2, CORNERS))
    outer = np.empty((2, CORNERS))
    kept = 0
    n_in = 0
    n_out = 0
    for k in range(len(nodes)):
        h, m = sandwich(pieces, z, i, nodes[k], level, points[k], enough, inner, outer)
        if m < 3:
            continue
        piece = nodes[k, i]
        n_held = 0
        at = last[piece]
        while at >= 0:
            held[n_held] = at
            n_held += 1
            at = chain[at]
        if _covered(outer, m, inner_store, inner_start, inner_count, held, n_held, slack):
            continue
        while n_in + h > len(inner_store):
            inner_store = np.concatenate((inner_store, np.empty_like(inner_store)))
        while n_out + m > len(outer_store):
            outer_store = np.concatenate((outer_store, np.empty_like(outer_store)))
        for a in range(h):
            inner_store[n_in + a, 0] = inner[0, a]
            inner_store[n_in + a, 1] = inner[1, a]
        for a in range(m):
            outer_store[n_out + a, 0] = outer[0, a]
            outer_store[n_out + a, 1] = outer[1, a]
        inner_start[kept] = n_in
        inner_count[kept] = h
        outer_count[kept] = m
        chain[kept] = last[piece]
        last[piece] = kept
        kept += 1
        n_in += h
        n_out += m
    return Sandwiches(
        inner_store[:n_in], inner_count[:kept], outer_store[:n_out], outer_count[:kept]
    )
