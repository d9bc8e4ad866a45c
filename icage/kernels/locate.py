"""Which piece holds a point, and how deep a point is inside a polygon."""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import hash_slot
from icage.kernels.tips import RIGHT, tip_at

_BESIDE = 1e-6
"""[square] A piece this close to a square of the grid is listed in it too: above the rounding of a
point's square, however far the grid lies from the origin."""

_HALF_AND_A_BIT = 0.5001
"""[square] Half a square, and enough to list a piece that only touches it."""


class Buckets(NamedTuple):
    """Pieces that may meet each square of a ``side`` x ``side`` grid, CSR."""

    start: np.ndarray
    items: np.ndarray
    low_x: float
    low_y: float
    size: float
    side: int


@compiled
def build_buckets(pieces, low_x, low_y, size, side):
    """Pieces that may meet each square of a grid whose corner is (low_x, low_y)."""
    m = len(pieces.ptr) - 1
    counts = np.zeros(side * side + 1, np.int64)
    for fill in range(2):
        if fill == 1:
            for k in range(side * side):
                counts[k + 1] += counts[k]
            start = counts.copy()
            items = np.empty(counts[side * side], np.int64)
            put = counts.copy()
        for k in range(m):
            x0 = np.inf
            x1 = -np.inf
            y0 = np.inf
            y1 = -np.inf
            for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
                v = pieces.slot_vertex[s]
                x0 = min(x0, pieces.x[v])
                x1 = max(x1, pieces.x[v])
                y0 = min(y0, pieces.y[v])
                y1 = max(y1, pieces.y[v])
            i0 = max(0, int(math.floor((x0 - low_x) / size - _BESIDE)))
            i1 = min(side - 1, int(math.floor((x1 - low_x) / size + _BESIDE)))
            j0 = max(0, int(math.floor((y0 - low_y) / size - _BESIDE)))
            j1 = min(side - 1, int(math.floor((y1 - low_y) / size + _BESIDE)))
            for i in range(i0, i1 + 1):
                for j in range(j0, j1 + 1):
                    cx = low_x + (i + 0.5) * size
                    cy = low_y + (j + 0.5) * size
                    apart = False
                    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
                        v = pieces.slot_vertex[s]
                        nx = pieces.normal_x[s]
                        ny = pieces.normal_y[s]
                        gap = nx * (cx - pieces.x[v]) + ny * (cy - pieces.y[v])
                        if gap < -_HALF_AND_A_BIT * size * (abs(nx) + abs(ny)):
                            apart = True
                            break
                    if apart:
                        continue
                    if fill == 0:
                        counts[i * side + j + 1] += 1
                    else:
                        items[put[i * side + j]] = k
                        put[i * side + j] += 1
    return Buckets(start, items, low_x, low_y, size, side)


@compiled_borrowing
def _slack(pieces, k, x, y, enough):
    """How far inside the half planes of piece k a point is; less than ``enough`` is enough said.

    Outside by a little the half planes across its sharp tips count, too: two edges of a sliver are
    near a point that is far beyond where they meet.
    """
    least = np.inf
    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
        v = pieces.slot_vertex[s]
        gap = pieces.normal_x[s] * (x - pieces.x[v]) + pieces.normal_y[s] * (y - pieces.y[v])
        least = min(least, gap)
        if least < enough:
            return least
    if least >= 0.0:
        return least
    before = pieces.ptr[k + 1] - 1
    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
        tip = tip_at(pieces, before, s, RIGHT)
        if tip.sharp:
            v = pieces.slot_vertex[s]
            least = min(least, tip.n_x * (x - pieces.x[v]) + tip.n_y * (y - pieces.y[v]))
        before = s
    return least


@compiled_borrowing
def holds(pieces, k, x, y, give):
    """Whether a point is in piece k, or outside by at most about ``give``, beyond its tips too."""
    return _slack(pieces, k, x, y, -give) >= -give


@compiled
def locate(pieces, buckets, x, y, tolerance):
    """Piece that holds (x, y): an index, or -1 if none does to within ``tolerance``."""
    start, side = buckets.start, buckets.side
    i = int(math.floor((x - buckets.low_x) / buckets.size))
    j = int(math.floor((y - buckets.low_y) / buckets.size))
    best = -tolerance
    found = -1
    if 0 <= i < side and 0 <= j < side:
        for at in range(start[i * side + j], start[i * side + j + 1]):
            gap = _slack(pieces, buckets.items[at], x, y, best)
            if gap >= best:
                best = gap
                found = buckets.items[at]
        return found
    for k in range(len(pieces.ptr) - 1):
        gap = _slack(pieces, k, x, y, best)
        if gap >= best:
            best = gap
            found = k
    return found


@compiled
def cells_of(pieces, fingers, buckets, tolerance):
    """Pieces of the fingers (n, f, 2) of every placement, (n, f); -1 where there is none."""
    cells = np.empty((len(fingers), fingers.shape[1]), np.int64)
    for row in range(len(fingers)):
        for f in range(fingers.shape[1]):
            cells[row, f] = locate(
                pieces, buckets, fingers[row, f, 0], fingers[row, f, 1], tolerance
            )
    return cells


@compiled
def _depth(ring, x, y):
    """How far a point is inside the polygon; negative outside."""
    n = len(ring)
    nearest = np.inf
    odd = False
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        ax = ring[a, 0]
        ay = ring[a, 1]
        sx = ring[b, 0] - ax
        sy = ring[b, 1] - ay
        square = sx * sx + sy * sy
        if square == 0.0:  # two vertices that a shift of the ring has made one
            continue
        t = ((x - ax) * sx + (y - ay) * sy) / square
        t = min(1.0, max(0.0, t))
        gx = x - ax - t * sx
        gy = y - ay - t * sy
        nearest = min(nearest, gx * gx + gy * gy)
        if (ay > y) != (ring[b, 1] > y) and x < ax + (y - ay) / sy * sx:
            odd = not odd
    gap = math.sqrt(nearest)
    return gap if odd else -gap


@compiled
def depth_inside(ring, points, radius):
    """How far each point (n, 2) is inside the polygon grown by ``radius``; negative outside."""
    depth = np.empty(len(points))
    for row in range(len(points)):
        depth[row] = radius + _depth(ring, points[row, 0], points[row, 1])
    return depth


@compiled
def nodes_of(keys, values, cells, m, inside):
    """Visited node of every cell (n, 3), or -1 where it was not reached below the escape."""
    nodes = np.empty(len(cells), np.int64)
    for row in range(len(cells)):
        nodes[row] = -1
        if cells[row, 0] >= 0 and cells[row, 1] >= 0 and cells[row, 2] >= 0:
            key = (cells[row, 0] * m + cells[row, 1]) * m + cells[row, 2]
            at = hash_slot(keys, key)
            if keys[at] != -1 and values[at] < inside:
                nodes[row] = values[at]
    return nodes
