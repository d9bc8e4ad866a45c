"""Newton's method for a hand whose forces balance at given features, and steps of closing."""

# pyright: basic
from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.discs.kernels.features import put_gaps
from icage.kernels.compiled import compiled
from icage.kernels.forces import least_squares, pushing_of

TOUCHES = 1e-10
"""[diameter] A solved finger is this near to the features it touches, and no deeper in any."""

BALANCED = 1e-9
"""[1] Residual of the forces of a solved hand, over its size."""

STEPS = 12
"""Newton steps; from a polygon's answer five are enough."""

_REGULAR = 1e-7
"""[1] Least over largest pivot of equations that have one solution."""

_STANDS = 1e-12
"""[diameter] A descent that closes by less in a step has come to rest."""

_LIGHT = 1e-3
"""[1] Weight of the way of the hand, beside that of its size, in a step of closing."""


class Ended(IntEnum):
    """How Newton's method or a descent ended."""

    SOLVED = 0
    FAILED = 1
    IRREGULAR = 2
    """The equations have no or many solutions."""
    MOVING = 3
    STANDS = 4
    LOST = 5
    """Nothing is near: the hand closes to a point."""


SOLVED, FAILED, IRREGULAR, MOVING, STANDS, LOST = Ended


class Solved(NamedTuple):
    """A hand (4,) and the forces (m,) at its features."""

    ended: Ended
    v: np.ndarray
    force: np.ndarray


class Descent(NamedTuple):
    """A hand (4,) after some steps, its sigma, and how many were made."""

    ended: Ended
    v: np.ndarray
    sigma: float
    steps: int


@compiled
def _solved(table, size):
    """Solve equations (size, size + 1) in place, the answer in the last column; whether regular.

    Gauss's elimination with the largest pivot of all.
    """
    place = np.arange(size)
    largest = 0.0
    for k in range(size):
        pivot = 0.0
        row, column = k, k
        for i in range(k, size):
            for j in range(k, size):
                if abs(table[i, j]) > pivot:
                    pivot = abs(table[i, j])
                    row, column = i, j
        largest = max(largest, pivot)
        if pivot <= _REGULAR * largest:
            return False
        for j in range(size + 1):
            table[k, j], table[row, j] = table[row, j], table[k, j]
        for i in range(size):
            table[i, k], table[i, column] = table[i, column], table[i, k]
        place[k], place[column] = place[column], place[k]
        for i in range(k + 1, size):
            part = table[i, k] / table[k, k]
            if part != 0.0:
                for j in range(k + 1, size + 1):
                    table[i, j] -= part * table[k, j]
    answer = np.empty(size)
    for k in range(size - 1, -1, -1):
        total = table[k, size]
        for j in range(k + 1, size):
            total -= table[k, j] * table[j, size]
        table[k, size] = total / table[k, k]
    for k in range(size):
        answer[place[k]] = table[k, size]
    for k in range(size):
        table[k, size] = answer[k]
    return True


@compiled
def newton(sides, start, which):
    """A hand that balances forces, of either sign, and touches all of the features (m,)."""
    m = len(which)
    n = len(sides.start)
    v = start.copy()
    force = np.zeros(m)
    if m > 4:
        return Solved(IRREGULAR, v, force)
    value = np.empty(m)
    normal = np.empty((m, 2))
    slope = np.empty((m, 4))
    put_gaps(sides, v, which, m, value, normal, slope)
    columns = np.empty((4, m))
    for k in range(m):
        for a in range(4):
            columns[a, k] = slope[k, a]
    wanted = np.zeros(4)
    wanted[2], wanted[3] = v[2], v[3]
    if least_squares(columns, np.arange(m), m, wanted, force) <= _REGULAR:
        return Solved(IRREGULAR, v, force)
    size = 4 + m
    table = np.empty((size, size + 1))
    for _ in range(STEPS):
        for i in range(size):
            for j in range(size):
                table[i, j] = 0.0
        table[2, 2] = table[3, 3] = 1.0
        for a in range(4):
            table[a, size] = 0.0
        table[2, size], table[3, size] = -v[2], -v[3]
        for k in range(m):
            f = which[k] // (2 * n)
            if which[k] % (2 * n) >= n:
                bend = force[k] / (sides.radius + value[k])
                for a in range(4):
                    one = normal[k, 0] * sides.maps[f, 1, a] - normal[k, 1] * sides.maps[f, 0, a]
                    for b in range(4):
                        other = (
                            normal[k, 0] * sides.maps[f, 1, b] - normal[k, 1] * sides.maps[f, 0, b]
                        )
                        table[a, b] -= bend * one * other
            for a in range(4):
                table[a, 4 + k] = -slope[k, a]
                table[4 + k, a] = slope[k, a]
                table[a, size] += slope[k, a] * force[k]
            table[4 + k, size] = -value[k]
        if not _solved(table, size):
            return Solved(IRREGULAR, v, force)
        longest = 0.0
        for a in range(4):
            longest = max(longest, abs(table[a, size]))
        if not longest < 0.5:
            return Solved(FAILED, v, force)
        for a in range(4):
            v[a] += table[a, size]
        for k in range(m):
            force[k] += table[4 + k, size]
        put_gaps(sides, v, which, m, value, normal, slope)
        if longest < 1e-14:
            break
    worst = 0.0
    for a in range(4):
        off = v[a] if a > 1 else 0.0
        for k in range(m):
            off -= slope[k, a] * force[k]
        worst = max(worst, abs(off))
    if worst > BALANCED * math.hypot(v[2], v[3]):
        return Solved(FAILED, v, force)
    for k in range(m):
        if not abs(value[k]) <= TOUCHES:
            return Solved(FAILED, v, force)
    return Solved(SOLVED, v, force)


@compiled
def _half_planes(sides, v, reach, slope, gap):
    """Slopes (m, 4) and gaps (m,) of the free half planes around the fingers of a hand; m.

    One for each nearest point of an edge that a finger is within ``reach`` of touching.
    """
    n = len(sides.start)
    count = 0
    for f in range(len(sides.maps)):
        px = 0.0
        py = 0.0
        for a in range(4):
            px += sides.maps[f, 0, a] * v[a]
            py += sides.maps[f, 1, a] * v[a]
        for q in range(n):
            x, y = px - sides.start[q, 0], py - sides.start[q, 1]
            t = x * sides.way[q, 0] + y * sides.way[q, 1]
            t = min(sides.length[q], max(0.0, t))
            x -= t * sides.way[q, 0]
            y -= t * sides.way[q, 1]
            far = math.sqrt(x * x + y * y)
            if 1e-9 < far < sides.radius + reach:
                for a in range(4):
                    slope[count, a] = (x * sides.maps[f, 0, a] + y * sides.maps[f, 1, a]) / far
                gap[count] = far - sides.radius
                count += 1
    return count


@compiled
def descend(sides, start, sigma, stride, most):
    """Steps of closing, at most so many, inside the half planes around the fingers; until at rest.

    The least |w|^2 + weight |step|^2 in them, a least-distance problem [Lawson1974]. No finger goes
    further than ``stride`` in a step. ``sigma`` is that before the first one.
    """
    v = start.copy()
    room = len(sides.start) * len(sides.maps)
    slope = np.empty((room, 4))
    gap = np.empty(room)
    scale = np.ones(4)
    scale[0] = scale[1] = 1.0 / math.sqrt(_LIGHT)
    aim = np.zeros(4)
    wanted = np.zeros(5)
    wanted[4] = 1.0
    rest = np.empty(5)
    step = np.empty(4)
    for done in range(most):
        count = _half_planes(sides, v, 3.0 * stride, slope, gap)
        if count == 0:
            return Descent(LOST, v, sigma, done)
        aim[2], aim[3] = -v[2], -v[3]  # of the step, without half planes
        # x = (step - aim) / scale: least |x| with slopes (aim + scale x) + gaps >= 0
        columns = np.empty((5, count))
        for k in range(count):
            last = gap[k]
            for a in range(4):
                columns[a, k] = slope[k, a] * scale[a]
                last += slope[k, a] * aim[a]
            columns[4, k] = -last
        pushed = pushing_of(columns, wanted)
        if pushed.miss < 1e-14:
            return Descent(LOST, v, sigma, done)
        for i in range(5):
            rest[i] = -wanted[i]
            for k in range(count):
                rest[i] += columns[i, k] * pushed.force[k]
        for a in range(4):
            step[a] = aim[a] - scale[a] * rest[a] / rest[4]
        longest = 0.0
        for f in range(len(sides.maps)):
            x = 0.0
            y = 0.0
            for a in range(4):
                x += sides.maps[f, 0, a] * step[a]
                y += sides.maps[f, 1, a] * step[a]
            longest = max(longest, math.hypot(x, y))
        part = min(1.0, stride / max(longest, 1e-300))
        for a in range(4):
            v[a] += part * step[a]
        now = math.hypot(v[2], v[3])
        stands = sigma - now < _STANDS
        sigma = now
        if stands:
            return Descent(STANDS, v, sigma, done + 1)
    return Descent(MOVING, v, sigma, most)
