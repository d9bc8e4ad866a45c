"""Where one finger can be below a level, cell by cell: a convex set between two polygons.

In one cell the finger's positions p with mu(p) <= c, mu(p) = least |w| that keeps the other fingers
in their pieces, form a convex set. Where mu(p) > c its subgradient gives a line that cuts p off and
keeps the set; where no w exists at all, Farkas' multipliers do. So rays shot at the corners of an
outer polygon yield both boundary points (their hull is inside) and cuts (what is left is outside).
Our own.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.facet import MAX_BASE, MAX_EDGES, finger_on_segment

CORNERS = 320
_ROUNDS = 14
_CENTRE_CUTS = 40


@compiled
def _rows(pieces, z, i, finger, piece, rows, n):
    """(g_x, g_y, n_x, n_y, n.a) of one finger's half planes, over |z_finger - z_i|."""
    ux = z[finger, 0] - z[i, 0]
    uy = z[finger, 1] - z[i, 1]
    size = math.hypot(ux, uy)
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        nx = pieces.normal_x[s] / size
        ny = pieces.normal_y[s] / size
        v = pieces.slot_vertex[s]
        rows[n, 0] = ux * nx + uy * ny
        rows[n, 1] = ux * ny - uy * nx
        rows[n, 2] = nx
        rows[n, 3] = ny
        rows[n, 4] = nx * pieces.x[v] + ny * pieces.y[v]
        n += 1
    return n


@compiled
def _line(rows, level, x, y, r, m_r, a, m_a, b, m_b):
    """The line that non-negative multipliers of up to three rows prove, seen from p = (x, y).

    Any w there has |w| >= sum m c(q) / |sum m g|, so sum m c(q) - level |sum m g| <= 0 holds for
    every q of the set, whatever rounding did to the multipliers. Returns (e, g_x, g_y, sum m).
    """
    sx = m_r * rows[r, 0]
    sy = m_r * rows[r, 1]
    hx = -m_r * rows[r, 2]
    hy = -m_r * rows[r, 3]
    c = m_r * rows[r, 4]
    if m_a > 0.0:
        sx += m_a * rows[a, 0]
        sy += m_a * rows[a, 1]
        hx -= m_a * rows[a, 2]
        hy -= m_a * rows[a, 3]
        c += m_a * rows[a, 4]
    if m_b > 0.0:
        sx += m_b * rows[b, 0]
        sy += m_b * rows[b, 1]
        hx -= m_b * rows[b, 2]
        hy -= m_b * rows[b, 3]
        c += m_b * rows[b, 4]
    return c + hx * x + hy * y - level * math.hypot(sx, sy), hx, hy, m_r + m_a + m_b


@compiled
def cut(rows, n, x, y, level):
    """Is p = (x, y) outside the set, and a line with e + g . (q - p) <= 0 on all of the set.

    Returns (outside, e, g_x, g_y, sum of multipliers); only the other two fingers' constraints.
    """
    wx = 0.0
    wy = 0.0
    first = -1
    second = -1
    for r in range(n):
        gx = rows[r, 0]
        gy = rows[r, 1]
        c = rows[r, 4] - rows[r, 2] * x - rows[r, 3] * y
        if gx * wx + gy * wy >= c - 1e-15 * level:
            continue
        bx = c * gx
        by = c * gy
        lo = -np.inf
        hi = np.inf
        at_lo = -1
        at_hi = -1
        for q in range(r):
            a = rows[q, 1] * gx - rows[q, 0] * gy
            b = rows[q, 4] - rows[q, 2] * x - rows[q, 3] * y
            b -= rows[q, 0] * bx + rows[q, 1] * by
            if a > 1e-13:
                if b / a > lo:
                    lo = b / a
                    at_lo = q
            elif a < -1e-13:
                if b / a < hi:
                    hi = b / a
                    at_hi = q
            elif b > 1e-13 * level:
                e, hx, hy, weight = _line(rows, level, x, y, r, 1.0, q, 1.0, q, 0.0)
                return True, e, hx, hy, weight
        if lo > hi:
            m_lo = -(rows[at_hi, 1] * gx - rows[at_hi, 0] * gy)
            m_hi = rows[at_lo, 1] * gx - rows[at_lo, 0] * gy
            m_r = -(
                m_lo * (rows[at_lo, 0] * gx + rows[at_lo, 1] * gy)
                + m_hi * (rows[at_hi, 0] * gx + rows[at_hi, 1] * gy)
            )
            e, hx, hy, weight = _line(rows, level, x, y, r, max(m_r, 0.0), at_lo, m_lo, at_hi, m_hi)
            return True, e, hx, hy, weight
        s = 0.0
        first = r
        second = -1
        if lo > 0.0:
            s = lo
            second = at_lo
        elif hi < 0.0:
            s = hi
            second = at_hi
        wx = bx - s * gy
        wy = by + s * gx
    norm = math.hypot(wx, wy)
    if norm <= level or first < 0:
        return False, norm - level, 0.0, 0.0, 0.0
    m_1 = 1.0
    m_2 = 0.0
    if second >= 0:
        det = rows[first, 0] * rows[second, 1] - rows[first, 1] * rows[second, 0]
        m_1 = max(0.0, (wx * rows[second, 1] - wy * rows[second, 0]) / det / norm)
        m_2 = max(0.0, (rows[first, 0] * wy - rows[first, 1] * wx) / det / norm)
    e, hx, hy, weight = _line(rows, level, x, y, first, m_1, second, m_2, second, 0.0)
    return True, e, hx, hy, weight


@compiled
def _shoot(rows, n, x0, y0, x1, y1, level, tiny):
    """Boundary point on the way from an inside point to (x1, y1), and the last cut.

    Returns (x, y, inside, e, g_x, g_y, c_x, c_y, weight): ``inside`` if (x1, y1) is in the set; the
    cut is e + g . (q - c) <= 0, ``weight`` the sum of its multipliers.
    """
    dx = x1 - x0
    dy = y1 - y0
    length = math.hypot(dx, dy)
    t = 1.0
    ce, cgx, cgy, ccx, ccy, cw = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    inside = True
    for _ in range(60):
        x = x0 + t * dx
        y = y0 + t * dy
        outside, e, gx, gy, weight = cut(rows, n, x, y, level)
        if not outside:
            break
        slope = gx * dx + gy * dy
        if slope <= 0.0:  # only rounding: the cut runs along the ray, from where it starts
            t = 0.0
            break
        inside = False
        ce, cgx, cgy, ccx, ccy, cw = e, gx, gy, x, y, weight
        # a step too short to count may only mean that three rows are about to meet, with another
        # one still violated: move on by a little and look again, until a point is seen inside
        t = max(0.0, t - max(e / slope, tiny / length))
        if t == 0.0:
            break
    else:
        t = 0.0
    return x0 + t * dx, y0 + t * dy, inside, ce, cgx, cgy, ccx, ccy, cw


@compiled
def _clip(px, py, done, n, e, gx, gy, cx, cy, spare, qx, qy, qdone):
    """Keep the part of a convex polygon with e + g . (q - c) <= 0; returns its corner count."""
    m = 0
    e -= spare  # rounding of a line from multipliers that large
    for a in range(n):
        if m > CORNERS - 3:
            break
        b = a + 1 if a + 1 < n else 0
        va = e + gx * (px[a] - cx) + gy * (py[a] - cy)
        vb = e + gx * (px[b] - cx) + gy * (py[b] - cy)
        if va <= 0.0:
            qx[m], qy[m], qdone[m] = px[a], py[a], done[a]
            m += 1
        if (va < 0.0 < vb) or (vb < 0.0 < va):
            t = va / (va - vb)
            qx[m] = px[a] + t * (px[b] - px[a])
            qy[m] = py[a] + t * (py[b] - py[a])
            qdone[m] = False
            m += 1
    return m


@compiled
def _hull(hx, hy, n, ox, oy):
    """Convex hull of n points, counterclockwise (monotone chain); returns its size."""
    order = np.argsort(hx[:n])
    for a in range(1, n):  # equal x by y: few points, insertion will do
        b = a
        while b > 0 and hx[order[b - 1]] == hx[order[b]] and hy[order[b - 1]] > hy[order[b]]:
            order[b - 1], order[b] = order[b], order[b - 1]
            b -= 1
    m = 0
    bottom = 2
    for turn in range(2):
        for a in range(n):
            k = order[a] if turn == 0 else order[n - 1 - a]
            if turn == 1 and a == 0:
                continue
            while m >= bottom:
                cross = (ox[m - 1] - ox[m - 2]) * (hy[k] - oy[m - 2]) - (oy[m - 1] - oy[m - 2]) * (
                    hx[k] - ox[m - 2]
                )
                if cross > 0.0:
                    break
                m -= 1
            ox[m] = hx[k]
            oy[m] = hy[k]
            m += 1
        bottom = m + 1
    return max(1, m - 1)


@compiled
def _area(x, y, n):
    """Area of a counterclockwise polygon."""
    total = 0.0
    for a in range(1, n - 1):
        total += (x[a] - x[0]) * (y[a + 1] - y[0]) - (x[a + 1] - x[0]) * (y[a] - y[0])
    return 0.5 * total


@compiled
def _centroid(x, y, n):
    """Area centroid of a polygon, or the mean of its corners if it has no area."""
    area = 0.0
    cx = 0.0
    cy = 0.0
    for a in range(1, n - 1):
        part = (x[a] - x[0]) * (y[a + 1] - y[0]) - (x[a + 1] - x[0]) * (y[a] - y[0])
        area += part
        cx += part * (x[a] + x[a + 1] - 2.0 * x[0])
        cy += part * (y[a] + y[a + 1] - 2.0 * y[0])
    if area <= 0.0:
        return x[:n].mean(), y[:n].mean()
    return x[0] + cx / (3.0 * area), y[0] + cy / (3.0 * area)


@compiled
def _beyond(x, y, hx, hy, n):
    """Area that a point adds to the hull (hx, hy)."""
    total = 0.0
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        cross = (hx[b] - hx[a]) * (y - hy[a]) - (hy[b] - hy[a]) * (x - hx[a])
        if cross < 0.0:
            total -= 0.5 * cross
    return total


@compiled
def sandwich(pieces, z, i, cell, level, x0, y0, enough, scratch, inner, outer):
    """Inner and outer polygon of finger i's positions in one cell below ``level``.

    (x0, y0) is a position in the set; refined until the areas differ by less than ``enough``.
    Fills ``inner`` (2, CORNERS) and ``outer``; returns their corner counts.
    """
    j = (i + 1) % 3
    k = (i + 2) % 3
    rows = scratch[:, :5]
    n = _rows(pieces, z, i, j, cell[j], rows, 0)
    n = _rows(pieces, z, i, k, cell[k], rows, n)
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
        if _area(px, py, m) - _area(hx, hy, nh) < enough:
            break
        before = m
        todo = 0
        tx = px[:before].copy()
        ty = py[:before].copy()
        skip = done[:before].copy()
        for a in range(before):
            if skip[a] or m > CORNERS - 8 or nb > CORNERS - 8:
                continue
            if nh > 2 and _beyond(tx[a], ty[a], hx, hy, nh) <= share:
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
            x, y, inside, ce, cgx, cgy, ex, ey, cw = _shoot(
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
                    m = _clip(px, py, done, m, ce, cgx, cgy, ex, ey, spare, qx, qy, qdone)
                    px[:m] = qx[:m]
                    py[:m] = qy[:m]
                    done[:m] = qdone[:m]
                    deeper = False
                if deeper:
                    e, gx, gy, weight = ce, cgx, cgy, cw
                else:
                    ex, ey = tx[a], ty[a]
            else:
                ex, ey = tx[a], ty[a]
            m = _clip(px, py, done, m, e, gx, gy, ex, ey, 1e-3 * tiny * weight, qx, qy, qdone)
            px[:m] = qx[:m]
            py[:m] = qy[:m]
            done[:m] = qdone[:m]
        if m < 3:
            break
        # corners of a thin set add little to its hull one by one: where none seems worth it though
        # the areas still differ, ask for less
        share = enough / (2.0 * m) if todo > 0 or share == 0.0 else 0.25 * share
        nh = _hull(bx, by, nb, qx, qy)
        hx[:nh] = qx[:nh]
        hy[:nh] = qy[:nh]
        bx[:nh] = qx[:nh]
        by[:nh] = qy[:nh]
        nb = nh
        thin = _area(hx, hy, nh) < 0.01 * _area(px, py, m)
        # shoot from well inside: the middle of the outer polygon, cut down until it is in the set
        # (the position given may lie on the boundary, where rays along it see nothing)
        for _ in range(_CENTRE_CUTS):
            ox, oy = _centroid(px, py, m)
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
            m = _clip(px, py, done, m, e, gx, gy, ox, oy, 1e-3 * tiny * weight, qx, qy, qdone)
            px[:m] = qx[:m]
            py[:m] = qy[:m]
            done[:m] = qdone[:m]
            if m < 3 or _area(px, py, m) < 1e-3 * enough:
                break
        if m < 3:
            break
    return nh, m


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
                side = math.hypot(bx - ax, by - ay)
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
    base = np.empty((MAX_BASE, 5))
    for row in range(len(cells)):
        a = standing[row]
        b = (a + 1) % 3
        c = (a + 2) % 3
        slot = slots[row]
        piece = cells[row, a]
        after = slot + 1 if slot + 1 < pieces.ptr[piece + 1] else pieces.ptr[piece]
        xa, ya, xb, yb = finger_on_segment(
            pieces, z, a, pieces.slot_vertex[slot], pieces.slot_vertex[after],
            b, cells[row, b], c, cells[row, c], wx[row], wy[row], base,
        )  # fmt: skip
        ux = z[i, 0] - z[a, 0]
        uy = z[i, 1] - z[a, 1]
        points[row, 0] = 0.5 * (xa + xb) + wx[row] * ux - wy[row] * uy
        points[row, 1] = 0.5 * (ya + yb) + wx[row] * uy + wy[row] * ux
    return points


@compiled
def all_sandwiches(pieces, z, i, nodes, points, level, enough, slack):
    """Sandwiches of finger i over all nodes (n, 3), with a starting position (n, 2) in each.

    Sets that an earlier one of the same piece covers to within ``slack`` are left out. Returns
    (inner corners, inner counts, outer corners, outer counts).
    """
    inner_store = np.empty((1024, 2))
    outer_store = np.empty((1024, 2))
    inner_count = np.empty(len(nodes), np.int64)
    outer_count = np.empty(len(nodes), np.int64)
    inner_start = np.empty(len(nodes), np.int64)
    last = np.full(len(pieces.ptr) - 1, -1, np.int64)  # chains of kept sets by piece
    chain = np.empty(len(nodes), np.int64)
    held = np.empty(len(nodes), np.int64)
    scratch = np.empty((2 * MAX_EDGES + 2, 5))
    inner = np.empty((2, CORNERS))
    outer = np.empty((2, CORNERS))
    kept = 0
    n_in = 0
    n_out = 0
    for k in range(len(nodes)):
        h, m = sandwich(
            pieces, z, i, nodes[k], level, points[k, 0], points[k, 1], enough, scratch, inner, outer
        )
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
    return inner_store[:n_in], inner_count[:kept], outer_store[:n_out], outer_count[:kept]
