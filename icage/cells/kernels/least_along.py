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
    PUSH,
    ROUNDING,
    WEIGHT,
)
from icage.cells.kernels.facet import EPS
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE, NormStatus
from icage.kernels.compiled import compiled_borrowing

_PARALLEL, _THIN, _CONFLICT, _MOST_STEPS, _NO_ROW = 1e-13, 1e-3, 1e-12, 60, 1e-11

_BEYOND = 1e-9
_STEEP = 1e-6


class Least(NamedTuple):
    status: NormStatus
    w_x: float
    w_y: float
    told: int


class _Row(NamedTuple):
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
def _pair(second, third, a, b, side):
    """The half plane of a lower and an upper bound; norm 0 where there is no row."""
    slots = len(second.check)
    gx, gy, c, error, rounding, here, there, weight = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if a < 0:
        here += side.here_start
        there += side.there_start
        weight += 1.0 + abs(here) + abs(there)
    elif a < slots:
        gx += second.check[a, CHECK_X]
        gy += second.check[a, CHECK_Y]
        c += second.rest[a, BOUND]
        error += second.rest[a, ERROR]
        rounding += second.rest[a, ROUNDING]
        here += second.rest[a, PUSH]
        there += second.rest[a, PUSH]
        weight += second.rest[a, WEIGHT]
    else:
        gx += third.check[a - slots, CHECK_X]
        gy += third.check[a - slots, CHECK_Y]
        c += third.rest[a - slots, BOUND]
        error += third.rest[a - slots, ERROR]
        rounding += third.rest[a - slots, ROUNDING]
        here += third.rest[a - slots, PUSH]
        there += third.rest[a - slots, PUSH]
        weight += third.rest[a - slots, WEIGHT]
    if b < 0:
        c -= side.length
        error += 2.0 * EPS * side.length
        rounding += 2.0 * EPS * side.length
        here += side.here_end
        there += side.there_end
        weight += 1.0 + abs(side.here_end) + abs(side.there_end)
    elif b < slots:
        gx += second.check[b, CHECK_X]
        gy += second.check[b, CHECK_Y]
        c += second.rest[b, BOUND]
        error += second.rest[b, ERROR]
        rounding += second.rest[b, ROUNDING]
        here += second.rest[b, PUSH]
        there += second.rest[b, PUSH]
        weight += second.rest[b, WEIGHT]
    else:
        gx += third.check[b - slots, CHECK_X]
        gy += third.check[b - slots, CHECK_Y]
        c += third.rest[b - slots, BOUND]
        error += third.rest[b - slots, ERROR]
        rounding += third.rest[b - slots, ROUNDING]
        here += third.rest[b - slots, PUSH]
        there += third.rest[b - slots, PUSH]
        weight += third.rest[b - slots, WEIGHT]
    norm = math.sqrt(gx * gx + gy * gy)
    if norm < _NO_ROW * weight:
        return norm, _Row(gx, gy, c, error, rounding, here, there, weight, a, b)
    inv = 1.0 / norm
    return norm, _Row(
        gx * inv, gy * inv, c * inv, error * inv, rounding * inv, here * inv,
        there * inv, weight * inv, a, b
    )


@compiled_borrowing
def least_along(second, third, j0, j1, j2, k0, k1, k2, side, cap, worst):
    slots = len(second.check)
    jc, kc = second.check, third.check
    wx = 0.0
    wy = 0.0
    first = _Row(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2, -2)
    other = first
    rows = 0
    most2 = (cap * (1.0 + _BEYOND)) ** 2
    for _ in range(_MOST_STEPS):
        low, high = 0.0, -side.length
        a, b = -1, -1
        for t in range(j0, j1):
            v = jc[t, CHECK_C] - (jc[t, CHECK_X] * wx + jc[t, CHECK_Y] * wy)
            if v > low:
                low = v
                a = t
        for t in range(j1, j2):
            v = jc[t, CHECK_C] - (jc[t, CHECK_X] * wx + jc[t, CHECK_Y] * wy)
            if v > high:
                high = v
                b = t
        for t in range(k0, k1):
            v = kc[t, CHECK_C] - (kc[t, CHECK_X] * wx + kc[t, CHECK_Y] * wy)
            if v > low:
                low = v
                a = t + slots
        for t in range(k1, k2):
            v = kc[t, CHECK_C] - (kc[t, CHECK_X] * wx + kc[t, CHECK_Y] * wy)
            if v > high:
                high = v
                b = t + slots
        if low + high <= 0.0:
            return _certified(
                second, third, j0, j1, j2, k0, k1, k2, side, worst, wx, wy, rows, first, other,
                low, high,
            )  # fmt: skip
        if rows > 0 and ((a == first.a and b == first.b) or (a == other.a and b == other.b)):
            return Least(UNSURE, 0.0, 0.0, 0)
        norm, r = _pair(second, third, a, b, side)
        if norm < _NO_ROW * r.weight:
            if r.c - r.error - norm * cap > 0.0:
                return Least(INFEASIBLE, 0.0, 0.0, 0)
            return Least(UNSURE, 0.0, 0.0, 0)
        if r.c - r.error > cap:
            return Least(INFEASIBLE, 0.0, 0.0, _told(r.here, r.there, r.weight))
        bx = r.c * r.g_x
        by = r.c * r.g_y
        lo = -np.inf
        hi = np.inf
        at_lo, at_hi = 0, 0
        sine = 1.0
        if rows > 0:
            x = first.g_y * r.g_x - first.g_x * r.g_y
            y = first.c - (first.g_x * bx + first.g_y * by)
            if x > _PARALLEL:
                lo, at_lo = y / x, 1
            elif x < -_PARALLEL:
                hi, at_hi = y / x, 1
            elif y > 0.0:
                if y > 4.0 * (first.error + r.error) + _CONFLICT * abs(r.c):
                    return Least(INFEASIBLE, 0.0, 0.0, 0)
                return Least(UNSURE, 0.0, 0.0, 0)
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
                    return Least(INFEASIBLE, 0.0, 0.0, 0)
                return Least(UNSURE, 0.0, 0.0, 0)
        if lo > hi:
            p = first if at_lo == 1 else other
            q = first if at_hi == 1 else other
            x_lo = abs(p.g_y * r.g_x - p.g_x * r.g_y)
            x_hi = abs(q.g_y * r.g_x - q.g_x * r.g_y)
            doubt = (p.error + r.error) / x_lo + (q.error + r.error) / x_hi
            if lo - hi > 4.0 * doubt:
                m_r = x_hi * -(p.g_x * r.g_x + p.g_y * r.g_y) - x_lo * (
                    q.g_x * r.g_x + q.g_y * r.g_y
                )
                m_r = max(m_r, 0.0)
                return Least(
                    INFEASIBLE, 0.0, 0.0,
                    _told(
                        x_hi * p.here + x_lo * q.here + m_r * r.here,
                        x_hi * p.there + x_lo * q.there + m_r * r.there,
                        x_hi * p.weight + x_lo * q.weight + m_r * r.weight,
                    ),
                )
            return Least(UNSURE, 0.0, 0.0, 0)
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
                return Least(INFEASIBLE, 0.0, 0.0, _told(here, there, weight))
    return Least(UNSURE, 0.0, 0.0, 0)


@compiled_borrowing
def _certified(second, third, j0, j1, j2, k0, k1, k2, side, worst, wx, wy, rows, first, other, low, high):
    norm = math.sqrt(wx * wx + wy * wy)
    if norm == 0.0:
        return Least(FOUND, 0.0, 0.0, 0)
    ux = wx / norm
    uy = wy / norm
    shift = first.rounding
    below = first.rounding
    here, there = first.here, first.there
    weight = first.weight
    if rows == 2:
        det = first.g_x * other.g_y - first.g_y * other.g_x
        if abs(det) < _PARALLEL:
            return Least(UNSURE, 0.0, 0.0, 0)
        mult_1 = (ux * other.g_y - uy * other.g_x) / det
        mult_2 = (first.g_x * uy - first.g_y * ux) / det
        below = abs(mult_1) * first.rounding + abs(mult_2) * other.rounding
        shift = (first.rounding + other.rounding) / abs(det)
        here = mult_1 * first.here + mult_2 * other.here
        there = mult_1 * first.there + mult_2 * other.there
        weight = abs(mult_1) * first.weight + abs(mult_2) * other.weight
    if below > worst or shift > 10.0 * worst:
        return Least(UNSURE, 0.0, 0.0, 0)
    # bounds that may be tight
    slots = len(second.check)
    y_high = 4.0 * EPS * side.length - side.length
    for t in range(j1, j2):
        y_high = max(y_high, _nearly(second, t, wx, wy, shift))
    for t in range(k1, k2):
        y_high = max(y_high, _nearly(third, t, wx, wy, shift))
    widest = 0.0
    narrowest = 0.0
    largest = 0.0
    for a in range(-1, j1 - j0 + k1 - k0):
        if a < 0:
            at_a = -1
            y_a = 0.0
        elif a < j1 - j0:
            at_a = j0 + a
            y_a = _nearly(second, at_a, wx, wy, shift)
        else:
            at_a = k0 + a - (j1 - j0)
            y_a = _nearly(third, at_a, wx, wy, shift)
            at_a += slots
        if y_a + y_high <= 0.0:
            continue
        for b in range(-1, j2 - j1 + k2 - k1):
            if b < 0:
                at_b = -1
                y_b = 4.0 * EPS * side.length - side.length
            elif b < j2 - j1:
                at_b = j1 + b
                y_b = _nearly(second, at_b, wx, wy, shift)
            else:
                at_b = k1 + b - (j2 - j1)
                y_b = _nearly(third, at_b, wx, wy, shift)
                at_b += slots
            if y_a + y_b <= 0.0:
                continue
            size, r = _pair(second, third, at_a, at_b, side)
            if size < _NO_ROW * r.weight:
                return Least(UNSURE, 0.0, 0.0, 0)
            gap = r.g_x * wx + r.g_y * wy - r.c
            if gap < 4.0 * (r.rounding + shift):
                if gap < -4.0 * (r.rounding + shift):
                    return Least(UNSURE, 0.0, 0.0, 0)
                turn = math.atan2(ux * r.g_y - uy * r.g_x, ux * r.g_x + uy * r.g_y)
                widest = max(widest, turn)
                narrowest = min(narrowest, turn)
                largest = max(largest, r.rounding)
    room = math.pi - (widest - narrowest)
    if room < _THIN or largest / math.sin(min(0.5 * room, 1.5)) > worst:
        return Least(UNSURE, 0.0, 0.0, 0)
    return Least(FOUND, wx, wy, _told(here, there, weight))


@compiled_borrowing
def _told(here, there, weight):
    told = 0
    if here < -_STEEP * weight:
        told = 1
    if there > _STEEP * weight:
        told += 2
    return told


@compiled_borrowing
def _nearly(bounds, t, wx, wy, shift):
    """How far a bound is violated at w, and five times its rounding and what w may be off by."""
    gx, gy = bounds.check[t, CHECK_X], bounds.check[t, CHECK_Y]
    v = bounds.check[t, CHECK_C] - (gx * wx + gy * wy)
    return v + 6.0 * bounds.rest[t, ERROR] + 5.0 * shift * (abs(gx) + abs(gy))
