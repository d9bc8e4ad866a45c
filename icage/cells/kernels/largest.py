"""The largest sigma of a hand in cells that never escape. Our own.

sigma is convex on a cell, so its maximum is at an extreme point: two fingers at corners of their
pieces, or one at a corner and the others on edges.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled

_INSIDE = 1e-9
"""[diameter] A point this far outside a piece is in it: the rounding of w, divided by the sine of
the angle between two edges."""


@compiled
def _holds(pieces, k, x, y):
    """Whether piece k holds a point."""
    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
        v = pieces.slot_vertex[s]
        gap = pieces.normal_x[s] * (x - pieces.x[v]) + pieces.normal_y[s] * (y - pieces.y[v])
        if gap < -_INSIDE * pieces.diameter:
            return False
    return True


@compiled
def _with_two_at_corners(pieces, z, cell, i, j, enough):
    """Fingers i and j at corners, the others wherever that puts them."""
    best = 0.0
    ux, uy = z[j, 0] - z[i, 0], z[j, 1] - z[i, 1]
    norm = ux * ux + uy * uy
    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
        ax, ay = pieces.x[pieces.slot_vertex[s]], pieces.y[pieces.slot_vertex[s]]
        for t in range(pieces.ptr[cell[j]], pieces.ptr[cell[j] + 1]):
            dx = pieces.x[pieces.slot_vertex[t]] - ax
            dy = pieces.y[pieces.slot_vertex[t]] - ay
            wx, wy = (dx * ux + dy * uy) / norm, (dy * ux - dx * uy) / norm
            sigma = np.hypot(wx, wy)
            if sigma <= best:
                continue
            if _all_held(pieces, z, cell, i, ax, ay, wx, wy, j):
                best = sigma
                if best >= enough:
                    return best
    return best


@compiled
def _all_held(pieces, z, cell, i, ax, ay, wx, wy, known):
    """Whether all fingers but i and ``known`` are in their pieces, with finger i at a."""
    for f in range(len(z)):
        if f == i or f == known:
            continue
        vx, vy = z[f, 0] - z[i, 0], z[f, 1] - z[i, 1]
        x, y = ax + wx * vx - wy * vy, ay + wx * vy + wy * vx
        if not _holds(pieces, cell[f], x, y):
            return False
    return True


@compiled
def _with_two_on_edges(pieces, z, cell, i, j, k, enough):
    """Finger i at a corner, j and k on the lines of edges: n . (a + w u - corner) = 0 twice."""
    best = 0.0
    ux, uy = z[j, 0] - z[i, 0], z[j, 1] - z[i, 1]
    vx, vy = z[k, 0] - z[i, 0], z[k, 1] - z[i, 1]
    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
        ax, ay = pieces.x[pieces.slot_vertex[s]], pieces.y[pieces.slot_vertex[s]]
        for t in range(pieces.ptr[cell[j]], pieces.ptr[cell[j] + 1]):
            b = pieces.slot_vertex[t]
            nx, ny = pieces.normal_x[t], pieces.normal_y[t]
            bx, by = nx * ux + ny * uy, ny * ux - nx * uy
            rb = nx * (pieces.x[b] - ax) + ny * (pieces.y[b] - ay)
            for r in range(pieces.ptr[cell[k]], pieces.ptr[cell[k] + 1]):
                c = pieces.slot_vertex[r]
                mx, my = pieces.normal_x[r], pieces.normal_y[r]
                cx, cy = mx * vx + my * vy, my * vx - mx * vy
                rc = mx * (pieces.x[c] - ax) + my * (pieces.y[c] - ay)
                det = bx * cy - by * cx
                if det == 0.0:
                    continue
                wx, wy = (rb * cy - by * rc) / det, (bx * rc - rb * cx) / det
                sigma = np.hypot(wx, wy)
                if best < sigma < math.inf and _all_held(pieces, z, cell, i, ax, ay, wx, wy, i):
                    best = sigma
                    if best >= enough:
                        return best
    return best


@compiled
def largest_sigma(pieces, z, cells, enough):
    """Largest |w| over cells (n, fingers or more), [unit]; no further than ``enough``."""
    best = 0.0
    fingers = len(z)
    for row in range(len(cells)):
        for i in range(fingers):
            j, k = (i + 1) % fingers, (i + 2) % fingers
            best = max(best, _with_two_at_corners(pieces, z, cells[row], i, j, enough))
            best = max(best, _with_two_on_edges(pieces, z, cells[row], i, j, k, enough))
            if best >= enough:
                return best
    return best
