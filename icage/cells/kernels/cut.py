"""Lines that cut points off the positions a finger may take in one cell below a level.

In one cell the finger's positions p with mu(p) <= c, mu(p) = least |w| that keeps the other fingers
in their pieces, form a convex set. Where mu(p) > c its subgradient gives a line that cuts p off and
keeps the set; where no w exists at all, Farkas' multipliers do. Our own.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled


@compiled
def other_rows(pieces, z, i, finger, piece, rows, n):
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
def boundary_point(rows, n, x0, y0, x1, y1, level, tiny):
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
