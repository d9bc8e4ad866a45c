"""Facets that no hand can reach, told by boxes before any half plane is formed.

Where two fingers stand, the third one follows: with z = (z_k - z_i) / (z_j - z_i) it is at
(1 - z) p_i + z p_j. A segment for p_i and a convex piece for p_j give a box for that point, and
if it is clear of the box round the third finger's piece, the facet is empty. Of the facets next to
the cells of a search about half are, and of these nine in ten are told so for a twentieth of what
the half planes cost. What is not told here is decided by them, so nothing hangs on rounding. Our
own. [docs/theory.md, Sec. 3.3]
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled_borrowing

_SPARE = 1e-9
"""[1] Boxes are apart, or too far, if they are by this share of their coordinates and of the
diameter: far above rounding, and above what touching pieces are given."""


@compiled_borrowing
def out_of_reach(pieces, z, facet, cap):
    """Whether no hand with sigma of at most ``cap`` has its fingers on a facet; False may be both.

    Both of the other fingers are foretold from the segment and the piece of the remaining one, and
    neither may be further from the segment than the hand is long.
    """
    i = facet.finger
    ax, ay = pieces.x[facet.start], pieces.y[facet.start]
    bx, by = pieces.x[facet.end], pieces.y[facet.end]
    for turn in range(2):
        j, piece_j = facet.second, facet.second_piece
        k, piece_k = facet.third, facet.third_piece
        if turn == 1:
            j, piece_j, k, piece_k = k, piece_k, j, piece_j
        ux, uy = z[j, 0] - z[i, 0], z[j, 1] - z[i, 1]
        vx, vy = z[k, 0] - z[i, 0], z[k, 1] - z[i, 1]
        norm = ux * ux + uy * uy
        zx = (vx * ux + vy * uy) / norm
        zy = (vy * ux - vx * uy) / norm
        # where finger k may be for all that the segment and finger j's piece say
        left, right, low, high = np.inf, -np.inf, np.inf, -np.inf
        for s in range(pieces.ptr[piece_j], pieces.ptr[piece_j + 1]):
            v = pieces.slot_vertex[s]
            x = zx * pieces.x[v] - zy * pieces.y[v]
            y = zx * pieces.y[v] + zy * pieces.x[v]
            left, right, low, high = min(left, x), max(right, x), min(low, y), max(high, y)
        rx = 1.0 - zx
        x_a, x_b = rx * ax + zy * ay, rx * bx + zy * by
        y_a, y_b = rx * ay - zy * ax, rx * by - zy * bx
        left, right = left + min(x_a, x_b), right + max(x_a, x_b)
        low, high = low + min(y_a, y_b), high + max(y_a, y_b)
        # ... and for its own piece
        west, east, south, north = np.inf, -np.inf, np.inf, -np.inf
        for s in range(pieces.ptr[piece_k], pieces.ptr[piece_k + 1]):
            v = pieces.slot_vertex[s]
            x, y = pieces.x[v], pieces.y[v]
            west, east, south, north = min(west, x), max(east, x), min(south, y), max(north, y)
        size = pieces.scale * (1.0 + abs(zx) + abs(zy))
        size += max(right - left, high - low) + max(east - west, north - south)
        spare = _SPARE * size
        if left > east + spare or west > right + spare:
            return True
        if low > north + spare or south > high + spare:
            return True
        dx = max(0.0, west - max(ax, bx), min(ax, bx) - east)
        dy = max(0.0, south - max(ay, by), min(ay, by) - north)
        reach = cap * np.sqrt(vx * vx + vy * vy) + spare
        if dx * dx + dy * dy > reach * reach:
            return True
    return False
