"""Where one finger can be in one cell below a level: a convex set between two polygons.

Rays shot at the corners of an outer polygon yield both boundary points (their hull is inside) and
cuts (what is left is outside). Our own.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.convex_polygon import (
    Corners,
    area,
    beyond,
    centroid,
    clip,
    hull,
    mean,
    new_corners,
)
from icage.cells.kernels.cut import boundary_point, cut, other_rows
from icage.cells.kernels.facet import MAX_BASE
from icage.kernels.compiled import compiled
from icage.kernels.storage import put_first

CORNERS = 320
"""Room for the corners of either polygon."""

_ROUNDS = 14
_CENTRE_CUTS = 40

_TINY = 1e-11
"""[diameter] A step along a ray that is too short to count."""

_SPARE = 1e-3
"""[_TINY] An offset of a few rounding errors of the rows, per unit of their multipliers: a line is
moved outward by this so that it cuts off nothing of the set."""

_THIN = 0.01
"""[1] Where less than this share of the outer polygon is known to be inside, the set is thin."""

_NO_AREA = 1e-3
"""[enough] An outer polygon smaller than this is not worth another cut."""


class Counts(NamedTuple):
    """How many corners the inner and the outer polygon have."""

    inner: int
    outer: int


@compiled
def sandwich(pieces, z, i, cell, level, start, enough, inner, outer):
    """Inner and outer polygon of finger i's positions in one cell below ``level``.

    ``start`` (2,) is a position in the set; refined until the areas differ by less than ``enough``.
    Fills ``inner`` (2, CORNERS) and ``outer``; returns their corner counts.
    """
    x0, y0 = start[0], start[1]
    j = (i + 1) % 3
    k = (i + 2) % 3
    rows = np.empty((MAX_BASE, 5))
    n = other_rows(pieces, z, i, j, cell[j], rows, 0)
    n = other_rows(pieces, z, i, k, cell[k], rows, n)
    tiny = _TINY * pieces.scale
    px = outer[0]
    py = outer[1]
    done = np.zeros(CORNERS, np.bool_)
    polygon = Corners(px, py, done)
    room = new_corners(CORNERS)
    qx, qy = room.x, room.y
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
            outside, line = cut(rows, n, tx[a], ty[a], level)
            if not outside:
                bx[nb], by[nb] = tx[a], ty[a]
                nb += 1
                for b in range(m):
                    if px[b] == tx[a] and py[b] == ty[a]:
                        done[b] = True
                continue
            end = boundary_point(rows, n, cx, cy, tx[a], ty[a], level, tiny)
            bx[nb], by[nb] = end.x, end.y
            nb += 1
            # of the corner's own cut and the one nearest to the set the deeper; both while the set
            # looks like less than an area
            if not end.inside:
                near = end.line
                depth = near.e + near.g_x * (tx[a] - near.c_x) + near.g_y * (ty[a] - near.c_y)
                deeper = depth * np.hypot(line.g_x, line.g_y) > line.e * np.hypot(
                    near.g_x, near.g_y
                )
                if thin and m < CORNERS - 4:
                    m = clip(polygon, m, near, _SPARE * tiny * near.weight, room)
                    deeper = False
                if deeper:
                    line = near
            m = clip(polygon, m, line, _SPARE * tiny * line.weight, room)
        if m < 3:
            break
        # corners of a thin set add little to its hull one by one: where none seems worth it though
        # the areas still differ, ask for less
        share = enough / (2.0 * m) if todo > 0 or share == 0.0 else 0.25 * share
        nh = hull(bx, by, nb, qx, qy)
        put_first(hx, qx, nh)
        put_first(hy, qy, nh)
        put_first(bx, qx, nh)
        put_first(by, qy, nh)
        nb = nh
        thin = area(hx, hy, nh) < _THIN * area(px, py, m)
        # shoot from well inside: the middle of the outer polygon, cut down until it is in the set
        # (the position given may lie on the boundary, where rays along it see nothing)
        for _ in range(_CENTRE_CUTS):
            ox, oy = centroid(px, py, m)
            outside, line = cut(rows, n, ox, oy, level)
            if not outside:
                cx = ox
                cy = oy
                bx[nb], by[nb] = cx, cy
                nb += 1
                break
            if not thin:
                cx = mean(hx, nh)
                cy = mean(hy, nh)
                break
            m = clip(polygon, m, line, _SPARE * tiny * line.weight, room)
            if m < 3 or area(px, py, m) < _NO_AREA * enough:
                break
        if m < 3:
            break
    return Counts(nh, m)
