"""All passes and all least points of one hand's free space: its whole sublevel structure.

Only cells that hold a hand are looked at, each facet once. A stage takes a stretch of the cells,
so that threads can share it; what comes out does not depend on how the stretches are cut. Our own.
[docs/decisions/0014-whole-sublevels.md]
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.facet import BASE_COLUMNS, MAX_BASE, facet_of, finger_on_segment
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.search import birth
from icage.kernels.compiled import compiled
from icage.kernels.union_find import root_of

_SAME = 1e-9
"""[diameter] Least points that two fingers tell of are one if they differ by less: far above the
error of a pass value, and nothing more precise hangs on it."""


class Passes(NamedTuple):
    """Passes (e,): the numbers of the cells on both sides, and the least sigma between them."""

    lower: np.ndarray
    upper: np.ndarray
    sigma: np.ndarray


class LeastPoints(NamedTuple):
    """Least sigma (n,) of cells, and the edge of its piece that the finger is on there.

    ``finger`` and ``slot`` (n,) are -1 where the least point is on a pass, or is a pinched hand.
    """

    sigma: np.ndarray
    finger: np.ndarray
    slot: np.ndarray


class Ends(NamedTuple):
    """Where the minima of cells end, by the elder rule.

    ``merged`` (n,) is the level at which the component of which a cell is the minimum meets a
    deeper one, whose minimum is the cell ``elder`` (n,); inf and -1: never.
    """

    merged: np.ndarray
    elder: np.ndarray


@compiled
def rows_of(cells, m):
    """(m^2 + 1,) where the cells (a, b, .) begin, at a m + b, in cells (n, 3) that are in order."""
    row = np.zeros(m * m + 1, np.int64)
    for k in range(len(cells)):
        row[cells[k, 0] * m + cells[k, 1] + 1] += 1
    for pair in range(m * m):
        row[pair + 1] += row[pair]
    return row


@compiled
def _number_of(cells, row, m, cell):
    """Number of a cell, -1 if it is not among those that hold a hand."""
    pair = cell[0] * m + cell[1]
    low, high = row[pair], row[pair + 1]
    while low < high:
        middle = (low + high) >> 1
        if cells[middle, 2] < cell[2]:
            low = middle + 1
        else:
            high = middle
    return low if low < row[pair + 1] and cells[low, 2] == cell[2] else -1


@compiled
def passes_between(pieces, z, cells, row, first, last, cap, worst):
    """Passes up to ``cap`` from the cells ``first`` to ``last`` to those across later pieces."""
    m = len(pieces.ptr) - 1
    room = new_room()
    lower = np.empty(1024, np.int32)
    upper = np.empty(1024, np.int32)
    sigma = np.empty(1024)
    cell = np.empty(len(z), np.int64)
    count = 0
    for k in range(first, last):
        cell[:] = cells[k]
        for i in range(len(z)):
            piece = cell[i]
            for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
                if pieces.slot_neighbour[s] <= piece:
                    continue
                cell[i] = pieces.slot_neighbour[s]
                across = _number_of(cells, row, m, cell)
                cell[i] = piece
                if across < 0:
                    continue
                value = pass_value(pieces, z, facet_of(pieces, cell, i, s), cap, worst, room).sigma
                if value == np.inf:
                    continue
                if count == len(lower):
                    lower = np.concatenate((lower, np.empty_like(lower)))
                    upper = np.concatenate((upper, np.empty_like(upper)))
                    sigma = np.concatenate((sigma, np.empty_like(sigma)))
                lower[count], upper[count], sigma[count] = k, across, value
                count += 1
    return Passes(lower[:count], upper[:count], sigma[:count])


@compiled
def least_passes(count, lower, upper, sigma):
    """The least pass (count,) of every cell, inf for none."""
    least = np.full(count, np.inf)
    for e in range(len(sigma)):
        least[lower[e]] = min(least[lower[e]], sigma[e])
        least[upper[e]] = min(least[upper[e]], sigma[e])
    return least


@compiled
def _walls(pieces, piece):
    """How many edges of a piece lead nowhere."""
    count = 0
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        count += pieces.slot_neighbour[s] < 0
    return count


@compiled
def least_points(pieces, z, cells, least, first, last, cap, worst):
    """Least sigma of the cells ``first`` to ``last``, of which the least pass is known.

    At a positive minimum two fingers are held by an edge of their piece: of any two of the three
    one is. What is no pass has it on an edge that leads nowhere, so the finger with the most of
    those is not asked. Only of a cell without a pass all are asked: one that is empty but for a
    hand which touches on all sides has a least point on some edges and, by rounding, no pass to
    the cells with the same hand. Two fingers must tell of it.
    """
    room = new_room()
    low = least[first:last].copy()
    at_finger = np.full(last - first, -1, np.int8)
    at_slot = np.full(last - first, -1, np.int32)
    walls = np.empty(len(pieces.ptr) - 1, np.int64)
    for piece in range(len(walls)):
        walls[piece] = _walls(pieces, piece)
    cell = np.empty(len(z), np.int64)
    held = np.empty(len(z))
    for k in range(first, last):
        n = k - first
        cell[:] = cells[k]
        if cell[0] == cell[1] and cell[1] == cell[2]:
            low[n] = 0.0
        if low[n] == 0.0:
            continue
        spared = np.argmax(walls[cell]) if low[n] < np.inf else -1
        held[:] = np.inf
        for i in range(len(z)):
            if i == spared:
                continue
            for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
                if pieces.slot_neighbour[s] >= 0:
                    continue
                most = min(low[n] if spared >= 0 else held[i], cap)
                facet = facet_of(pieces, cell, i, s)
                value = pass_value(pieces, z, facet, most, worst, room).sigma
                held[i] = min(held[i], value)
                if value < low[n]:
                    low[n] = value
                    at_finger[n], at_slot[n] = i, s
        if spared < 0 and np.sum(held <= low[n] + _SAME * pieces.diameter) < 2:
            low[n] = np.inf
    return LeastPoints(low, at_finger, at_slot)


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


@compiled
def ends_of_minima(low, lower, upper, sigma, order):
    """Merges of all cells, born at ``low`` (n,), over passes taken in ``order``. [Kruskal1956]"""
    n = len(low)
    parent = np.arange(n)
    size = np.ones(n, np.int32)
    lowest = np.arange(n)
    merged = np.full(n, np.inf)
    elder = np.full(n, -1)
    for e in order:
        a, b = root_of(parent, lower[e]), root_of(parent, upper[e])
        if a == b:
            continue
        keep, lose = lowest[a], lowest[b]
        if low[lose] < low[keep] or (low[lose] == low[keep] and lose < keep):
            keep, lose = lose, keep
        merged[lose] = sigma[e]
        elder[lose] = keep
        if size[a] < size[b]:
            a, b = b, a
        parent[b] = a
        size[a] += size[b]
        lowest[a] = keep
    return Ends(merged, elder)
