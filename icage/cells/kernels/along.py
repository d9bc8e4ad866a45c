"""What all pieces say of a finger on one segment: bounds on how far along it may be.

With a finger at tau along a segment, another one in a piece obeys g . w + h tau >= c for each edge
of the piece. Over |h| that is a lower or an upper bound on tau, affine in w, and two of them
together are a half plane for w whose columns are the sums of theirs: what ``passes`` multiplies out
for each facet is tabulated here for all facets on the segment. Our own.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.facet import CLEARANCE, EPS
from icage.kernels.compiled import compiled, compiled_borrowing

CHECK_X, CHECK_Y, CHECK_C = range(3)
"""Columns of ``check``: g, and c less its rounding."""

BOUND, ERROR, ROUNDING, HERE_PUSH, THERE_PUSH, WEIGHT = range(6)
"""Columns of ``rest``: c, its error, how much of that is rounding; how much of a unit of force on
the bound is inward from the segment (twice, see ``Segment``); 1 / |h|, by which a row was
multiplied."""

_LEVEL = 1e-30
"""[1] Instead of h = 0: so far off, only what the bound says of w is left."""

MOST_NEAR = 32
"""Half planes that may be tight at one point, beyond which double-double takes all of them."""

_STRAIGHT = 1e-9
"""[1] Least sine of the angle of a piece between the segment and the edge beside it."""


class Bounds(NamedTuple):
    """Bounds on a finger that is on a segment: from all pieces for the second finger, then for the
    third, and then both ends of the segment.

    The rows of a piece are those of its slots, but the lower bounds come first.

    Attributes
    ----------
    check, rest:
        (2 slots + 2, 3) and (2 slots + 2, 6), columns above, all over |h|.
    upper:
        (2, m) the row where the upper bounds of a piece begin, of the second and third finger.
    slot:
        (2 slots,) the slot of a row.
    touches:
        (m,) bit 0: the segment starts at a corner of the piece; bit 1: it ends at one.
    near:
        (k, 2) memory for pairs of rows that may be tight at one point.
    """

    check: np.ndarray
    rest: np.ndarray
    upper: np.ndarray
    slot: np.ndarray
    touches: np.ndarray
    near: np.ndarray


class Segment(NamedTuple):
    """An edge of a piece, and how much of a unit of force along it, at its ends, is inward.

    Where the finger has to stay in the piece (``here``) or in the one behind the edge (``there``),
    the edge beside it takes the rest; inward is into the piece for both.
    """

    start: int
    end: int
    length: float
    here_start: float
    here_end: float
    there_start: float
    there_end: float


@compiled
def new_bounds(pieces):
    """Memory for the bounds on one finger."""
    slots, m = len(pieces.slot_vertex), len(pieces.ptr) - 1
    return Bounds(
        np.empty((2 * slots + 2, 3)), np.empty((2 * slots + 2, 6)), np.empty((2, m), np.int64),
        np.empty(2 * slots, np.int64), np.empty(m, np.int8), np.empty((MOST_NEAR, 2), np.int64),
    )  # fmt: skip


@compiled_borrowing
def _cotangent(pieces, beside, slot, ex, ey):
    """Of the angle of a piece between an edge and the one beside it, (ex, ey) from the corner."""
    nx, ny = pieces.normal_x[beside], pieces.normal_y[beside]
    cosine = -(nx * pieces.normal_x[slot] + ny * pieces.normal_y[slot])
    return cosine / max(nx * ex + ny * ey, _STRAIGHT)


@compiled_borrowing
def _beside(pieces, piece, slot):
    """The slots before and after one, round its piece."""
    first, last = pieces.ptr[piece], pieces.ptr[piece + 1] - 1
    return slot - 1 if slot > first else last, slot + 1 if slot < last else first


@compiled_borrowing
def segment_between(pieces, piece, slot):
    """An edge of a piece."""
    before, after = _beside(pieces, piece, slot)
    start, end = pieces.slot_vertex[slot], pieces.slot_vertex[after]
    ex, ey = pieces.x[end] - pieces.x[start], pieces.y[end] - pieces.y[start]
    length = math.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    here_start = -_cotangent(pieces, before, slot, ex, ey)
    here_end = -_cotangent(pieces, after, slot, -ex, -ey)
    other = pieces.slot_neighbour[slot]
    there_start, there_end = 0.0, 0.0
    if other >= 0:
        for s in range(pieces.ptr[other], pieces.ptr[other + 1]):
            if pieces.slot_vertex[s] == end:
                before, after = _beside(pieces, other, s)
                there_start = _cotangent(pieces, after, s, ex, ey)
                there_end = _cotangent(pieces, before, s, -ex, -ey)
    return Segment(start, end, length, here_start, here_end, there_start, there_end)


@compiled_borrowing
def put_bounds(pieces, z, segment, finger, bounds):
    """Bounds from the other two fingers on ``finger``, which is on a segment."""
    sx, sy, length = pieces.x[segment.start], pieces.y[segment.start], segment.length
    ex, ey = (pieces.x[segment.end] - sx) / length, (pieces.y[segment.end] - sy) / length
    check, rest = bounds.check, bounds.rest
    slots, fingers = len(pieces.slot_vertex), len(z)
    for turn in range(fingers - 1):
        other = (finger + 1 + turn) % fingers
        ux, uy = z[other, 0] - z[finger, 0], z[other, 1] - z[finger, 1]
        size = abs(ux) + abs(uy)
        for k in range(len(bounds.touches)):
            lower, upper = turn * slots + pieces.ptr[k], turn * slots + pieces.ptr[k + 1]
            touch = 0
            for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
                v = pieces.slot_vertex[s]
                if v == segment.start:
                    touch |= 1
                if v == segment.end:
                    touch |= 2
                nx, ny = pieces.normal_x[s], pieces.normal_y[s]
                dx, dy = pieces.x[v] - sx, pieces.y[v] - sy
                h = nx * ex + ny * ey
                if h >= 0.0:
                    at = lower
                    lower += 1
                else:
                    upper -= 1
                    at = upper
                weight = 1.0 / max(abs(h), _LEVEL)
                c = (nx * dx + ny * dy) * weight
                rounding = abs(dx) + abs(dy) + pieces.scale * size + length
                rounding *= 8.0 * EPS * weight
                check[at, CHECK_X] = (ux * nx + uy * ny) * weight
                check[at, CHECK_Y] = (ux * ny - uy * nx) * weight
                check[at, CHECK_C] = c - rounding
                rest[at, BOUND] = c
                rest[at, ERROR] = CLEARANCE * pieces.scale * weight + rounding
                rest[at, ROUNDING] = rounding
                rest[at, HERE_PUSH] = rest[at, THERE_PUSH] = (ex * ny - ey * nx) * weight
                rest[at, WEIGHT] = weight
                bounds.slot[at] = s
            bounds.upper[turn, k] = lower
            bounds.touches[k] = touch
    check[-2:] = 0.0
    rest[-2:] = 0.0
    rest[-2, HERE_PUSH], rest[-2, THERE_PUSH] = segment.here_start, segment.there_start
    rest[-1, HERE_PUSH], rest[-1, THERE_PUSH] = segment.here_end, segment.there_end
    rest[-1, BOUND] = -length
    rest[-1, ERROR] = rest[-1, ROUNDING] = 2.0 * EPS * length
    check[-1, CHECK_C] = -length - rest[-1, ROUNDING]
    for at in (len(rest) - 2, len(rest) - 1):
        rest[at, WEIGHT] = 1.0 + abs(rest[at, HERE_PUSH]) + abs(rest[at, THERE_PUSH])
