"""Lines that cut points off the positions a finger may take in one cell below a level.

In one cell the finger's positions p with mu(p) <= c, mu(p) = least |w| that keeps the other fingers
in their pieces, form a convex set. Where mu(p) > c its subgradient gives a line that cuts p off and
keeps the set; where no w exists at all, Farkas' multipliers do. Our own.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.convex_polygon import Line
from icage.kernels.compiled import compiled

_SATISFIED = 1e-15
"""[level] A row violated by less is satisfied: the rounding of a double in w."""

_PARALLEL = 1e-13
"""[1] Rows under a smaller sine are parallel (as in ``min_norm``), and contradict each other if
they do by more than this share of the level."""

ROW_GX, ROW_GY, ROW_NX, ROW_NY, ROW_OFFSET = range(5)
"""Columns of the rows g . w >= offset - n . p: g, n, offset."""


class Proof(NamedTuple):
    """Non-negative multipliers of up to three rows (0: the row is left out)."""

    row: int
    times: float
    row_a: int
    times_a: float
    row_b: int
    times_b: float


class Cut(NamedTuple):
    """Whether a point is outside the set, and if so a line that cuts it off."""

    outside: bool
    line: Line


class BoundaryPoint(NamedTuple):
    """A point on the boundary of the set.

    ``inside``: the point aimed at is in the set. Else ``line`` is the last cut.
    """

    x: float
    y: float
    inside: bool
    line: Line


@compiled
def other_rows(pieces, z, i, finger, piece, rows, n):
    """Append the rows of one finger's half planes, over |z_finger - z_i|; returns how many."""
    ux = z[finger, 0] - z[i, 0]
    uy = z[finger, 1] - z[i, 1]
    size = np.hypot(ux, uy)
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        nx = pieces.normal_x[s] / size
        ny = pieces.normal_y[s] / size
        v = pieces.slot_vertex[s]
        rows[n, ROW_GX] = ux * nx + uy * ny
        rows[n, ROW_GY] = ux * ny - uy * nx
        rows[n, ROW_NX] = nx
        rows[n, ROW_NY] = ny
        rows[n, ROW_OFFSET] = nx * pieces.x[v] + ny * pieces.y[v]
        n += 1
    return n


@compiled
def _line(rows, level, x, y, proof):
    """The line that multipliers prove, seen from p = (x, y).

    Any w there has |w| >= sum m c(q) / |sum m g|, so sum m c(q) - level |sum m g| <= 0 holds for
    every q of the set, whatever rounding did to the multipliers.
    """
    r, m_r = proof.row, proof.times
    a, m_a = proof.row_a, proof.times_a
    b, m_b = proof.row_b, proof.times_b
    sx = m_r * rows[r, ROW_GX]
    sy = m_r * rows[r, ROW_GY]
    hx = -m_r * rows[r, ROW_NX]
    hy = -m_r * rows[r, ROW_NY]
    c = m_r * rows[r, ROW_OFFSET]
    if m_a > 0.0:
        sx += m_a * rows[a, ROW_GX]
        sy += m_a * rows[a, ROW_GY]
        hx -= m_a * rows[a, ROW_NX]
        hy -= m_a * rows[a, ROW_NY]
        c += m_a * rows[a, ROW_OFFSET]
    if m_b > 0.0:
        sx += m_b * rows[b, ROW_GX]
        sy += m_b * rows[b, ROW_GY]
        hx -= m_b * rows[b, ROW_NX]
        hy -= m_b * rows[b, ROW_NY]
        c += m_b * rows[b, ROW_OFFSET]
    e = c + hx * x + hy * y - level * np.hypot(sx, sy)
    return Line(e, hx, hy, x, y, m_r + m_a + m_b)


@compiled
def cut(rows, n, x, y, level):
    """Is p = (x, y) outside the set, and a line with e + g . (q - p) <= 0 on all of the set.

    Only the other two fingers' constraints count.
    """
    wx = 0.0
    wy = 0.0
    first = -1
    second = -1
    for r in range(n):
        gx = rows[r, ROW_GX]
        gy = rows[r, ROW_GY]
        c = rows[r, ROW_OFFSET] - rows[r, ROW_NX] * x - rows[r, ROW_NY] * y
        if gx * wx + gy * wy >= c - _SATISFIED * level:
            continue
        bx = c * gx
        by = c * gy
        lo = -np.inf
        hi = np.inf
        at_lo = -1
        at_hi = -1
        for q in range(r):
            a = rows[q, ROW_GY] * gx - rows[q, ROW_GX] * gy
            b = rows[q, ROW_OFFSET] - rows[q, ROW_NX] * x - rows[q, ROW_NY] * y
            b -= rows[q, ROW_GX] * bx + rows[q, ROW_GY] * by
            if a > _PARALLEL:
                if b / a > lo:
                    lo = b / a
                    at_lo = q
            elif a < -_PARALLEL:
                if b / a < hi:
                    hi = b / a
                    at_hi = q
            elif b > _PARALLEL * level:
                return Cut(True, _line(rows, level, x, y, Proof(r, 1.0, q, 1.0, q, 0.0)))
        if lo > hi:
            m_lo = -(rows[at_hi, ROW_GY] * gx - rows[at_hi, ROW_GX] * gy)
            m_hi = rows[at_lo, ROW_GY] * gx - rows[at_lo, ROW_GX] * gy
            m_r = -(
                m_lo * (rows[at_lo, ROW_GX] * gx + rows[at_lo, ROW_GY] * gy)
                + m_hi * (rows[at_hi, ROW_GX] * gx + rows[at_hi, ROW_GY] * gy)
            )
            proof = Proof(r, max(m_r, 0.0), at_lo, m_lo, at_hi, m_hi)
            return Cut(True, _line(rows, level, x, y, proof))
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
    norm = np.hypot(wx, wy)
    if norm <= level or first < 0:
        return Cut(False, Line(norm - level, 0.0, 0.0, x, y, 0.0))
    m_1 = 1.0
    m_2 = 0.0
    if second >= 0:
        det = (
            rows[first, ROW_GX] * rows[second, ROW_GY] - rows[first, ROW_GY] * rows[second, ROW_GX]
        )
        m_1 = max(0.0, (wx * rows[second, ROW_GY] - wy * rows[second, ROW_GX]) / det / norm)
        m_2 = max(0.0, (rows[first, ROW_GX] * wy - rows[first, ROW_GY] * wx) / det / norm)
    return Cut(True, _line(rows, level, x, y, Proof(first, m_1, second, m_2, second, 0.0)))


@compiled
def boundary_point(rows, n, x0, y0, x1, y1, level, tiny):
    """Boundary point on the way from an inside point to (x1, y1), and the last cut."""
    dx = x1 - x0
    dy = y1 - y0
    length = np.hypot(dx, dy)
    t = 1.0
    last = Line(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    inside = True
    for _ in range(60):
        x = x0 + t * dx
        y = y0 + t * dy
        outside, line = cut(rows, n, x, y, level)
        if not outside:
            break
        slope = line.g_x * dx + line.g_y * dy
        if slope <= 0.0:  # only rounding: the cut runs along the ray, from where it starts
            t = 0.0
            break
        inside = False
        last = line
        # a step too short to count may only mean that three rows are about to meet, with another
        # one still violated: move on by a little and look again, until a point is seen inside
        t = max(0.0, t - max(line.e / slope, tiny / length))
        if t == 0.0:
            break
    else:
        t = 0.0
    return BoundaryPoint(x0 + t * dx, y0 + t * dy, inside, last)
