"""Joining triangles across their diagonals while the pieces stay convex, in doubles with a filter.

Half edge 3 t + k starts at corner k of triangle t. Where a float cannot tell the sign of an
orientation the kernel says so, and the caller does it again in exact arithmetic.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.union_find import root_of

FILTER = (3.0 + 16.0 * 2.0**-53) * 2.0**-53
"""[1] Relative error bound of the float orientation determinant. [Shewchuk1997, ccwerrboundA]"""

_UNSURE = 2


@compiled
def _orientation(x, y, a, b, c):
    """Sign of the area of three vertices, or ``_UNSURE``."""
    left = (x[a] - x[c]) * (y[b] - y[c])
    right = (y[a] - y[c]) * (x[b] - x[c])
    det = left - right
    if abs(det) > FILTER * (abs(left) + abs(right)):
        return 1 if det > 0.0 else -1
    # a factor that is 0 is so exactly: edges along an axis need no exact arithmetic
    if (x[a] == x[c] or y[b] == y[c]) and (y[a] == y[c] or x[b] == x[c]):
        return 0
    return _UNSURE


@compiled
def _corner(x, y, before, at, after):
    """1 if the corner turns left or goes straight on, 0 if not, or ``_UNSURE``."""
    sign = _orientation(x, y, before, at, after)
    if sign == _UNSURE:
        return _UNSURE
    if sign != 0:
        return 1 if sign > 0 else 0
    if x[before] != x[at]:
        return 1 if (x[before] < x[at]) == (x[at] < x[after]) else 0
    return 1 if (y[before] < y[at]) == (y[at] < y[after]) else 0


@compiled
def merge_rings(x, y, origin, twin, order, max_edges):
    """Rings of vertices of the merged pieces, each from its smallest one, one after the other.

    ``order``: half edges of the diagonals as they are to be removed. Returns the vertices, where
    rings end among them, and whether every sign was certain.
    """
    count = len(origin)
    after = np.empty(count, np.int64)
    before = np.empty(count, np.int64)
    piece = np.empty(count, np.int64)
    for e in range(count):
        t = e // 3
        after[e] = 3 * t + (e + 1) % 3
        before[e] = 3 * t + (e + 2) % 3
        piece[e] = t
    parent = np.arange(count // 3)
    edges = np.full(count // 3, 3)
    alive = np.ones(count, np.bool_)
    for edge in order:
        other = twin[edge]
        mine, yours = root_of(parent, piece[edge]), root_of(parent, piece[other])
        total = edges[mine] + edges[yours] - 2
        if mine == yours or total > max_edges:
            continue
        convex = 1
        here, there = edge, other
        for _ in range(2):
            turn = _corner(x, y, origin[before[here]], origin[here], origin[after[after[there]]])
            if turn == _UNSURE:
                return np.empty(0, np.int64), np.empty(0, np.int64), False
            if turn == 0:
                convex = 0
                break
            here, there = there, here
        if convex == 0:
            continue
        for _ in range(2):
            into, out = before[here], after[there]
            after[into], before[out] = out, into
            alive[here] = False
            here, there = there, here
        parent[yours] = mine
        edges[mine] = total
    vertices = np.empty(count, np.int64)
    ends = np.empty(count // 3, np.int64)
    n = 0
    rings = 0
    for start in range(count):
        if not alive[start]:
            continue
        first = start
        edge = after[start]
        while edge != start:
            if origin[edge] < origin[first]:
                first = edge
            edge = after[edge]
        edge = first
        while alive[edge]:
            alive[edge] = False
            vertices[n] = origin[edge]
            n += 1
            edge = after[edge]
        ends[rings] = n
        rings += 1
    return vertices[:n], ends[:rings], True
