"""The object's edges as a finger in a convex piece of the free plane sees them."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

AX, AY, TX, TY, LENGTH = range(5)
"""edges (n, 5): where an edge starts, its unit direction counterclockwise round the object, and
its length."""

_BEHIND = 1e-12
"""[diameter] A piece no further than this behind an edge's line counts as ahead of it."""


class NearEdges(NamedTuple):
    """For every piece the edges that can be nearest to a finger in it, CSR; the last row has all.

    ``ahead`` says of each whether the whole piece is on the outer side of its line. ``most``
    (pieces,) bounds the distance of a point of the piece from the object from above.
    """

    start: np.ndarray
    items: np.ndarray
    ahead: np.ndarray
    most: np.ndarray


@compiled_borrowing
def distance_to_edge(edges, e, x, y):
    """Distance of a point from edge e."""
    gx = x - edges[e, AX]
    gy = y - edges[e, AY]
    along = gx * edges[e, TX] + gy * edges[e, TY]
    beyond = max(0.0, -along, along - edges[e, LENGTH])
    return np.hypot(gx * edges[e, TY] - gy * edges[e, TX], beyond)


@compiled
def near_edges(pieces, edges):
    """The edges near every piece.

    The distance to an edge is convex, so it is largest at a corner of the piece: the least of these
    maxima bounds the distance to the object, and an edge further from the whole piece than that is
    never the nearest one.
    """
    m = len(pieces.ptr) - 1
    n = len(edges)
    start = np.zeros(m + 2, np.int64)
    most = np.empty(m)
    items = np.empty(m * n + n, np.int64)
    ahead = np.zeros(m * n + n, np.bool_)
    count = 0
    for k in range(m):
        first, end = pieces.ptr[k], pieces.ptr[k + 1]
        cx = 0.0
        cy = 0.0
        for s in range(first, end):
            v = pieces.slot_vertex[s]
            cx += pieces.x[v] / (end - first)
            cy += pieces.y[v] / (end - first)
        reach = 0.0
        for s in range(first, end):
            v = pieces.slot_vertex[s]
            reach = max(reach, np.hypot(pieces.x[v] - cx, pieces.y[v] - cy))
        bound = np.inf
        for e in range(n):
            furthest = 0.0
            for s in range(first, end):
                v = pieces.slot_vertex[s]
                furthest = max(furthest, distance_to_edge(edges, e, pieces.x[v], pieces.y[v]))
                if furthest >= bound:
                    break
            bound = min(bound, furthest)
        most[k] = bound
        for e in range(n):
            if distance_to_edge(edges, e, cx, cy) - reach > bound:
                continue
            items[count] = e
            lowest = np.inf
            for s in range(first, end):
                v = pieces.slot_vertex[s]
                gx = pieces.x[v] - edges[e, AX]
                gy = pieces.y[v] - edges[e, AY]
                lowest = min(lowest, gx * edges[e, TY] - gy * edges[e, TX])
            ahead[count] = lowest >= -_BEHIND * pieces.scale
            count += 1
        start[k + 1] = count
    for e in range(n):
        items[count] = e
        count += 1
    start[m + 1] = count
    return NearEdges(start, items[:count].copy(), ahead[:count].copy(), most)


@compiled_borrowing
def nearest(edges, near, piece, x, y):
    """Distance of a point from the nearest edge that is listed for a piece."""
    least = np.inf
    for at in range(near.start[piece], near.start[piece + 1]):
        least = min(least, distance_to_edge(edges, near.items[at], x, y))
    return least
