"""All passes and all least points of one hand's free space: its whole sublevel structure.

Only cells that hold a hand are looked at, all facets on one edge of a piece together. A stage takes
one piece of one finger, so that threads can share it; what comes out does not depend on who took
which. Our own. [docs/decisions/0014-whole-sublevels.md]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.along import new_bounds, put_bounds, segment_between
from icage.cells.kernels.confirmed import confirmed
from icage.cells.kernels.facet import BASE_COLUMNS, MAX_BASE, Facet, facet_of, finger_on_segment
from icage.cells.kernels.least_along import HERE, THERE, least_along
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE
from icage.cells.kernels.passes import new_room, pass_value, value_carefully
from icage.cells.kernels.search import birth
from icage.kernels.compiled import compiled, compiled_borrowing

LEAST, EMPTY = range(2)
"""Columns of ``told`` (n, 2), 1 where it is known of a cell: its least point is on a pass; it holds
no hand up to the cap. Each is only ever put to 1, so that threads may do so at once."""

_SAME = 1e-9
"""[diameter] Least points that two fingers tell of are one if they differ by less: far above the
error of a pass value, and nothing more precise hangs on it."""


class Passes(NamedTuple):
    """Passes (e,): the numbers of the cells on both sides, and the least sigma between them."""

    lower: np.ndarray
    upper: np.ndarray
    sigma: np.ndarray


class Lists(NamedTuple):
    """Cells by the piece of one finger: those of piece p are the rows begin[p]:begin[p + 1].

    ``key`` (n,) are the pieces of the two others, a m + b, in ascending order within a piece;
    ``number`` (n,) is the number of the cell.
    """

    begin: np.ndarray
    key: np.ndarray
    number: np.ndarray


@compiled
def cells_by_piece(cells, m, i):
    """The cells (n, 3), which are in order, by the piece of finger i."""
    fingers = cells.shape[1]
    a, b = min((i + 1) % fingers, (i + 2) % fingers), max((i + 1) % fingers, (i + 2) % fingers)
    begin = np.zeros(m + 1, np.int64)
    for n in range(len(cells)):
        begin[cells[n, i] + 1] += 1
    for piece in range(m):
        begin[piece + 1] += begin[piece]
    at = begin[:-1].copy()
    key = np.empty(len(cells), np.int32)
    number = np.empty(len(cells), np.int32)
    for n in range(len(cells)):
        row = at[cells[n, i]]
        key[row] = cells[n, a] * m + cells[n, b]
        number[row] = n
        at[cells[n, i]] += 1
    return Lists(begin, key, number)


@compiled_borrowing
def _least(pieces, bounds, at_j, at_k, cap, worst):
    """The least point with the second finger in piece ``at_j`` and the third in ``at_k``."""
    ptr, upper, slots = pieces.ptr, bounds.upper, len(pieces.slot_vertex)
    return least_along(
        bounds.check, bounds.rest, bounds.near, ptr[at_j], upper[0, at_j], ptr[at_j + 1],
        slots + ptr[at_k], upper[1, at_k], slots + ptr[at_k + 1], cap, worst,
    )  # fmt: skip


@compiled_borrowing
def _value(pieces, z, i, segment, at_j, at_k, bounds, found, cap):
    """Least sigma, inf for none up to ``cap``."""
    if found.status == INFEASIBLE:
        return np.inf
    wx, wy = found.w_x, found.w_y
    if found.status != FOUND:
        fingers = len(z)
        j, k = (i + 1) % fingers, (i + 2) % fingers
        facet = Facet(i, segment.start, segment.end, j, at_j, k, at_k)
        if found.status == UNSURE:
            return value_carefully(pieces, z, facet, cap).sigma
        status, wx, wy = confirmed(pieces, z, facet, bounds.slot, bounds.near, found)
        if status == UNSURE:
            return value_carefully(pieces, z, facet, cap).sigma
    sigma = math.sqrt(wx * wx + wy * wy)
    return sigma if sigma <= cap else np.inf


@compiled
def passes_from(pieces, z, lists, told, i, piece, cap, worst):
    """Passes up to ``cap`` that finger i makes from a piece into later ones.

    And what they tell of the cells on both sides.
    """
    m = len(pieces.ptr) - 1
    fingers = len(z)
    j, k = (i + 1) % fingers, (i + 2) % fingers
    bounds = new_bounds(pieces)
    begin, key, number = lists.begin, lists.key, lists.number
    most = 0
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        other = pieces.slot_neighbour[s]
        if other > piece:
            most += min(begin[piece + 1] - begin[piece], begin[other + 1] - begin[other])
    lower = np.empty(most, np.int32)
    upper = np.empty(most, np.int32)
    sigma = np.empty(most)
    count = 0
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        other = pieces.slot_neighbour[s]
        if other <= piece:
            continue
        segment = segment_between(pieces, piece, s)
        put_bounds(pieces, z, segment, i, bounds)
        x, y = begin[piece], begin[other]
        while x < begin[piece + 1] and y < begin[other + 1]:
            if key[x] < key[y]:
                x += 1
                continue
            if key[x] > key[y]:
                y += 1
                continue
            here, there = number[x], number[y]
            at_j, at_k = key[x] // m, key[x] % m
            if j > k:
                at_j, at_k = at_k, at_j
            x += 1
            y += 1
            if bounds.touches[at_j] & bounds.touches[at_k]:
                value = 0.0  # all fingers in one corner
            else:
                found = _least(pieces, bounds, at_j, at_k, cap, worst)
                value = _value(pieces, z, i, segment, at_j, at_k, bounds, found, cap)
                of = LEAST if value < np.inf else EMPTY
                if found.told & HERE:
                    told[here, of] = 1
                if found.told & THERE:
                    told[there, of] = 1
            if value < np.inf:
                lower[count], upper[count], sigma[count] = min(here, there), max(here, there), value
                count += 1
    return Passes(lower[:count].copy(), upper[:count].copy(), sigma[:count].copy())


@compiled
def least_passes(count, lower, upper, sigma):
    """The least pass (count,) of every cell, inf for none, and which it is, -1 for none."""
    least = np.full(count, np.inf)
    which = np.full(count, -1, np.int32)
    for e in range(len(sigma)):
        if sigma[e] < least[lower[e]]:
            least[lower[e]], which[lower[e]] = sigma[e], e
        if sigma[e] < least[upper[e]]:
            least[upper[e]], which[upper[e]] = sigma[e], e
    return least, which


@compiled
def edges_that_lead_nowhere(pieces):
    """How many (m,) of the edges of every piece are the object's."""
    walls = np.zeros(len(pieces.ptr) - 1, np.int64)
    for piece in range(len(walls)):
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            walls[piece] += pieces.slot_neighbour[s] < 0
    return walls


@compiled
def lower_at_walls(pieces, z, lists, told, walls, low, finger, slot, i, piece, worst):
    """Lower ``low`` to where finger i is on an edge of its piece that leads nowhere.

    At a positive minimum two fingers are held by an edge of their piece: of any two of the three
    one is. What is no pass has it on an edge that leads nowhere, so the finger with the most of
    those is not asked. Cells without a pass are left out, see ``least_of_isolated``.
    """
    m = len(pieces.ptr) - 1
    fingers = len(z)
    j, k = (i + 1) % fingers, (i + 2) % fingers
    bounds = new_bounds(pieces)
    cell = np.empty(fingers, np.int64)
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        if pieces.slot_neighbour[s] >= 0:
            continue
        segment = segment_between(pieces, piece, s)
        put_bounds(pieces, z, segment, i, bounds)
        for x in range(lists.begin[piece], lists.begin[piece + 1]):
            n = lists.number[x]
            if told[n, LEAST] or not 0.0 < low[n] < np.inf:
                continue
            at_j, at_k = lists.key[x] // m, lists.key[x] % m
            if j > k:
                at_j, at_k = at_k, at_j
            cell[i], cell[j], cell[k] = piece, at_j, at_k
            if np.argmax(walls[cell]) == i:
                continue
            found = _least(pieces, bounds, at_j, at_k, low[n], worst)
            value = _value(pieces, z, i, segment, at_j, at_k, bounds, found, low[n])
            if value < np.inf and found.told & HERE:
                told[n, LEAST] = 1
            if value < low[n]:
                low[n], finger[n], slot[n] = value, i, s


@compiled
def least_of_isolated(pieces, z, cells, isolated, low, finger, slot, cap, worst):
    """Put ``low`` of the cells ``isolated`` (k,), which have no pass.

    One that is empty but for a hand which touches on all sides has a least point on some edges and,
    by rounding, no pass to the cells with the same hand. Two fingers must tell of it.
    """
    room = new_room()
    cell = np.empty(len(z), np.int64)
    held = np.empty(len(z))
    for n in isolated:
        cell[:] = cells[n]
        held[:] = np.inf
        for i in range(len(z)):
            for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
                if pieces.slot_neighbour[s] >= 0:
                    continue
                facet = facet_of(pieces, cell, i, s)
                value = pass_value(pieces, z, facet, min(held[i], cap), worst, room).sigma
                held[i] = min(held[i], value)
                if value < low[n]:
                    low[n], finger[n], slot[n] = value, i, s
        if np.sum(held <= low[n] + _SAME * pieces.diameter) < 2:
            low[n], finger[n], slot[n] = np.inf, -1, -1


@compiled
def least_hands(pieces, z, cells, fingers, slots, cap, worst):
    """Hands (n, 4) = d_x, d_y, w_x, w_y at the least points of cells, as of ``LeastPoints``.

    In the middle of what is level in a cell.
    """
    room = new_room()
    base = np.empty((MAX_BASE, BASE_COLUMNS))
    hands = np.empty((len(cells), 4))
    cell = np.empty(len(z), np.int64)
    for k in range(len(cells)):
        cell[:] = cells[k]
        finger, slot = np.int64(fingers[k]), np.int64(slots[k])
        if finger < 0:
            born = birth(pieces, z, cell, cap, worst, room)
            finger, slot, wx, wy = born.finger, born.slot, born.w_x, born.w_y
        else:
            found = pass_value(pieces, z, facet_of(pieces, cell, finger, slot), cap, worst, room)
            wx, wy = found.w_x, found.w_y
        ends = finger_on_segment(pieces, z, facet_of(pieces, cell, finger, slot), wx, wy, base)
        hands[k, 0] = 0.5 * (ends.x_lo + ends.x_hi) - (wx * z[finger, 0] - wy * z[finger, 1])
        hands[k, 1] = 0.5 * (ends.y_lo + ends.y_hi) - (wx * z[finger, 1] + wy * z[finger, 0])
        hands[k, 2], hands[k, 3] = wx, wy
    return hands
