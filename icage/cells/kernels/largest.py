"""The largest sigma of cells: sigma is convex, so it is at an extreme point of the cell."""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.locate import holds

_INSIDE = 1e-9
"""[diameter] A point this far outside a piece is in it: the rounding of w, divided by the sine of
the angle between two edges."""


@compiled
def _two_at_corners(pieces, z, cell, i, give, best):
    """Largest sigma with finger i and the next at corners, or ``best`` if that is more."""
    j, k = (i + 1) % len(cell), (i + 2) % len(cell)
    ux, uy = z[j, 0] - z[i, 0], z[j, 1] - z[i, 1]
    vx, vy = z[k, 0] - z[i, 0], z[k, 1] - z[i, 1]
    norm = ux * ux + uy * uy
    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
        ax, ay = pieces.x[pieces.slot_vertex[s]], pieces.y[pieces.slot_vertex[s]]
        for t in range(pieces.ptr[cell[j]], pieces.ptr[cell[j] + 1]):
            dx = pieces.x[pieces.slot_vertex[t]] - ax
            dy = pieces.y[pieces.slot_vertex[t]] - ay
            wx, wy = (dx * ux + dy * uy) / norm, (dy * ux - dx * uy) / norm
            sigma = math.sqrt(wx * wx + wy * wy)
            if sigma <= best:
                continue
            if holds(pieces, cell[k], ax + wx * vx - wy * vy, ay + wx * vy + wy * vx, give):
                best = sigma
    return best


@compiled
def _one_at_a_corner(pieces, z, cell, i, give, best):
    """Largest sigma with finger i at a corner and the others on edges, or ``best``.

    On the line of an edge: n . (corner + w u - a) = 0, twice.
    """
    j, k = (i + 1) % len(cell), (i + 2) % len(cell)
    ux, uy = z[j, 0] - z[i, 0], z[j, 1] - z[i, 1]
    vx, vy = z[k, 0] - z[i, 0], z[k, 1] - z[i, 1]
    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
        ax, ay = pieces.x[pieces.slot_vertex[s]], pieces.y[pieces.slot_vertex[s]]
        for t in range(pieces.ptr[cell[j]], pieces.ptr[cell[j] + 1]):
            nx, ny = pieces.normal_x[t], pieces.normal_y[t]
            b = pieces.slot_vertex[t]
            gx, gy = ux * nx + uy * ny, ux * ny - uy * nx
            r = nx * (pieces.x[b] - ax) + ny * (pieces.y[b] - ay)
            for q in range(pieces.ptr[cell[k]], pieces.ptr[cell[k] + 1]):
                mx, my = pieces.normal_x[q], pieces.normal_y[q]
                c = pieces.slot_vertex[q]
                hx, hy = vx * mx + vy * my, vx * my - vy * mx
                det = gx * hy - gy * hx
                if det == 0.0:
                    continue
                e = mx * (pieces.x[c] - ax) + my * (pieces.y[c] - ay)
                wx, wy = (r * hy - gy * e) / det, (gx * e - r * hx) / det
                sigma = math.sqrt(wx * wx + wy * wy)
                if not best < sigma < np.inf:
                    continue
                if holds(
                    pieces, cell[j], ax + wx * ux - wy * uy, ay + wx * uy + wy * ux, give
                ) and holds(pieces, cell[k], ax + wx * vx - wy * vy, ay + wx * vy + wy * vx, give):
                    best = sigma
    return best


@compiled
def largest_in(pieces, z, cells, enough):
    """Largest sigma over cells (k, fingers); any value of at least ``enough`` ends the search."""
    give = _INSIDE * pieces.diameter
    best = 0.0
    for n in range(len(cells)):
        for i in range(cells.shape[1]):
            best = _two_at_corners(pieces, z, cells[n], i, give, best)
            best = _one_at_a_corner(pieces, z, cells[n], i, give, best)
        if best >= enough:
            break
    return best
