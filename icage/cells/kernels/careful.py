"""The pass value in double-double arithmetic, from the same vertices: slow, and always an answer.

For facets where rounding could move the value by more than is allowed, or decide whether there is
one at all. Our own. [docs/decisions/0002-rounding.md]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.facet import MAX_BASE, MAX_ROWS
from icage.cells.kernels.min_norm import INFEASIBLE, LeastNorm, min_norm_careful
from icage.kernels import double_double as dd
from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.tips import SHARP, tip_at

CAREFUL_SLACK = 1e-24
"""[diameter] In double-double a row may be violated by this: above rounding at 1e-32 of lengths
that are divided by the sine of a sliver's angle."""

_CAREFUL_NO_ROW = 1e-27
"""[1] The same as ``_NO_ROW`` in double-double."""

_C_GX, _C_GY, _C_ALONG, _C_BOUND = 0, 2, 4, 6
"""Columns of the half planes g . w + h tau >= c, each hi, lo."""


class _CarefulVector(NamedTuple):
    """A vector in double-double."""

    x_hi: float
    x_lo: float
    y_hi: float
    y_lo: float


class CarefulBound(NamedTuple):
    """A half plane g . w + h tau >= c in double-double, tau over [0, 1]."""

    g: _CarefulVector
    along_hi: float
    along_lo: float
    c_hi: float
    c_lo: float


class CarefulRow(NamedTuple):
    """A half plane g . w >= c in double-double."""

    g: _CarefulVector
    c_hi: float
    c_lo: float


@compiled_borrowing
def careful_side(pieces, start, end):
    """The vector between two vertices."""
    x_hi, x_lo = dd.two_sum(pieces.x[end], -pieces.x[start])
    y_hi, y_lo = dd.two_sum(pieces.y[end], -pieces.y[start])
    return _CarefulVector(x_hi, x_lo, y_hi, y_lo)


@compiled_borrowing
def careful_bound(pieces, z, finger, start, side, other, piece, s):
    """What the slot ``s`` of the piece of another finger says; ``side`` is not of length 1."""
    vx, vy, ptr, slot_vertex = pieces.x, pieces.y, pieces.ptr, pieces.slot_vertex
    a = slot_vertex[s]
    b = slot_vertex[s + 1 if s + 1 < ptr[piece + 1] else ptr[piece]]
    # inward normal of a counterclockwise piece: the edge turned left by a right angle
    nxh, nxl = dd.two_sum(vy[a], -vy[b])
    nyh, nyl = dd.two_sum(vx[b], -vx[a])
    inv = 1.0 / math.sqrt(nxh * nxh + nyh * nyh)
    nxh, nxl = dd.scale(nxh, nxl, inv)
    nyh, nyl = dd.scale(nyh, nyl, inv)
    n = _CarefulVector(nxh, nxl, nyh, nyl)
    return _bound_through(pieces, z, finger, start, side, other, a, n)


@compiled_borrowing
def _bound_through(pieces, z, finger, start, side, other, a, n):
    """The half plane through vertex ``a``, of normal n, for another finger."""
    uxh, uxl = dd.two_sum(z[other, 0], -z[finger, 0])
    uyh, uyl = dd.two_sum(z[other, 1], -z[finger, 1])
    gxh, gxl = dd.dot(uxh, uxl, uyh, uyl, n.x_hi, n.x_lo, n.y_hi, n.y_lo)
    gyh, gyl = dd.dot(uxh, uxl, -uyh, -uyl, n.y_hi, n.y_lo, n.x_hi, n.x_lo)
    hh, hl = dd.dot(n.x_hi, n.x_lo, n.y_hi, n.y_lo, side.x_hi, side.x_lo, side.y_hi, side.y_lo)
    dxh, dxl = dd.two_sum(pieces.x[a], -pieces.x[start])
    dyh, dyl = dd.two_sum(pieces.y[a], -pieces.y[start])
    ch, cl = dd.dot(n.x_hi, n.x_lo, n.y_hi, n.y_lo, dxh, dxl, dyh, dyl)
    return CarefulBound(_CarefulVector(gxh, gxl, gyh, gyl), hh, hl, ch, cl)


@compiled_borrowing
def careful_end(pieces, far):
    """What an end of the segment says, the far one or the near one."""
    h, c = (-pieces.scale, -pieces.scale) if far else (pieces.scale, 0.0)
    return CarefulBound(_CarefulVector(0.0, 0.0, 0.0, 0.0), h, 0.0, c, 0.0)


@compiled_borrowing
def careful_row(a, b):
    """The half plane of a lower and an upper bound on tau."""
    # over the larger weight, so that no row is scaled up from nothing
    inv = 1.0 / max(a.along_hi, -b.along_hi)
    mah, mal = dd.scale(a.along_hi, a.along_lo, inv)
    mbh, mbl = dd.scale(-b.along_hi, -b.along_lo, inv)
    th, tl = dd.mul(mah, mal, b.g.x_hi, b.g.x_lo)
    sh, sl = dd.mul(mbh, mbl, a.g.x_hi, a.g.x_lo)
    gxh, gxl = dd.add(th, tl, sh, sl)
    th, tl = dd.mul(mah, mal, b.g.y_hi, b.g.y_lo)
    sh, sl = dd.mul(mbh, mbl, a.g.y_hi, a.g.y_lo)
    gyh, gyl = dd.add(th, tl, sh, sl)
    th, tl = dd.mul(mah, mal, b.c_hi, b.c_lo)
    sh, sl = dd.mul(mbh, mbl, a.c_hi, a.c_lo)
    ch, cl = dd.add(th, tl, sh, sl)
    return CarefulRow(_CarefulVector(gxh, gxl, gyh, gyl), ch, cl)


@compiled_borrowing
def _careful_rows(pieces, z, facet, side, finger, piece, across_tips, base, count):
    """Append the half planes of one finger's piece, those across its sharp tips if asked for.

    ``side`` is the segment, not of length 1.
    """
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        row = careful_bound(pieces, z, facet.finger, facet.start, side, finger, piece, s)
        _store_bound(row, base, count)
        count += 1
    if across_tips:
        before = pieces.ptr[piece + 1] - 1
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            tip = tip_at(pieces, before, s, SHARP)
            if tip.sharp:  # the direction of such a half plane need not be exact
                n = _CarefulVector(tip.n_x, 0.0, tip.n_y, 0.0)
                a = pieces.slot_vertex[s]
                row = _bound_through(pieces, z, facet.finger, facet.start, side, finger, a, n)
                _store_bound(row, base, count)
                count += 1
            before = s
    return count


@compiled_borrowing
def _store_bound(row, base, a):
    base[a, _C_GX], base[a, _C_GX + 1] = row.g.x_hi, row.g.x_lo
    base[a, _C_GY], base[a, _C_GY + 1] = row.g.y_hi, row.g.y_lo
    base[a, _C_ALONG], base[a, _C_ALONG + 1] = row.along_hi, row.along_lo
    base[a, _C_BOUND], base[a, _C_BOUND + 1] = row.c_hi, row.c_lo


@compiled_borrowing
def _stored_bound(base, a):
    g = _CarefulVector(base[a, _C_GX], base[a, _C_GX + 1], base[a, _C_GY], base[a, _C_GY + 1])
    return CarefulBound(
        g, base[a, _C_ALONG], base[a, _C_ALONG + 1], base[a, _C_BOUND], base[a, _C_BOUND + 1]
    )


@compiled
def pass_careful(pieces, z, facet, cap, give):
    """The least norm in double-double; here tau runs over [0, 1].

    ``give`` moves every edge of the pieces outward; where edges meet in a sharp tip that would move
    the tip much further than them, but for one more half plane across it.
    """
    base = np.empty((MAX_BASE, 8))
    rows = np.empty((MAX_ROWS, 6))
    slack = CAREFUL_SLACK * pieces.scale
    side = careful_side(pieces, facet.start, facet.end)
    tips = give > 0.0
    n = _careful_rows(pieces, z, facet, side, facet.second, facet.second_piece, tips, base, 0)
    n = _careful_rows(pieces, z, facet, side, facet.third, facet.third_piece, tips, base, n)
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
            alone = _stored_bound(base, a)
            count, feasible = _careful_put(alone.g, alone.c_hi, alone.c_lo, cap, slack, rows, count)
            if not feasible:
                return LeastNorm(INFEASIBLE, 0.0, 0.0)
        elif ha > 0.0:
            for b in range(n):
                hb = base[b, _C_ALONG]
                if hb < 0.0:
                    both = careful_row(_stored_bound(base, a), _stored_bound(base, b))
                    count, feasible = _careful_put(
                        both.g, both.c_hi, both.c_lo, cap, slack, rows, count
                    )
                    if not feasible:
                        return LeastNorm(INFEASIBLE, 0.0, 0.0)
    return min_norm_careful(rows, count, slack)


@compiled_borrowing
def _careful_put(g, ch, cl, cap, slack, rows, count):
    norm = math.sqrt(g.x_hi * g.x_hi + g.y_hi * g.y_hi)
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
