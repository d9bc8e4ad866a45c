"""Facets: one finger on a segment, the others in convex pieces, as half planes.

Finger i stands at P + tau e on the segment, the others at that point plus w (z_j - z_i), each in
its convex piece: every constraint is linear in (tau, w). Our own. [docs/theory.md, Sec. 3.3]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.tips import MOST_TIPS, SHARP, tip_at

MAX_EDGES = 12
"""Most edges of a merged piece: bounds the number of rows below."""

MAX_BASE = 2 * (MAX_EDGES + MOST_TIPS) + 2
"""Half planes of both other fingers, across tips too, and the ends of the segment."""

MAX_ROWS = MAX_BASE * MAX_BASE // 4 + MAX_BASE
"""Pairs of those that bound a finger from below and from above, and those that do neither."""

EPS = 2.220446049250313e-16
"""[1] The last place of a double."""

CLEARANCE = 2e-14
"""[diameter] Touching is free: a facet that is empty by no more than this counts as open, so that
the rounding of a turned drawing cannot close a passage of no width."""

G_X, G_Y, ALONG, BOUND, ERROR, ROUNDING = range(6)
"""Columns of the half planes g . w + h tau >= c +- error: g, h, c, error, and how much of the error
is rounding; the rest is ``CLEARANCE``, which decides whether there is a w but moves none."""

BASE_COLUMNS = 6


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


class Stretch(NamedTuple):
    """Both ends of where a finger may be along a segment."""

    x_lo: float
    y_lo: float
    x_hi: float
    y_hi: float


@compiled_borrowing
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


@compiled_borrowing
def segment_of(pieces, facet):
    """The segment of a facet."""
    px = pieces.x[facet.start]
    py = pieces.y[facet.start]
    ex = pieces.x[facet.end] - px
    ey = pieces.y[facet.end] - py
    # not hypot, whose last place is not the same in the interpreter
    length = math.sqrt(ex * ex + ey * ey)
    return Segment(px, py, ex / length, ey / length, length)


@compiled_borrowing
def _put_row(pieces, segment, ux, uy, nx, ny, s, base, count):
    """The half plane through the corner where slot ``s`` begins, of normal n, for the finger at u
    from the one on the segment.
    """
    a = pieces.slot_vertex[s]
    dx = pieces.x[a] - segment.x
    dy = pieces.y[a] - segment.y
    base[count, G_X] = ux * nx + uy * ny
    base[count, G_Y] = ux * ny - uy * nx
    base[count, ALONG] = nx * segment.e_x + ny * segment.e_y
    base[count, BOUND] = nx * dx + ny * dy
    far = abs(dx) + abs(dy) + pieces.scale * (abs(ux) + abs(uy)) + segment.length
    rounding = 8.0 * EPS * far
    base[count, ERROR], base[count, ROUNDING] = CLEARANCE * pieces.scale + rounding, rounding


@compiled_borrowing
def rows_of_others(pieces, z, facet, segment, base):
    """The half planes of both other fingers' pieces; returns how many.

    None across sharp tips: what gives way by more than rounding is decided in ``careful``, which
    has them.
    """
    count = 0
    for other in range(2):
        finger, piece = facet.second, facet.second_piece
        if other == 1:
            finger, piece = facet.third, facet.third_piece
        ux = z[finger, 0] - z[facet.finger, 0]
        uy = z[finger, 1] - z[facet.finger, 1]
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            _put_row(
                pieces, segment, ux, uy, pieces.normal_x[s], pieces.normal_y[s], s, base, count
            )
            count += 1
    return count


@compiled_borrowing
def _rows_of_tips(pieces, z, facet, segment, base, count):
    """Append the half planes across the sharp tips of these pieces; returns how many there are."""
    for other in range(2):
        finger, piece = facet.second, facet.second_piece
        if other == 1:
            finger, piece = facet.third, facet.third_piece
        ux = z[finger, 0] - z[facet.finger, 0]
        uy = z[finger, 1] - z[facet.finger, 1]
        before = pieces.ptr[piece + 1] - 1
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            tip = tip_at(pieces, before, s, SHARP)
            if tip.sharp:
                _put_row(pieces, segment, ux, uy, tip.n_x, tip.n_y, s, base, count)
                count += 1
            before = s
    return count


@compiled_borrowing
def finger_on_segment(pieces, z, facet, wx, wy, base):
    """Where the finger of a facet may be along its segment for a given w."""
    segment = segment_of(pieces, facet)
    n = rows_of_others(pieces, z, facet, segment, base)
    n = _rows_of_tips(pieces, z, facet, segment, base, n)
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
    return finger_on_segment(pieces, z, facet, wx, wy, np.empty((MAX_BASE, BASE_COLUMNS)))


@compiled
def middles_on_facets(pieces, z, cells, fingers, slots, w):
    """Hands (k, 4) = d_x, d_y, w_x, w_y in the middle of where facets of cells hold a given w."""
    base = np.empty((MAX_BASE, BASE_COLUMNS))
    hands = np.empty((len(cells), 4))
    for k in range(len(cells)):
        finger = fingers[k]
        wx, wy = w[k, 0], w[k, 1]
        ends = finger_on_segment(
            pieces, z, facet_of(pieces, cells[k], finger, slots[k]), wx, wy, base
        )
        hands[k, 0] = 0.5 * (ends.x_lo + ends.x_hi) - (wx * z[finger, 0] - wy * z[finger, 1])
        hands[k, 1] = 0.5 * (ends.y_lo + ends.y_hi) - (wx * z[finger, 1] + wy * z[finger, 0])
        hands[k, 2], hands[k, 3] = wx, wy
    return hands
