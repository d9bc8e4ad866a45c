"""Which features of an outline the fingers of a hand touch, and the gaps that these leave.

A feature is a number: that of the finger times 2 n, and of n edges the edge or, beyond them, the
vertex. Hands are v = (d, w); lengths are in diameters.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.forces import pushing_of
from icage.kernels.storage import longer


class Sides(NamedTuple):
    """An outline of n edges, as ``icage.discs.edges.Edges``, and the fingers that touch it.

    ``maps`` (fingers, 2, 4) take a hand to the fingers' centres.
    """

    start: np.ndarray
    length: np.ndarray
    way: np.ndarray
    out: np.ndarray
    convex: np.ndarray
    maps: np.ndarray
    radius: float


class Felt(NamedTuple):
    """The features (m,) near a hand, their gaps (m,), and the forces (m,) that push there best."""

    which: np.ndarray
    gap: np.ndarray
    force: np.ndarray


@compiled
def _put_near(sides, v, reach, beyond, near):
    """Put the features within ``reach``, and ``beyond`` their ends, into ``near``; how many."""
    n = len(sides.start)
    count = 0
    low = max(0.0, sides.radius - reach)
    high = sides.radius + reach
    for f in range(len(sides.maps)):
        px = 0.0
        py = 0.0
        for a in range(4):
            px += sides.maps[f, 0, a] * v[a]
            py += sides.maps[f, 1, a] * v[a]
        for q in range(n):
            x, y = px - sides.start[q, 0], py - sides.start[q, 1]
            gap = x * sides.out[q, 0] + y * sides.out[q, 1] - sides.radius
            if abs(gap) <= reach:
                along = x * sides.way[q, 0] + y * sides.way[q, 1]
                if along >= -beyond and along - sides.length[q] <= beyond:
                    near[count] = 2 * n * f + q
                    count += 1
        for q in range(n):
            if not sides.convex[q]:
                continue
            x, y = px - sides.start[q, 0], py - sides.start[q, 1]
            far = math.sqrt(x * x + y * y)
            if low <= far <= high and x * sides.way[q, 0] + y * sides.way[q, 1] <= beyond:
                p = q - 1 if q > 0 else n - 1
                x, y = px - sides.start[p, 0], py - sides.start[p, 1]
                past_end = x * sides.way[p, 0] + y * sides.way[p, 1] - sides.length[p]
                if past_end >= -beyond:
                    near[count] = 2 * n * f + n + q
                    count += 1
    return count


@compiled
def near_features(sides, v, reach, beyond):
    """Features (m,), ascending, within ``reach`` of being touched by a hand (4,)."""
    near = np.empty(2 * len(sides.start) * len(sides.maps), np.int64)
    count = _put_near(sides, v, reach, beyond, near)
    return near[:count].copy()


@compiled
def put_gaps(sides, v, which, count, value, normal, slope):
    """Gaps (count,) of features, their unit normals (count, 2) and derivatives by v (count, 4)."""
    n = len(sides.start)
    for k in range(count):
        f = which[k] // (2 * n)
        q = which[k] % (2 * n)
        is_arc = q >= n
        if is_arc:
            q -= n
        x = -sides.start[q, 0]
        y = -sides.start[q, 1]
        for a in range(4):
            x += sides.maps[f, 0, a] * v[a]
            y += sides.maps[f, 1, a] * v[a]
        if is_arc:
            far = max(math.hypot(x, y), 1e-300)
            nx, ny = x / far, y / far
        else:
            nx, ny = sides.out[q, 0], sides.out[q, 1]
        value[k] = nx * x + ny * y - sides.radius
        normal[k, 0], normal[k, 1] = nx, ny
        for a in range(4):
            slope[k, a] = nx * sides.maps[f, 0, a] + ny * sides.maps[f, 1, a]


@compiled
def _fingers_of(sides, which, count):
    """How many fingers features (count,), ascending, belong to."""
    n = len(sides.start)
    fingers = 0
    last = -1
    for k in range(count):
        f = which[k] // (2 * n)
        if f != last:
            fingers += 1
            last = f
    return fingers


@compiled
def _pushing_at(sides, v, which, count):
    """Gaps (count,) of features, and the forces along their normals that push w best."""
    value = np.empty(count)
    normal = np.empty((count, 2))
    slope = np.empty((count, 4))
    put_gaps(sides, v, which, count, value, normal, slope)
    columns = np.empty((4, count))
    for k in range(count):
        for a in range(4):
            columns[a, k] = slope[k, a]
    wanted = np.zeros(4)
    wanted[2], wanted[3] = v[2], v[3]
    return value, pushing_of(columns, wanted)


@compiled
def felt(sides, v, reach):
    """What a hand (4,) feels of the features within ``reach``; nothing if of one finger only."""
    near = np.empty(2 * len(sides.start) * len(sides.maps), np.int64)
    count = _put_near(sides, v, reach, reach, near)
    if _fingers_of(sides, near, count) < 2:
        count = 0
    value, pushed = _pushing_at(sides, v, near, count)
    return Felt(near[:count].copy(), value, pushed.force)


@compiled
def nearly_balanced(sides, hands, reach, share):
    """Rows of hands (k, 4) whose forces miss balance by at most this ``share`` of their size.

    Of hands that touch the same features, to within ``reach``, only the first is looked at.
    """
    mask = 1023
    while mask < 2 * len(hands):
        mask = 2 * mask + 1
    table = np.full(mask + 1, -1, np.int64)
    first = np.empty(len(hands) + 1, np.int64)
    held = np.empty((1024, 1), np.int64)
    near = np.empty(2 * len(sides.start) * len(sides.maps), np.int64)
    rows = np.empty(len(hands), np.int64)
    kinds = 0
    found = 0
    first[0] = 0
    for row in range(len(hands)):
        v = hands[row]
        count = _put_near(sides, v, reach, 0.0, near)
        if _fingers_of(sides, near, count) < 2:
            continue
        at = count
        for k in range(count):
            at = (at * 31 + near[k]) & 0xFFFFFFFF
        at = (at ^ (at >> 15)) & mask
        known = False
        while table[at] >= 0 and not known:
            kind = table[at]
            known = first[kind + 1] - first[kind] == count
            for k in range(count):
                if not known:
                    break
                known = held[first[kind] + k, 0] == near[k]
            at = (at + 1) & mask
        if known:
            continue
        table[at] = kinds
        while first[kinds] + count > len(held):
            held = longer(held)
        for k in range(count):
            held[first[kinds] + k, 0] = near[k]
        kinds += 1
        first[kinds] = first[kinds - 1] + count
        _, pushed = _pushing_at(sides, v, near, count)
        if pushed.miss <= share * math.hypot(v[2], v[3]):
            rows[found] = row
            found += 1
    return rows[:found].copy()
