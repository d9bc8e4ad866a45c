"""What all pieces say of a finger on one segment: bounds on how far along it may be.

With a finger at tau along a segment, another one in a piece obeys g . w + h tau >= c for each edge
of the piece. Over |h| that is a lower or an upper bound on tau, affine in w, and two of them
together are a half plane for w whose columns are the sums of theirs: what ``passes`` multiplies out
for each facet is tabulated here for all facets on the segment. Our own.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.facet import CLEARANCE, EPS
from icage.kernels.compiled import compiled, compiled_borrowing

CHECK_X, CHECK_Y, CHECK_C = range(3)
"""Columns of ``check``: g, and c less its rounding."""

BOUND, ERROR, ROUNDING, PUSH, WEIGHT = range(5)
"""Columns of ``rest``: c, its error, how much of that is rounding; what a unit of force on the
bound pushes the finger off the segment, inwards; 1 / |h|."""

_LEVEL = 1e-30
"""[1] Instead of h = 0: a bound so far off that only what it says of w is left."""


class Bounds(NamedTuple):
    """Bounds from all pieces, in the order of their slots but the lower ones of a piece first.

    Attributes
    ----------
    check, rest:
        (slots, 3) and (slots, 5), columns above, all over |h|.
    upper:
        (m,) where the upper bounds of a piece begin.
    touches:
        (m,) bit 0: the segment starts at a corner of the piece; bit 1: it ends at one.
    """

    check: np.ndarray
    rest: np.ndarray
    upper: np.ndarray
    touches: np.ndarray


@compiled
def new_bounds(pieces):
    """Memory for the bounds of one finger."""
    slots, m = len(pieces.slot_vertex), len(pieces.ptr) - 1
    return Bounds(
        np.empty((slots, 3)), np.empty((slots, 5)), np.empty(m, np.int64), np.empty(m, np.int8)
    )


@compiled_borrowing
def after(pieces, piece, slot):
    """The next slot round a piece."""
    return slot + 1 if slot + 1 < pieces.ptr[piece + 1] else pieces.ptr[piece]


class Side(NamedTuple):
    """A segment's length, and what a unit of force along it at its ends pushes the finger off it.

    Inwards: ``here`` where it has to stay in the piece, ``there`` in the one behind the segment.
    """

    length: float
    here_start: float
    here_end: float
    there_start: float
    there_end: float


@compiled_borrowing
def side_of(pieces, piece, slot):
    """The edge of a piece as a segment."""
    start, end = pieces.slot_vertex[slot], pieces.slot_vertex[after(pieces, piece, slot)]
    ex, ey = pieces.x[end] - pieces.x[start], pieces.y[end] - pieces.y[start]
    length = np.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    here_start = -_cotangent(pieces, before(pieces, piece, slot), slot, ex, ey)
    here_end = -_cotangent(pieces, after(pieces, piece, slot), slot, -ex, -ey)
    other = pieces.slot_neighbour[slot]
    there_start, there_end = 0.0, 0.0
    if other >= 0:
        for s in range(pieces.ptr[other], pieces.ptr[other + 1]):
            if pieces.slot_vertex[s] == end:
                there_start = _cotangent(pieces, after(pieces, other, s), s, ex, ey)
                there_end = _cotangent(pieces, before(pieces, other, s), s, -ex, -ey)
    return Side(length, here_start, here_end, there_start, there_end)


@compiled_borrowing
def before(pieces, piece, slot):
    """The slot before round a piece."""
    return slot - 1 if slot > pieces.ptr[piece] else pieces.ptr[piece + 1] - 1


@compiled_borrowing
def _cotangent(pieces, beside, slot, ex, ey):
    """Of the angle of a piece between an edge and the one beside it, (ex, ey) from the corner."""
    nx, ny = pieces.normal_x[beside], pieces.normal_y[beside]
    cosine = -(nx * pieces.normal_x[slot] + ny * pieces.normal_y[slot])
    return cosine / max(nx * ex + ny * ey, 1e-9)


@compiled_borrowing
def put_bounds(pieces, z, piece, slot, finger, other, bounds):
    """Bounds from the finger ``other`` on ``finger``, which is on an edge of its piece."""
    start, end = pieces.slot_vertex[slot], pieces.slot_vertex[after(pieces, piece, slot)]
    sx, sy = pieces.x[start], pieces.y[start]
    ex, ey = pieces.x[end] - sx, pieces.y[end] - sy
    length = np.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    inward_x, inward_y = pieces.normal_x[slot], pieces.normal_y[slot]
    ux, uy = z[other, 0] - z[finger, 0], z[other, 1] - z[finger, 1]
    size = abs(ux) + abs(uy)
    check, rest = bounds.check, bounds.rest
    for k in range(len(bounds.upper)):
        lower, upper = pieces.ptr[k], pieces.ptr[k + 1]
        touch = 0
        for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
            v = pieces.slot_vertex[s]
            if v == start:
                touch |= 1
            if v == end:
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
            rounding = 8.0 * EPS * (abs(dx) + abs(dy) + pieces.scale * size + length) * weight
            check[at, CHECK_X] = (ux * nx + uy * ny) * weight
            check[at, CHECK_Y] = (ux * ny - uy * nx) * weight
            check[at, CHECK_C] = c - rounding
            rest[at, BOUND] = c
            rest[at, ERROR] = CLEARANCE * pieces.scale * weight + rounding
            rest[at, ROUNDING] = rounding
            rest[at, PUSH] = (nx * inward_x + ny * inward_y) * weight
            rest[at, WEIGHT] = weight
        bounds.upper[k] = lower
        bounds.touches[k] = touch
    return length
