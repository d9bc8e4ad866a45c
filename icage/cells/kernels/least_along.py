"""Least sigma with one finger on a segment and the others in two of all pieces: many facets.

The same as ``pass_value`` to rounding, for those who ask for all facets of one segment. Between the
largest of the lower bounds on the finger and the least of the upper ones there has to be room; the
two that leave the least at the present w make the half plane that w violates, and no other half
plane is ever formed. [SharirWelzl1992] The certificate, and what is left to double-double, are
those of ``min_norm``. Our own. [docs/decisions/0014-whole-sublevels.md]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.along import (
    BOUND,
    CHECK_C,
    CHECK_X,
    CHECK_Y,
    ERROR,
    HERE_PUSH,
    ROUNDING,
    THERE_PUSH,
    WEIGHT,
)
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, NARROW, UNSURE, NormStatus
from icage.kernels.compiled import compiled_borrowing

_PARALLEL, _THIN, _CONFLICT, _MOST_STEPS = 1e-13, 1e-3, 1e-12, 60
"""As in ``min_norm``."""

_NO_ROW = 1e-11
"""[1] As in ``passes``: a row whose g is this small against its weights says nothing about w."""

_BEYOND = 1e-9
"""[1] The cap is passed if it is by this share of it, and rounding is below a hundredth of that."""

_STEEP = 1e-6
"""[1] A push on the segment counts from this share of the forces that make it up: far above what
rounding does to multipliers. One that does not count only costs the cell a look at its walls."""

HERE, THERE = 1, 2
"""Bits for the cells on both sides of a facet: that of the segment's piece, and that behind it."""


class LeastAlong(NamedTuple):
    """The least point on a facet, and what it tells of the cells next to it.

    Attributes
    ----------
    status:
        ``NARROW``: it is where it is said to be only if all rows near it hold, which doubles cannot
        tell.
    told:
        Bits ``HERE`` and ``THERE``: in all of the cell no sigma is less; if there is no point, the
        cell holds no hand up to the cap.
    rows:
        How many rows decide: of the bounds ``a`` and ``b``, and ``a_2`` and ``b_2``.
    near:
        How many rows may be tight there.
    """

    status: NormStatus
    w_x: float
    w_y: float
    told: int
    rows: int
    a: int
    b: int
    a_2: int
    b_2: int
    near: int


class _Row(NamedTuple):
    """A half plane g . w >= c of two bounds, |g| = 1."""

    g_x: float
    g_y: float
    c: float
    error: float
    rounding: float
    here: float
    there: float
    weight: float
    a: int
    b: int


@compiled_borrowing
def _row(check, rest, a, b):
    """The half plane of two bounds; and |g| before it was made 1, unless it is too small."""
    gx = check[a, CHECK_X] + check[b, CHECK_X]
    gy = check[a, CHECK_Y] + check[b, CHECK_Y]
    norm = math.sqrt(gx * gx + gy * gy)
    weight = rest[a, WEIGHT] + rest[b, WEIGHT]
    inv = 1.0 / norm if norm >= _NO_ROW * weight else 1.0
    return norm, _Row(
        gx * inv,
        gy * inv,
        (rest[a, BOUND] + rest[b, BOUND]) * inv,
        (rest[a, ERROR] + rest[b, ERROR]) * inv,
        (rest[a, ROUNDING] + rest[b, ROUNDING]) * inv,
        (rest[a, HERE_PUSH] + rest[b, HERE_PUSH]) * inv,
        (rest[a, THERE_PUSH] + rest[b, THERE_PUSH]) * inv,
        weight * inv,
        a,
        b,
    )


@compiled_borrowing
def _nothing(status, told):
    return LeastAlong(status, 0.0, 0.0, told, 0, 0, 0, 0, 0, 0)


@compiled_borrowing
def least_along(check, rest, near, j0, j1, j2, k0, k1, k2, cap, worst):
    """Least sigma with the bounds of two pieces: lower j0:j1 and k0:k1, upper j1:j2 and k1:k2.

    ``check``, ``rest`` and ``near`` are those of ``Bounds``.
    """
    start, end = len(check) - 2, len(check) - 1
    length = -check[end, CHECK_C]
    wx = 0.0
    wy = 0.0
    first = _Row(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2, -2)
    other = first
    rows = 0
    most2 = (cap * (1.0 + _BEYOND)) ** 2
    for _ in range(_MOST_STEPS):
        low, high = 0.0, -length
        a, b = start, end
        for turn in range(2):
            for t in range(k0 if turn else j0, k1 if turn else j1):
                v = check[t, CHECK_C] - (check[t, CHECK_X] * wx + check[t, CHECK_Y] * wy)
                if v > low:
                    low, a = v, t
            for t in range(k1 if turn else j1, k2 if turn else j2):
                v = check[t, CHECK_C] - (check[t, CHECK_X] * wx + check[t, CHECK_Y] * wy)
                if v > high:
                    high, b = v, t
        if low + high <= 0.0:
            if rows == 0:
                return _nothing(FOUND, 0)
            return _certified(
                check, rest, near, j0, j1, j2, k0, k1, k2, worst, wx, wy, rows, first, other
            )
        if rows > 0 and ((a == first.a and b == first.b) or (a == other.a and b == other.b)):
            return _nothing(UNSURE, 0)
        norm, r = _row(check, rest, a, b)
        if norm < _NO_ROW * r.weight:
            if r.c - r.error - norm * cap > 0.0:
                return _nothing(INFEASIBLE, 0)
            return _nothing(UNSURE, 0)
        if r.c - r.error > cap:
            return _nothing(INFEASIBLE, _told(r.here, r.there, r.weight))
        bx = r.c * r.g_x
        by = r.c * r.g_y
        lo = -np.inf
        hi = np.inf
        at_lo, at_hi = 0, 0
        if rows > 0:
            x = first.g_y * r.g_x - first.g_x * r.g_y
            y = first.c - (first.g_x * bx + first.g_y * by)
            if x > _PARALLEL:
                lo, at_lo = y / x, 1
            elif x < -_PARALLEL:
                hi, at_hi = y / x, 1
            elif y > 0.0:
                if y > 4.0 * (first.error + r.error) + _CONFLICT * abs(r.c):
                    return _nothing(INFEASIBLE, 0)
                return _nothing(UNSURE, 0)
        if rows > 1:
            x = other.g_y * r.g_x - other.g_x * r.g_y
            y = other.c - (other.g_x * bx + other.g_y * by)
            if x > _PARALLEL:
                if y / x > lo:
                    lo, at_lo = y / x, 2
            elif x < -_PARALLEL:
                if y / x < hi:
                    hi, at_hi = y / x, 2
            elif y > 0.0:
                if y > 4.0 * (other.error + r.error) + _CONFLICT * abs(r.c):
                    return _nothing(INFEASIBLE, 0)
                return _nothing(UNSURE, 0)
        if lo > hi:
            p = first if at_lo == 1 else other
            q = first if at_hi == 1 else other
            x_lo = abs(p.g_y * r.g_x - p.g_x * r.g_y)
            x_hi = abs(q.g_y * r.g_x - q.g_x * r.g_y)
            doubt = (p.error + r.error) / x_lo + (q.error + r.error) / x_hi
            if lo - hi > 4.0 * doubt:
                # the multipliers under which nothing is left of w: they contradict each other
                m_r = x_hi * -(p.g_x * r.g_x + p.g_y * r.g_y) - x_lo * (
                    q.g_x * r.g_x + q.g_y * r.g_y
                )
                m_r = max(m_r, 0.0)
                return _nothing(
                    INFEASIBLE,
                    _told(
                        x_hi * p.here + x_lo * q.here + m_r * r.here,
                        x_hi * p.there + x_lo * q.there + m_r * r.there,
                        x_hi * p.weight + x_lo * q.weight + m_r * r.weight,
                    ),
                )  # fmt: skip
            return _nothing(UNSURE, 0)
        s = 0.0
        rows = 1
        if lo > 0.0:
            s = lo
            if at_lo == 1:
                other = first
            rows = 2
        elif hi < 0.0:
            s = hi
            if at_hi == 1:
                other = first
            rows = 2
        first = r
        wx = bx - s * r.g_y
        wy = by + s * r.g_x
        if wx * wx + wy * wy > most2:
            doubt = r.error
            here, there, weight = r.here, r.there, r.weight
            if rows == 2:
                det = r.g_x * other.g_y - r.g_y * other.g_x
                doubt = (r.error + other.error) / abs(det)
                m_r = (wx * other.g_y - wy * other.g_x) / det
                m_o = (r.g_x * wy - r.g_y * wx) / det
                here = m_r * r.here + m_o * other.here
                there = m_r * r.there + m_o * other.there
                weight = m_r * r.weight + m_o * other.weight
            if doubt < 0.01 * _BEYOND * cap:
                return _nothing(INFEASIBLE, _told(here, there, weight))
    return _nothing(UNSURE, 0)


@compiled_borrowing
def _certified(check, rest, near, j0, j1, j2, k0, k1, k2, worst, wx, wy, rows, first, other):
    """Is |w| within ``worst`` of the truth? As in ``min_norm``."""
    norm = math.sqrt(wx * wx + wy * wy)
    if norm == 0.0:
        return _nothing(FOUND, 0)
    ux = wx / norm
    uy = wy / norm
    shift = first.rounding
    below = first.rounding
    here, there = first.here, first.there
    weight = first.weight
    if rows == 2:
        det = first.g_x * other.g_y - first.g_y * other.g_x
        if abs(det) < _PARALLEL:
            return _nothing(UNSURE, 0)
        mult_1 = (ux * other.g_y - uy * other.g_x) / det
        mult_2 = (first.g_x * uy - first.g_y * ux) / det
        below = abs(mult_1) * first.rounding + abs(mult_2) * other.rounding
        shift = (first.rounding + other.rounding) / abs(det)
        here = mult_1 * first.here + mult_2 * other.here
        there = mult_1 * first.there + mult_2 * other.there
        weight = abs(mult_1) * first.weight + abs(mult_2) * other.weight
    if below > worst or shift > 10.0 * worst:
        return _nothing(UNSURE, 0)
    # the bounds that may be tight there, and of these the pairs
    end = len(check) - 1
    most = _nearly(check, rest, end, wx, wy, shift)
    for t in range(j1, j2):
        most = max(most, _nearly(check, rest, t, wx, wy, shift))
    for t in range(k1, k2):
        most = max(most, _nearly(check, rest, t, wx, wy, shift))
    widest = 0.0
    narrowest = 0.0
    largest = 0.0
    count = 0
    for row in range(j1 - j0 + k1 - k0 + 1):
        a = j0 + row
        if a >= j1:
            a += k0 - j1
            if a >= k1:
                a = end - 1
        lower = _nearly(check, rest, a, wx, wy, shift)
        if lower + most <= 0.0:
            continue
        for column in range(j2 - j1 + k2 - k1 + 1):
            b = j1 + column
            if b >= j2:
                b += k1 - j2
                if b >= k2:
                    b = end
            if lower + _nearly(check, rest, b, wx, wy, shift) <= 0.0:
                continue
            size, r = _row(check, rest, a, b)
            if size < _NO_ROW * r.weight:
                return _nothing(UNSURE, 0)
            gap = r.g_x * wx + r.g_y * wy - r.c
            if gap < 4.0 * (r.rounding + shift):
                if gap < -4.0 * (r.rounding + shift) or count == len(near):
                    return _nothing(UNSURE, 0)
                turn = math.atan2(ux * r.g_y - uy * r.g_x, ux * r.g_x + uy * r.g_y)
                widest = max(widest, turn)
                narrowest = min(narrowest, turn)
                largest = max(largest, r.rounding)
                near[count, 0], near[count, 1] = a, b
                count += 1
    room = math.pi - (widest - narrowest)
    status, told = FOUND, _told(here, there, weight)
    if room < _THIN or largest / math.sin(min(0.5 * room, 1.5)) > worst:
        status, told = NARROW, 0
    return LeastAlong(status, wx, wy, told, rows, first.a, first.b, other.a, other.b, count)


@compiled_borrowing
def _told(here, there, weight):
    """For which of both cells multipliers are a proof: where they push the finger back.

    For all hands of the piece's cell |w| is then at least what it is with the finger on the edge.
    """
    told = 0
    if here < -_STEEP * weight:
        told = HERE
    if there > _STEEP * weight:
        told += THERE
    return told


@compiled_borrowing
def _nearly(check, rest, t, wx, wy, shift):
    """How far a bound is violated at w, and five times its error and what w may be off by."""
    gx, gy = check[t, CHECK_X], check[t, CHECK_Y]
    v = check[t, CHECK_C] - (gx * wx + gy * wy)
    return v + 6.0 * rest[t, ERROR] + 5.0 * shift * (abs(gx) + abs(gy))
