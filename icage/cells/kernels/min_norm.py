"""The point of least norm in an intersection of half planes g . w >= c in the plane.

A row that the present point violates must be tight at the new one. The fast version takes the row
that is violated most, and of it and the tight ones (two at most) those that hold their least point:
the norm grows with every step, and of these there are three on average over forty rows.
[SharirWelzl1992] It works in doubles with an error bound on every row and says so when rounding
could matter. The careful version is incremental, row after row [Seidel1991], in double-double
arithmetic, and always answers.
"""

# pyright: basic
from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.kernels import double_double as dd
from icage.kernels.compiled import compiled_borrowing


class NormStatus(IntEnum):
    """Whether there is a point.

    ``UNSURE``: doubles cannot tell, or not well enough where. ``NARROW``: it is there if rows hold
    of which doubles cannot tell whether they do.
    """

    UNSURE = -1
    INFEASIBLE = 0
    FOUND = 1
    NARROW = 2


UNSURE, INFEASIBLE, FOUND, NARROW = NormStatus

_PARALLEL = 1e-13
"""[1] Sine of the angle between two rows below which they count as parallel: rows are unit vectors
good to a few units in the last place, and no quotient is trusted below some hundred of these."""

_THIN = 1e-3
"""[rad] A wedge of near-active rows thinner than this is left to the careful version."""

_CONFLICT = 1e-12
"""[1] Parallel rows contradict each other if they do by this share of c beyond their errors:
rounding of c itself, which its error bound does not hold."""

_MOST_STEPS = 60
"""Far more than it takes (seven were seen): where rounding has it go round, doubles cannot tell."""

_CAREFUL_PARALLEL = 1e-26
"""[1] The same as ``_PARALLEL`` in double-double, whose last place is at 1e-32."""


class LeastNorm(NamedTuple):
    """The point of least norm; zero where there is none."""

    status: NormStatus
    w_x: float
    w_y: float


@compiled_borrowing
def min_norm(rows, n, worst):
    """Least norm over ``rows[:n]`` = (g_x, g_y, c, error, rounding), |g| = 1, in doubles.

    ``UNSURE`` when the value may be off by more than ``worst`` (same unit as c), for which the
    rounding of c counts, or when feasibility hangs on its error.
    """
    first = -1
    second = -1
    furthest = 0.0
    for q in range(n):
        if rows[q, 2] > furthest:
            furthest = rows[q, 2]
            first = q
    if first < 0:
        return LeastNorm(FOUND, 0.0, 0.0)
    wx = rows[first, 2] * rows[first, 0]
    wy = rows[first, 2] * rows[first, 1]
    for _ in range(_MOST_STEPS):
        r = _most_violated(rows, n, wx, wy)
        if r < 0:
            return LeastNorm(_certified(rows, n, worst, wx, wy, first, second), wx, wy)
        if r == first or r == second:
            return LeastNorm(UNSURE, 0.0, 0.0)
        # the least point that the tight rows and this one allow lies on this one
        gx = rows[r, 0]
        gy = rows[r, 1]
        c = rows[r, 2]
        bx = c * gx
        by = c * gy
        lo = -np.inf
        hi = np.inf
        at_lo = -1
        at_hi = -1
        for tight in range(2):
            q = first if tight == 0 else second
            if q < 0:
                continue
            a = rows[q, 1] * gx - rows[q, 0] * gy
            b = rows[q, 2] - (rows[q, 0] * bx + rows[q, 1] * by)
            if a > _PARALLEL:
                s = b / a
                if s > lo:
                    lo = s
                    at_lo = q
            elif a < -_PARALLEL:
                s = b / a
                if s < hi:
                    hi = s
                    at_hi = q
            elif b > 0.0:
                if b > 4.0 * (rows[q, 3] + rows[r, 3]) + _CONFLICT * abs(c):
                    return LeastNorm(INFEASIBLE, 0.0, 0.0)
                return LeastNorm(UNSURE, 0.0, 0.0)
        if lo > hi:
            a_lo = abs(rows[at_lo, 1] * gx - rows[at_lo, 0] * gy)
            a_hi = abs(rows[at_hi, 1] * gx - rows[at_hi, 0] * gy)
            doubt = (rows[at_lo, 3] + rows[r, 3]) / a_lo + (rows[at_hi, 3] + rows[r, 3]) / a_hi
            if lo - hi > 4.0 * doubt:
                return LeastNorm(INFEASIBLE, 0.0, 0.0)
            return LeastNorm(UNSURE, 0.0, 0.0)
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
    return LeastNorm(UNSURE, 0.0, 0.0)


@compiled_borrowing
def _most_violated(rows, n, wx, wy):
    """The row that w violates most, by more than its rounding; -1 if there is none."""
    most = 0.0
    row = -1
    for q in range(n):
        over = rows[q, 2] - (rows[q, 0] * wx + rows[q, 1] * wy) - rows[q, 4]
        if over > most:
            most = over
            row = q
    return row


@compiled_borrowing
def _certified(rows, n, worst, wx, wy, first, second):
    """Is |w| within ``worst`` of the truth? A fat wedge of room says so, above and below.

    Above: a point in it is clear of every row that rounding may move. Below: w / |w| is a sum of
    two of these rows times multipliers that are not negative, and what rounding can lower by weak
    duality is its part in each times the multiplier. With the rows at the angles a and b to both
    sides of w the multipliers add up to cos((a - b) / 2) / cos((a + b) / 2), and the wedge asks for
    1 / cos((a + b) / 2) or more.
    """
    norm = np.hypot(wx, wy)
    if norm == 0.0:
        return FOUND
    ux = wx / norm
    uy = wy / norm
    shift = rows[first, 4]
    if second >= 0:
        det = rows[first, 0] * rows[second, 1] - rows[first, 1] * rows[second, 0]
        if abs(det) < _PARALLEL:
            return UNSURE
        shift = (rows[first, 4] + rows[second, 4]) / abs(det)
    if shift > 10.0 * worst:
        return UNSURE
    widest = 0.0
    narrowest = 0.0
    largest = 0.0
    for r in range(n):
        gap = rows[r, 0] * wx + rows[r, 1] * wy - rows[r, 2]
        if gap < 4.0 * (rows[r, 4] + shift):
            if gap < -4.0 * (rows[r, 4] + shift):
                return UNSURE
            turn = math.atan2(ux * rows[r, 1] - uy * rows[r, 0], ux * rows[r, 0] + uy * rows[r, 1])
            widest = max(widest, turn)
            narrowest = min(narrowest, turn)
            largest = max(largest, rows[r, 4])
    room = math.pi - (widest - narrowest)
    if room < _THIN or largest / math.sin(min(0.5 * room, 1.5)) > worst:
        return UNSURE
    return FOUND


@compiled_borrowing
def min_norm_careful(rows, n, slack):
    """The same in double-double: ``rows[:n]`` = (g_x, g_y, c), each hi, lo; |g| about 1.

    Touching counts as free: a row is satisfied when it is violated by no more than ``slack``.
    The status is ``FOUND`` or ``INFEASIBLE``.
    """
    wxh = 0.0
    wxl = 0.0
    wyh = 0.0
    wyl = 0.0
    for r in range(n):
        gxh, gxl, gyh, gyl = rows[r, 0], rows[r, 1], rows[r, 2], rows[r, 3]
        ch, cl = rows[r, 4], rows[r, 5]
        vh, vl = dd.dot(gxh, gxl, gyh, gyl, wxh, wxl, wyh, wyl)
        vh, vl = dd.sub(vh, vl, ch, cl)
        if vh >= -slack:
            continue
        # foot of the origin on the line g . w = c
        nh, nl = dd.dot(gxh, gxl, gyh, gyl, gxh, gxl, gyh, gyl)
        kh, kl = dd.div(ch, cl, nh, nl)
        bxh, bxl = dd.mul(kh, kl, gxh, gxl)
        byh, byl = dd.mul(kh, kl, gyh, gyl)
        loh, lol = -np.inf, 0.0
        hih, hil = np.inf, 0.0
        for q in range(r):
            qxh, qxl, qyh, qyl = rows[q, 0], rows[q, 1], rows[q, 2], rows[q, 3]
            ah, al = dd.dot(qxh, qxl, qyh, qyl, -gyh, -gyl, gxh, gxl)
            th, tl = dd.dot(qxh, qxl, qyh, qyl, bxh, bxl, byh, byl)
            th, tl = dd.sub(rows[q, 4], rows[q, 5], th, tl)
            if abs(ah) < _CAREFUL_PARALLEL:
                if th > slack:
                    return LeastNorm(INFEASIBLE, 0.0, 0.0)
                continue
            sh, sl = dd.div(th, tl, ah, al)
            if ah > 0.0:
                if sh > loh or (sh == loh and sl > lol):
                    loh, lol = sh, sl
            elif sh < hih or (sh == hih and sl < hil):
                hih, hil = sh, sl
        if np.isfinite(loh) and np.isfinite(hih):
            vh, vl = dd.sub(loh, lol, hih, hil)
            if vh > slack:
                return LeastNorm(INFEASIBLE, 0.0, 0.0)
        sh, sl = 0.0, 0.0
        if loh > 0.0:
            sh, sl = loh, lol
        elif hih < 0.0:
            sh, sl = hih, hil
        th, tl = dd.mul(sh, sl, gyh, gyl)
        wxh, wxl = dd.sub(bxh, bxl, th, tl)
        th, tl = dd.mul(sh, sl, gxh, gxl)
        wyh, wyl = dd.add(byh, byl, th, tl)
    return LeastNorm(FOUND, wxh + wxl, wyh + wyl)
