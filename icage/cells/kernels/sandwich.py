"""Where one finger can be in one cell below a level: a convex set between two polygons.

Rays shot at the corners of an outer polygon yield both boundary points (their hull is inside) and
cuts (what is left is outside). Our own.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.cells.kernels.convex_polygon import area, beyond, centroid, clip, hull
from icage.cells.kernels.cut import boundary_point, cut, other_rows
from icage.kernels.compiled import compiled

CORNERS = 320
"""Room for the corners of either polygon."""

_ROUNDS = 14
_CENTRE_CUTS = 40


@compiled
def sandwich(pieces, z, i, cell, level, x0, y0, enough, scratch, inner, outer):
    """Inner and outer polygon of finger i's positions in one cell below ``level``.

    (x0, y0) is a position in the set; refined until the areas differ by less than ``enough``.
    Fills ``inner`` (2, CORNERS) and ``outer``; returns their corner counts.
    """
    j = (i + 1) % 3
    k = (i + 2) % 3
    rows = scratch[:, :5]
    n = other_rows(pieces, z, i, j, cell[j], rows, 0)
    n = other_rows(pieces, z, i, k, cell[k], rows, n)
    tiny = 1e-11 * pieces.scale
    # an offset of a few rounding errors of the rows, per unit of their multipliers
    px = outer[0]
    py = outer[1]
    done = np.zeros(CORNERS, np.bool_)
    qx = np.empty(CORNERS)
    qy = np.empty(CORNERS)
    qdone = np.zeros(CORNERS, np.bool_)
    m = 0
    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
        v = pieces.slot_vertex[s]
        px[m], py[m] = pieces.x[v], pieces.y[v]
        m += 1
    bx = np.empty(CORNERS)
    by = np.empty(CORNERS)
    bx[0], by[0] = x0, y0
    nb = 1
    hx = inner[0]
    hy = inner[1]
    nh = 1
    hx[0], hy[0] = x0, y0
    cx = x0
    cy = y0
    share = 0.0
    thin = True  # hardly any of the outer polygon is known to be inside
    for _ in range(_ROUNDS):
        if area(px, py, m) - area(hx, hy, nh) < enough:
            break
        before = m
        todo = 0
        tx = px[:before].copy()
        ty = py[:before].copy()
        skip = done[:before].copy()
        for a in range(before):
            if skip[a] or m > CORNERS - 8 or nb > CORNERS - 8:
                continue
            if nh > 2 and beyond(tx[a], ty[a], hx, hy, nh) <= share:
                continue
            todo += 1
            outside, e, gx, gy, weight = cut(rows, n, tx[a], ty[a], level)
            if not outside:
                bx[nb], by[nb] = tx[a], ty[a]
                nb += 1
                for b in range(m):
                    if px[b] == tx[a] and py[b] == ty[a]:
                        done[b] = True
                continue
            x, y, inside, ce, cgx, cgy, ex, ey, cw = boundary_point(
                rows, n, cx, cy, tx[a], ty[a], level, tiny
            )
            bx[nb], by[nb] = x, y
            nb += 1
            # of the corner's own cut and the one nearest to the set the deeper; both while the set
            # looks like less than an area
            if not inside:
                depth = ce + cgx * (tx[a] - ex) + cgy * (ty[a] - ey)
                deeper = depth * math.hypot(gx, gy) > e * math.hypot(cgx, cgy)
                if thin and m < CORNERS - 4:
                    spare = 1e-3 * tiny * cw
                    m = clip(px, py, done, m, ce, cgx, cgy, ex, ey, spare, qx, qy, qdone)
                    deeper = False
                if deeper:
                    e, gx, gy, weight = ce, cgx, cgy, cw
                else:
                    ex, ey = tx[a], ty[a]
            else:
                ex, ey = tx[a], ty[a]
            m = clip(px, py, done, m, e, gx, gy, ex, ey, 1e-3 * tiny * weight, qx, qy, qdone)
        if m < 3:
            break
        # corners of a thin set add little to its hull one by one: where none seems worth it though
        # the areas still differ, ask for less
        share = enough / (2.0 * m) if todo > 0 or share == 0.0 else 0.25 * share
        nh = hull(bx, by, nb, qx, qy)
        hx[:nh] = qx[:nh]
        hy[:nh] = qy[:nh]
        bx[:nh] = qx[:nh]
        by[:nh] = qy[:nh]
        nb = nh
        thin = area(hx, hy, nh) < 0.01 * area(px, py, m)
        # shoot from well inside: the middle of the outer polygon, cut down until it is in the set
        # (the position given may lie on the boundary, where rays along it see nothing)
        for _ in range(_CENTRE_CUTS):
            ox, oy = centroid(px, py, m)
            outside, e, gx, gy, weight = cut(rows, n, ox, oy, level)
            if not outside:
                cx = ox
                cy = oy
                bx[nb], by[nb] = cx, cy
                nb += 1
                break
            if not thin:
                cx = hx[:nh].mean()
                cy = hy[:nh].mean()
                break
            m = clip(px, py, done, m, e, gx, gy, ox, oy, 1e-3 * tiny * weight, qx, qy, qdone)
            if m < 3 or area(px, py, m) < 1e-3 * enough:
                break
        if m < 3:
            break
    return nh, m
