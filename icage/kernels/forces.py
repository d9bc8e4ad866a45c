"""Forces that do not pull and balance a vector as well as they can, for a handful of columns."""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled

_EPS = float(np.finfo(np.float64).eps)

_ROUNDING = 10.0 * _EPS
"""[1] A column that shortens the miss by less, over the size of all columns, does not help."""

_TURNS = 3
"""Columns that are taken up, over their number; more is going round in the circles of rounding."""

_APART = 1e-3
"""[1] Least over largest pivot of columns all of which may press at once. Of columns that are
nearly alike, as where an arc goes over into its edge, one is enough; taking them up one by one
finds that."""

_DEPENDS = 10.0 * _EPS
"""[1] What is left of a column after those before it, over its length, that is rounding."""

_TINY = float(np.finfo(np.float64).tiny)


class Pushing(NamedTuple):
    """Forces (k,), and how far their sum is from the vector."""

    force: np.ndarray
    miss: float


@compiled
def least_squares(columns, which, count, wanted, best):
    """Weights ``best`` (count,) of the columns ``which`` (count,) whose sum is nearest to a vector.

    Householder's reflections. A column that depends on those before it gets no weight. Returns the
    least pivot over the largest, 0 if a column depends on others.
    """
    m = len(wanted)
    table = np.empty((m, count + 1))
    for i in range(m):
        for j in range(count):
            table[i, j] = columns[i, which[j]]
        table[i, count] = wanted[i]
    pivot_row = np.empty(count, np.int64)
    row = 0
    least = np.inf
    largest = 0.0
    for j in range(count):
        whole = 0.0
        for i in range(m):
            whole += table[i, j] * table[i, j]
        left = 0.0
        for i in range(row, m):
            left += table[i, j] * table[i, j]
        norm = math.sqrt(left)
        if row >= m or norm <= _DEPENDS * math.sqrt(whole):
            pivot_row[j] = -1
            least = 0.0
            continue
        pivot_row[j] = row
        least = min(least, norm)
        largest = max(largest, norm)
        head = table[row, j]
        pivot = -norm if head > 0.0 else norm
        table[row, j] = head - pivot
        # the reflection that takes this column to the pivot
        scale = norm * (norm + abs(head))
        for other in range(j + 1, count + 1):
            dot = 0.0
            for i in range(row, m):
                dot += table[i, j] * table[i, other]
            dot /= scale
            for i in range(row, m):
                table[i, other] -= dot * table[i, j]
        table[row, j] = pivot
        row += 1
    for j in range(count - 1, -1, -1):
        at = pivot_row[j]
        if at < 0:
            best[j] = 0.0
            continue
        total = table[at, count]
        for other in range(j + 1, count):
            total -= table[at, other] * best[other]
        best[j] = total / table[at, j]
    return least / largest if largest > 0.0 else 0.0


@compiled
def pushing_of(columns, wanted):
    """Forces >= 0 (k,) whose sum over columns (m, k) comes nearest to a vector, and the miss.

    The active set method of [Lawson1974].
    """
    m, count = columns.shape
    force = np.zeros(count)
    off = np.empty(m)
    for i in range(m):
        off[i] = wanted[i]
    if count == 0:
        return Pushing(force, _length(off))
    pressing = np.empty(count, np.int64)
    best = np.empty(count)
    for j in range(count):
        pressing[j] = j
    apart = least_squares(columns, pressing, count, wanted, best)
    if apart > _APART and _least(best, count) > 0.0:  # all press: most often so
        _put_off(columns, wanted, best, off)
        return Pushing(best, _length(off))
    largest = 0.0
    for j in range(count):
        total = 0.0
        for i in range(m):
            total += abs(columns[i, j])
        largest = max(largest, total)
    least = _ROUNDING * max(m, count) * largest
    presses = np.zeros(count, np.bool_)
    now = 0
    for _ in range(_TURNS * count):
        most = -1
        help_of_most = least
        for j in range(count):
            if presses[j]:
                continue
            helps = 0.0
            for i in range(m):
                helps += columns[i, j] * off[i]
            if helps > help_of_most:
                most, help_of_most = j, helps
        if most < 0:
            break
        presses[most] = True
        pressing[now] = most
        now += 1
        now = _without_pulling(columns, wanted, pressing, now, presses, force, best)
        _put_off(columns, wanted, force, off)
    return Pushing(force, _length(off))


@compiled
def _without_pulling(columns, wanted, pressing, now, presses, force, best):
    """Make ``force`` the forces of the least miss, of those that press and would not pull then.

    From forces that do not pull straight to the best ones, as far as none pulls; who would pull
    first is left out. Returns how many press.
    """
    while now > 0:
        least_squares(columns, pressing, now, wanted, best)
        if _least(best, now) > 0.0:
            for j in range(len(force)):
                force[j] = 0.0
            for k in range(now):
                force[pressing[k]] = best[k]
            return now
        way = np.inf
        for k in range(now):
            if best[k] <= 0.0:
                has = force[pressing[k]]
                way = min(way, has / max(has - best[k], _TINY))
        kept = 0
        for k in range(now):
            j = pressing[k]
            has = force[j]
            stays = best[k] > 0.0 or has / max(has - best[k], _TINY) > way
            if stays:
                force[j] = has + way * (best[k] - has)
                pressing[kept] = j
                kept += 1
            else:
                force[j] = 0.0
                presses[j] = False
        now = kept
    return 0


@compiled
def _put_off(columns, wanted, force, off):
    """Make ``off`` what the forces leave of a vector."""
    for i in range(len(wanted)):
        total = wanted[i]
        for j in range(len(force)):
            total -= columns[i, j] * force[j]
        off[i] = total


@compiled
def _least(values, count):
    """The smallest of the first numbers."""
    least = values[0]
    for k in range(1, count):
        least = min(least, values[k])
    return least


@compiled
def _length(vector):
    """Of a vector."""
    total = 0.0
    for x in vector:
        total += x * x
    return math.sqrt(total)
