"""Round stretches of a ring, the points above them, and which of these stand clear.

Where a float cannot tell a sign the point is left out: it only saves cells.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.geometry.kernels.boxes import DEEP, close_tree, empty_tree, next_in_box, put_in
from icage.geometry.kernels.merging import sign_of_turn
from icage.kernels.compiled import compiled, compiled_borrowing

_FEWEST = 4
"""Edges from the first to the last of a stretch, at least: fewer gain nothing."""

_MOST = 12
"""The same on average: best between 300 and 600 edges, within a tenth from 9 to 15."""

_SPREAD = 0.4
"""[_MOST, _WIDEST] Stretches are longer and shorter by up to this: were all alike, three fingers
whole stretches apart would come under their apexes together, in the most cells."""

_GOLDEN = 0.6180339887498949
"""[1] Multiples of it modulo 1 are spread evenly and never repeat."""

_WIDEST = math.radians(25.0)
"""[rad] Turn of a stretch, at most, on average: under a flat cap few hands have three fingers."""

_FLATTEST = math.radians(0.05)
"""[rad] ... and at least, or the fan is thinner than it need be."""

_LIFT = 2.0
"""[height of where the first and the last edge meet] Height of the apex: well above both lines, so
that no piece has an angle that only rounding tells from a straight one."""


class Stretches(NamedTuple):
    """Of a ring (edge k starts at vertex k): first and last edges (k,), and apexes (k, 2).

    The last edge has a number of n or more where a stretch goes on beyond the ring's beginning.
    """

    first: np.ndarray
    last: np.ndarray
    apex: np.ndarray


@compiled
def _groups(turn):
    """First and last edges of groups with left turns only."""
    n = len(turn)
    begin = -1
    for k in range(n):
        if begin < 0 and (turn[k] <= 0.0 or turn[k] > _WIDEST / 2.0):
            begin = k
    begin = max(0, begin)  # edge k here is begin + k of the ring
    firsts, lasts = np.empty(n, np.int64), np.empty(n, np.int64)
    count = 0
    first = 0
    while first < n:
        share = ((count + 1) * _GOLDEN) % 1.0
        size = 1.0 - _SPREAD + 2.0 * _SPREAD * share
        longest, widest = round(_MOST * size), _WIDEST * size
        last, sum_of_turns = first, 0.0
        while last - first < longest and last < n:
            more = turn[(begin + last + 1) % n]
            if not 0.0 < more <= widest - sum_of_turns:
                break
            last, sum_of_turns = last + 1, sum_of_turns + more
        if last - first >= _FEWEST and sum_of_turns >= _FLATTEST:
            firsts[count], lasts[count] = begin + first, begin + last
            count += 1
        first = max(last, first + 1)
    return firsts[:count], lasts[:count]


@compiled_borrowing
def _put_apex(x, y, n, first, last, at):
    """Make vertex ``at`` a point above a group of edges that sees them all; whether it does."""
    a, a_end, b, b_end = first % n, (first + 1) % n, last % n, (last + 1) % n
    along_x, along_y = x[a_end] - x[a], y[a_end] - y[a]
    then_x, then_y = x[b_end] - x[b], y[b_end] - y[b]
    sine = along_x * then_y - along_y * then_x
    if sine <= 0.0:
        return False
    reach = ((x[b] - x[a_end]) * then_y - (y[b] - y[a_end]) * then_x) / sine
    foot_x, foot_y = 0.5 * (x[a_end] + x[b]), 0.5 * (y[a_end] + y[b])
    x[at] = foot_x + _LIFT * (x[a_end] + reach * along_x - foot_x)
    y[at] = foot_y + _LIFT * (y[a_end] + reach * along_y - foot_y)
    seen = 0
    for k in range(first, last + 1):
        seen += 1 if sign_of_turn(x, y, (k + 1) % n, k % n, at) == 1 else 0
    return seen == last + 1 - first


@compiled_borrowing
def _right_of(x, y, a, b, c):
    """Whether vertex c certainly lies to the right of the line from a to b."""
    return sign_of_turn(x, y, a, b, c) == -1


@compiled_borrowing
def _clear_of_segment(x, y, cap, a, b):
    """Whether a counterclockwise triangle (3,) and a segment have certainly no point in common."""
    for k in range(3):
        p, q = cap[k], cap[k - 1]
        if _right_of(x, y, q, p, a) and _right_of(x, y, q, p, b):
            return True
    sides = 0
    for k in range(3):
        sign = sign_of_turn(x, y, a, b, cap[k])
        sides += sign if abs(sign) == 1 else 0
    return abs(sides) == 3


@compiled_borrowing
def _clear_of_triangle(x, y, one, other):
    """The same for two counterclockwise triangles (3,)."""
    for turn in range(2):
        mine, yours = (one, other) if turn == 0 else (other, one)
        for k in range(3):
            p, q = mine[k], mine[k - 1]
            outside = 0
            for v in range(3):
                outside += 1 if _right_of(x, y, q, p, yours[v]) else 0
            if outside == 3:
                return True
    return False


@compiled
def _clear(x, y, n, first, last):
    """Which caps meet neither the ring elsewhere nor the cap of an earlier one that does not.

    The cap of stretch k is the triangle of vertex n + k and both ends of its fan.
    """
    count = len(first)
    edges, caps = empty_tree(n), empty_tree(count)
    for k in range(n):
        put_in(edges, k, x[k], y[k])
        put_in(edges, k, x[(k + 1) % n], y[(k + 1) % n])
    close_tree(edges)
    cap = np.empty((count, 3), np.int64)
    for k in range(count):
        cap[k, 0], cap[k, 1], cap[k, 2] = (first[k] + 1) % n, n + k, last[k] % n
        for c in range(3):
            put_in(caps, k, x[cap[k, c]], y[cap[k, c]])
    close_tree(caps)
    clear = np.ones(count, np.bool_)
    stack = np.empty(DEEP, np.int64)
    for k in range(count):
        box = caps[count + k]
        stack[0] = 1
        edge, waiting = next_in_box(edges, stack, 1, box)
        while edge >= 0 and clear[k]:
            beyond = (edge - first[k]) % n > last[k] - first[k]
            if beyond and not _clear_of_segment(x, y, cap[k], edge, (edge + 1) % n):
                clear[k] = False
            edge, waiting = next_in_box(edges, stack, waiting, box)
    for k in range(count):
        box = caps[count + k]
        stack[0] = 1
        other, waiting = next_in_box(caps, stack, 1, box)
        while other >= 0 and clear[k]:
            if other < k and clear[other] and not _clear_of_triangle(x, y, cap[k], cap[other]):
                clear[k] = False
            other, waiting = next_in_box(caps, stack, waiting, box)
    return clear


@compiled
def round_stretches(ring, turn):
    """Stretches of a counterclockwise ring (n, 2) whose vertices turn by (n,), [rad]."""
    n = len(ring)
    first, last = _groups(turn) if n > _FEWEST else _groups(turn[:0])
    x, y = np.empty(n + len(first)), np.empty(n + len(first))
    for k in range(n):
        x[k], y[k] = ring[k, 0], ring[k, 1]
    count = 0
    for k in range(len(first)):
        first[count], last[count] = first[k], last[k]
        if _put_apex(x, y, n, first[k], last[k], n + count):
            count += 1
    first, last = first[:count], last[:count]
    apex = np.empty((count, 2))
    kept = 0
    if count > 0:
        clear = _clear(x, y, n, first, last)
        for k in range(count):
            if clear[k]:
                first[kept], last[kept] = first[k], last[k]
                apex[kept, 0], apex[kept, 1] = x[n + k], y[n + k]
                kept += 1
    return Stretches(first[:kept], last[:kept], apex[:kept])


@compiled
def under_apexes(n, first, last):
    """The ring of n vertices through the apexes (n + k over stretch k), and the fans beneath."""
    over, under = np.full(n, -1, np.int64), np.zeros(n, np.bool_)
    count = 0
    for k in range(len(first)):
        over[(first[k] + 1) % n] = n + k
        count += last[k] - first[k] - 1
        for v in range(first[k] + 2, last[k]):
            under[v % n] = True
    fans = np.empty((count, 3), np.int64)
    fan = 0
    for k in range(len(first)):
        for v in range(first[k] + 1, last[k]):
            fans[fan, 0], fans[fan, 1], fans[fan, 2] = n + k, (v + 1) % n, v % n
            fan += 1
    coarse = np.empty(n + len(first), np.int64)
    size = 0
    for v in range(n):
        if not under[v]:
            coarse[size] = v
            size += 1
            if over[v] >= 0:
                coarse[size] = over[v]
                size += 1
    return coarse[:size], fans
