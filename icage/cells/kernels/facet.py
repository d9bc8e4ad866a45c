"""The pass value: least sigma with one finger on a segment and the others in convex pieces.

Finger i stands at P + tau e on the segment, the others at that point plus w (z_j - z_i), each in
its convex piece. Every constraint is linear in (tau, w); pairing the lower and the upper bounds on
tau (Fourier-Motzkin) leaves half planes for w alone, and the pass value is the least |w| in them.
Our own. [docs/theory.md, Sec. 3.3]

The doubles go first; wherever rounding could move the value by more than ``worst`` the answer is
computed again in double-double arithmetic from the same vertices.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.min_norm import (
    FOUND,
    INFEASIBLE,
    UNSURE,
    LeastNorm,
    NormStatus,
    min_norm,
    min_norm_careful,
)
from icage.kernels import double_double as dd
from icage.kernels.compiled import compiled

MAX_EDGES = 12
"""Most edges of a merged piece: bounds the number of rows below."""

MAX_BASE = 2 * MAX_EDGES + 2
MAX_ROWS = (MAX_EDGES + 2) * (MAX_EDGES + 2) + MAX_BASE
_EPS = 2.220446049250313e-16
"""[1] The last place of a double."""

CLEARANCE = 2e-14
"""[diameter] Touching is free: a facet that is empty by no more than this counts as open, so that
the rounding of a turned drawing cannot close a passage of no width."""

_FIRST_GIVE = 1e-3
"""[CLEARANCE] What a facet that looks empty is given first; ten times more each try, up to all."""

_NO_ROW = 1e-11
"""[1] A row whose g is this small against its weights says nothing about w: only rounding is left
of it, and dividing by it would make an error of 1e-5 of that."""

_CAREFUL_SLACK = 1e-24
"""[diameter] In double-double a row may be violated by this: above rounding at 1e-32 of lengths
that are divided by the sine of a sliver's angle."""

_CAREFUL_NO_ROW = 1e-27
"""[1] The same as ``_NO_ROW`` in double-double."""

G_X, G_Y, ALONG, BOUND, ERROR = range(5)
"""Columns of the half planes g . w + h tau >= c +- error: g, h, c, error."""

_ROW_C, _ROW_ERROR = 2, 3
"""Columns after g of the half planes g . w >= c +- error of ``min_norm``."""

_C_GX, _C_GY, _C_ALONG, _C_BOUND = 0, 2, 4, 6
"""The same in double-double, each hi, lo."""


class Facet(NamedTuple):
    """Finger ``finger`` on the segment between two vertices, the others in their pieces."""

    finger: int
    start: int
    end: int
    second: int
    second_piece: int
    third: int
    third_piece: int


class Segment(NamedTuple):
    """A segment from (x, y) in the unit direction (e_x, e_y)."""

    x: float
    y: float
    e_x: float
    e_y: float
    length: float


class Pass(NamedTuple):
    """Least sigma on a facet and w there; inf where there is none."""

    sigma: float
    w_x: float
    w_y: float


class Stretch(NamedTuple):
    """Both ends of where a finger may be along a segment."""

    x_lo: float
    y_lo: float
    x_hi: float
    y_hi: float


class Room(NamedTuple):
    """Memory that the passes of one search share; ``tally`` counts [all calls, careful calls]."""

    base: np.ndarray
    rows: np.ndarray
    tally: np.ndarray


class _CarefulVector(NamedTuple):
    """A vector in double-double."""

    x_hi: float
    x_lo: float
    y_hi: float
    y_lo: float


class _Stored(NamedTuple):
    """How many rows there are now, and whether the last one leaves anything."""

    count: int
    status: NormStatus


@compiled
def new_room():
    """Memory for ``pass_value``."""
    return Room(np.empty((MAX_BASE, 5)), np.empty((MAX_ROWS, 4)), np.zeros(2, np.int64))


@compiled
def facet_of(pieces, cell, finger, slot):
    """The facet of a cell (3,) where a finger is on the edge ``slot`` of its piece."""
    piece = cell[finger]
    after = slot + 1 if slot + 1 < pieces.ptr[piece + 1] else pieces.ptr[piece]
    second = (finger + 1) % 3
    third = (finger + 2) % 3
    return Facet(
        finger,
        pieces.slot_vertex[slot],
        pieces.slot_vertex[after],
        second,
        cell[second],
        third,
        cell[third],
    )


@compiled
def _segment_of(pieces, facet):
    px = pieces.x[facet.start]
    py = pieces.y[facet.start]
    ex = pieces.x[facet.end] - px
    ey = pieces.y[facet.end] - py
    length = np.hypot(ex, ey)
    return Segment(px, py, ex / length, ey / length, length)


@compiled
def _base_rows(pieces, z, still, segment, finger, piece, base, count):
    """Append the half planes of one finger's piece; ``still`` is the finger on the segment."""
    vx, vy, ptr, slot_vertex = pieces.x, pieces.y, pieces.ptr, pieces.slot_vertex
    ux = z[finger, 0] - z[still, 0]
    uy = z[finger, 1] - z[still, 1]
    size = abs(ux) + abs(uy)
    for s in range(ptr[piece], ptr[piece + 1]):
        nx = pieces.normal_x[s]
        ny = pieces.normal_y[s]
        a = slot_vertex[s]
        dx = vx[a] - segment.x
        dy = vy[a] - segment.y
        base[count, G_X] = ux * nx + uy * ny
        base[count, G_Y] = ux * ny - uy * nx
        base[count, ALONG] = nx * segment.e_x + ny * segment.e_y
        base[count, BOUND] = nx * dx + ny * dy
        base[count, ERROR] = CLEARANCE * pieces.scale + 4.0 * _EPS * (
            abs(dx) + abs(dy) + pieces.scale * size
        )
        count += 1
    return count


@compiled
def _rows_of_others(pieces, z, facet, segment, base):
    """The half planes of both other fingers; returns how many."""
    n = _base_rows(pieces, z, facet.finger, segment, facet.second, facet.second_piece, base, 0)
    return _base_rows(pieces, z, facet.finger, segment, facet.third, facet.third_piece, base, n)


@compiled
def pass_fast(pieces, z, facet, cap, worst, room):
    """The least norm in doubles; ``cap`` is the largest sigma of interest."""
    base, rows = room.base, room.rows
    segment = _segment_of(pieces, facet)
    n = _rows_of_others(pieces, z, facet, segment, base)
    # tau from 0 ...
    base[n, G_X], base[n, G_Y], base[n, ALONG], base[n, BOUND] = 0.0, 0.0, 1.0, 0.0
    base[n, ERROR] = 0.0
    n += 1
    # ... to the length of the segment
    base[n, G_X], base[n, G_Y], base[n, ALONG], base[n, BOUND] = 0.0, 0.0, -1.0, -segment.length
    base[n, ERROR] = 2.0 * _EPS * segment.length
    n += 1
    count = 0
    for a in range(n):
        ha = base[a, ALONG]
        if ha == 0.0:
            count, status = _put(
                base[a, G_X], base[a, G_Y], base[a, BOUND], base[a, ERROR], 1.0, cap, rows, count
            )
            if status != FOUND:
                return LeastNorm(status, 0.0, 0.0)
        elif ha > 0.0:
            for b in range(n):
                hb = base[b, ALONG]
                if hb < 0.0:
                    gx = ha * base[b, G_X] - hb * base[a, G_X]
                    gy = ha * base[b, G_Y] - hb * base[a, G_Y]
                    c = ha * base[b, BOUND] - hb * base[a, BOUND]
                    err = ha * base[b, ERROR] - hb * base[a, ERROR]
                    count, status = _put(gx, gy, c, err, ha - hb, cap, rows, count)
                    if status != FOUND:
                        return LeastNorm(status, 0.0, 0.0)
    return min_norm(rows, count, worst)


@compiled
def _put(gx, gy, c, err, weight, cap, rows, count):
    """Store one row scaled to |g| = 1, unless it holds for every |w| <= cap or for none."""
    norm = np.hypot(gx, gy)
    reach = norm * cap
    if c + err + reach < 0.0:
        return _Stored(count, FOUND)
    if c - err - reach > 0.0:
        return _Stored(count, INFEASIBLE)
    if norm < _NO_ROW * weight:
        if c <= err + reach and c >= -err - reach:
            return _Stored(count, UNSURE)
        return _Stored(count, FOUND)
    rows[count, G_X] = gx / norm
    rows[count, G_Y] = gy / norm
    rows[count, _ROW_C] = c / norm
    rows[count, _ROW_ERROR] = err / norm
    return _Stored(count + 1, FOUND)


@compiled
def _careful_rows(pieces, z, facet, side, finger, piece, base, count):
    """Append the half planes of one finger's piece; ``side`` is the segment, not of length 1."""
    vx, vy, ptr, slot_vertex = pieces.x, pieces.y, pieces.ptr, pieces.slot_vertex
    uxh, uxl = dd.two_sum(z[finger, 0], -z[facet.finger, 0])
    uyh, uyl = dd.two_sum(z[finger, 1], -z[facet.finger, 1])
    for s in range(ptr[piece], ptr[piece + 1]):
        a = slot_vertex[s]
        b = slot_vertex[s + 1 if s + 1 < ptr[piece + 1] else ptr[piece]]
        # inward normal of a counterclockwise piece: the edge turned left by a right angle
        nxh, nxl = dd.two_sum(vy[a], -vy[b])
        nyh, nyl = dd.two_sum(vx[b], -vx[a])
        inv = 1.0 / np.hypot(nxh, nyh)
        nxh, nxl = dd.scale(nxh, nxl, inv)
        nyh, nyl = dd.scale(nyh, nyl, inv)
        base[count, _C_GX], base[count, _C_GX + 1] = dd.dot(uxh, uxl, uyh, uyl, nxh, nxl, nyh, nyl)
        base[count, _C_GY], base[count, _C_GY + 1] = dd.dot(
            uxh, uxl, -uyh, -uyl, nyh, nyl, nxh, nxl
        )
        base[count, _C_ALONG], base[count, _C_ALONG + 1] = dd.dot(
            nxh, nxl, nyh, nyl, side.x_hi, side.x_lo, side.y_hi, side.y_lo
        )
        dxh, dxl = dd.two_sum(vx[a], -vx[facet.start])
        dyh, dyl = dd.two_sum(vy[a], -vy[facet.start])
        base[count, _C_BOUND], base[count, _C_BOUND + 1] = dd.dot(
            nxh, nxl, nyh, nyl, dxh, dxl, dyh, dyl
        )
        count += 1
    return count


@compiled
def pass_careful(pieces, z, facet, cap, give):
    """The least norm in double-double; here tau runs over [0, 1].

    ``give`` moves every edge of the pieces outward.
    """
    base = np.empty((MAX_BASE, 8))
    rows = np.empty((MAX_ROWS, 6))
    slack = _CAREFUL_SLACK * pieces.scale
    x_hi, x_lo = dd.two_sum(pieces.x[facet.end], -pieces.x[facet.start])
    y_hi, y_lo = dd.two_sum(pieces.y[facet.end], -pieces.y[facet.start])
    side = _CarefulVector(x_hi, x_lo, y_hi, y_lo)
    n = _careful_rows(pieces, z, facet, side, facet.second, facet.second_piece, base, 0)
    n = _careful_rows(pieces, z, facet, side, facet.third, facet.third_piece, base, n)
    for a in range(n):
        base[a, _C_BOUND], base[a, _C_BOUND + 1] = dd.sub(
            base[a, _C_BOUND], base[a, _C_BOUND + 1], give, 0.0
        )
    base[n, :] = 0.0
    base[n, _C_ALONG] = pieces.scale
    n += 1
    base[n, :] = 0.0
    base[n, _C_ALONG] = -pieces.scale
    base[n, _C_BOUND] = -pieces.scale
    n += 1
    count = 0
    for a in range(n):
        ha = base[a, _C_ALONG]
        if ha == 0.0:
            g = _CarefulVector(
                base[a, _C_GX], base[a, _C_GX + 1], base[a, _C_GY], base[a, _C_GY + 1]
            )
            count, feasible = _careful_put(
                g, base[a, _C_BOUND], base[a, _C_BOUND + 1], cap, slack, rows, count
            )
            if not feasible:
                return LeastNorm(INFEASIBLE, 0.0, 0.0)
        elif ha > 0.0:
            for b in range(n):
                hb = base[b, _C_ALONG]
                if hb < 0.0:
                    # over the larger weight, so that no row is scaled up from nothing
                    inv = 1.0 / max(ha, -hb)
                    mah, mal = dd.scale(ha, base[a, _C_ALONG + 1], inv)
                    mbh, mbl = dd.scale(-hb, -base[b, _C_ALONG + 1], inv)
                    th, tl = dd.mul(mah, mal, base[b, _C_GX], base[b, _C_GX + 1])
                    sh, sl = dd.mul(mbh, mbl, base[a, _C_GX], base[a, _C_GX + 1])
                    gxh, gxl = dd.add(th, tl, sh, sl)
                    th, tl = dd.mul(mah, mal, base[b, _C_GY], base[b, _C_GY + 1])
                    sh, sl = dd.mul(mbh, mbl, base[a, _C_GY], base[a, _C_GY + 1])
                    gyh, gyl = dd.add(th, tl, sh, sl)
                    th, tl = dd.mul(mah, mal, base[b, _C_BOUND], base[b, _C_BOUND + 1])
                    sh, sl = dd.mul(mbh, mbl, base[a, _C_BOUND], base[a, _C_BOUND + 1])
                    ch, cl = dd.add(th, tl, sh, sl)
                    g = _CarefulVector(gxh, gxl, gyh, gyl)
                    count, feasible = _careful_put(g, ch, cl, cap, slack, rows, count)
                    if not feasible:
                        return LeastNorm(INFEASIBLE, 0.0, 0.0)
    return min_norm_careful(rows, count, slack)


@compiled
def _careful_put(g, ch, cl, cap, slack, rows, count):
    norm = np.hypot(g.x_hi, g.y_hi)
    if ch + norm * cap < -slack:
        return count, True
    if ch - norm * cap > slack:
        return count, False
    if norm < _CAREFUL_NO_ROW:
        return count, True
    inv = 1.0 / norm
    rows[count, 0], rows[count, 1] = dd.scale(g.x_hi, g.x_lo, inv)
    rows[count, 2], rows[count, 3] = dd.scale(g.y_hi, g.y_lo, inv)
    rows[count, 4], rows[count, 5] = dd.scale(ch, cl, inv)
    return count + 1, True


@compiled
def pass_value(pieces, z, facet, cap, worst, room):
    """Least sigma on a facet; inf where there is none below ``cap``."""
    room.tally[0] += 1
    found = pass_fast(pieces, z, facet, cap, worst, room)
    if found.status == UNSURE:
        room.tally[1] += 1
        found = pass_careful(pieces, z, facet, cap, 0.0)
        # as little as will do: in a sliver what is given comes back a thousandfold in sigma
        give = _FIRST_GIVE * CLEARANCE * pieces.scale
        while found.status == INFEASIBLE and give <= 1.01 * CLEARANCE * pieces.scale:
            found = pass_careful(pieces, z, facet, cap, give)
            give *= 10.0
    if found.status == INFEASIBLE:
        return Pass(np.inf, 0.0, 0.0)
    sigma = np.hypot(found.w_x, found.w_y)
    if sigma > cap:
        return Pass(np.inf, 0.0, 0.0)
    return Pass(sigma, found.w_x, found.w_y)


@compiled
def finger_on_segment(pieces, z, facet, wx, wy, base):
    """Where the finger of a facet may be along its segment for a given w."""
    segment = _segment_of(pieces, facet)
    n = _rows_of_others(pieces, z, facet, segment, base)
    lo = 0.0
    hi = segment.length
    for a in range(n):
        rest = base[a, BOUND] - base[a, G_X] * wx - base[a, G_Y] * wy
        h = base[a, ALONG]
        # give every bound its own rounding error: one from a nearly parallel edge is good to
        # little along the segment, and must not push a finger through an edge that is not
        doubt = 4.0 * base[a, ERROR]
        if abs(h) * segment.length < 4.0 * doubt:
            continue
        if h > 0.0:
            lo = max(lo, min((rest - doubt) / h, segment.length))
        elif h < 0.0:
            hi = min(hi, max((rest - doubt) / h, 0.0))
    if lo > hi:
        lo = 0.5 * (lo + hi)
        hi = lo
    return Stretch(
        segment.x + lo * segment.e_x,
        segment.y + lo * segment.e_y,
        segment.x + hi * segment.e_x,
        segment.y + hi * segment.e_y,
    )


@compiled
def ends_on_facet(pieces, z, cell, finger, slot, wx, wy):
    """Where a finger may be along the edge ``slot`` of its piece for a given w."""
    facet = facet_of(pieces, cell, finger, slot)
    return finger_on_segment(pieces, z, facet, wx, wy, np.empty((MAX_BASE, 5)))
