"""The pass value: least sigma with one finger on a segment and the others in convex pieces.

Every constraint of a facet is linear in (tau, w); pairing the lower and the upper bounds on tau
(Fourier-Motzkin) leaves half planes for w alone, and the pass value is the least |w| in them.
Our own. [docs/theory.md, Sec. 3.3]

The doubles go first; wherever rounding could move the value by more than ``worst`` the answer is
computed again in double-double arithmetic from the same vertices.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.boxes import out_of_reach
from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.facet import (
    ALONG,
    BASE_COLUMNS,
    BOUND,
    CLEARANCE,
    EPS,
    ERROR,
    G_X,
    G_Y,
    MAX_BASE,
    MAX_ROWS,
    ROUNDING,
    rows_of_others,
    segment_of,
)
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE, LeastNorm, NormStatus, min_norm
from icage.kernels.compiled import compiled, compiled_borrowing

_FIRST_GIVE = 1e-3
"""[CLEARANCE] What a facet that looks empty is given first; ten times more each try, up to all."""

_NO_ROW = 1e-11
"""[1] A row whose g is this small against its weights says nothing about w: only rounding is left
of it, and dividing by it would make an error of 1e-5 of that."""

_ROW_C, _ROW_ERROR, _ROW_ROUNDING = 2, 3, 4
"""Columns after g of the half planes g . w >= c +- error of ``min_norm``."""


class Pass(NamedTuple):
    """Least sigma on a facet and w there; inf where there is none."""

    sigma: float
    w_x: float
    w_y: float


class Room(NamedTuple):
    """Memory that the passes of one search share; ``tally`` counts [all calls, careful calls]."""

    base: np.ndarray
    rows: np.ndarray
    tally: np.ndarray


class _Stored(NamedTuple):
    """How many rows there are now, and whether the last one leaves anything."""

    count: int
    status: NormStatus


@compiled
def new_room():
    """Memory for ``pass_value``."""
    return Room(np.empty((MAX_BASE, BASE_COLUMNS)), np.empty((MAX_ROWS, 5)), np.zeros(2, np.int64))


@compiled_borrowing
def pass_fast(pieces, z, facet, cap, worst, room):
    """The least norm in doubles; ``cap`` is the largest sigma of interest."""
    base, rows = room.base, room.rows
    segment = segment_of(pieces, facet)
    n = rows_of_others(pieces, z, facet, segment, base)
    # tau from 0 ...
    base[n, G_X], base[n, G_Y], base[n, ALONG], base[n, BOUND] = 0.0, 0.0, 1.0, 0.0
    base[n, ERROR], base[n, ROUNDING] = 0.0, 0.0
    n += 1
    # ... to the length of the segment
    base[n, G_X], base[n, G_Y], base[n, ALONG], base[n, BOUND] = 0.0, 0.0, -1.0, -segment.length
    base[n, ERROR] = 2.0 * EPS * segment.length
    base[n, ROUNDING] = base[n, ERROR]
    n += 1
    count = 0
    for a in range(n):
        ha = base[a, ALONG]
        if ha == 0.0:
            count, status = _put(
                base[a, G_X], base[a, G_Y], base[a, BOUND], base[a, ERROR], base[a, ROUNDING], 1.0,
                cap, rows, count,
            )  # fmt: skip
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
                    rounding = ha * base[b, ROUNDING] - hb * base[a, ROUNDING]
                    count, status = _put(gx, gy, c, err, rounding, ha - hb, cap, rows, count)
                    if status != FOUND:
                        return LeastNorm(status, 0.0, 0.0)
    return min_norm(rows, count, worst)


@compiled_borrowing
def _put(gx, gy, c, err, rounding, weight, cap, rows, count):
    """Store one row scaled to |g| = 1, unless it holds for every |w| <= cap or for none."""
    norm = math.sqrt(gx * gx + gy * gy)  # lengths near the diameter's: no overflow; hypot is slow
    reach = norm * cap
    if c + err + reach < 0.0:
        return _Stored(count, FOUND)
    if c - err - reach > 0.0:
        return _Stored(count, INFEASIBLE)
    if norm < _NO_ROW * weight:
        if c <= err + reach and c >= -err - reach:
            return _Stored(count, UNSURE)
        return _Stored(count, FOUND)
    inv = 1.0 / norm
    rows[count, G_X] = gx * inv
    rows[count, G_Y] = gy * inv
    rows[count, _ROW_C] = c * inv
    rows[count, _ROW_ERROR] = err * inv
    rows[count, _ROW_ROUNDING] = rounding * inv
    return _Stored(count + 1, FOUND)


@compiled_borrowing
def pass_value(pieces, z, facet, cap, worst, room):
    """Least sigma on a facet; inf where there is none below ``cap``."""
    if out_of_reach(pieces, z, facet, cap):
        return Pass(np.inf, 0.0, 0.0)
    room.tally[0] += 1
    found = pass_fast(pieces, z, facet, cap, worst, room)
    if found.status == UNSURE:
        room.tally[1] += 1
        return value_carefully(pieces, z, facet, cap)
    return _up_to(found, cap)


@compiled_borrowing
def value_carefully(pieces, z, facet, cap):
    """The same in double-double from the start."""
    found = pass_careful(pieces, z, facet, cap, 0.0)
    # as little as will do: in a sliver what is given comes back a thousandfold in sigma
    give = _FIRST_GIVE * CLEARANCE * pieces.scale
    while found.status == INFEASIBLE and give <= 1.01 * CLEARANCE * pieces.scale:
        found = pass_careful(pieces, z, facet, cap, give)
        give *= 10.0
    return _up_to(found, cap)


@compiled_borrowing
def _up_to(found, cap):
    if found.status == INFEASIBLE:
        return Pass(np.inf, 0.0, 0.0)
    sigma = math.sqrt(found.w_x * found.w_x + found.w_y * found.w_y)
    if sigma > cap:
        return Pass(np.inf, 0.0, 0.0)
    return Pass(sigma, found.w_x, found.w_y)
