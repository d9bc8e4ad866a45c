"""Which vertices of a ring carry no corner."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled


@compiled
def _straight(x, y, first, start, count, bound):
    """Whether ``count`` vertices from ``start`` lead from vertex ``first`` on a straight line."""
    n = len(x)
    last = (start + count - 1) % n
    sx = x[last] - x[first]
    sy = y[last] - y[first]
    length = np.hypot(sx, sy)
    before = 0.0
    for k in range(count - 1):
        px = x[(start + k) % n] - x[first]
        py = y[(start + k) % n] - y[first]
        if length <= bound:
            if np.hypot(px, py) > bound:
                return False
            continue
        along = (px * sx + py * sy) / length
        if abs(py * sx - px * sy) > bound * length or along < before - bound:
            return False
        before = along
    return length <= bound or length >= before - bound


@compiled
def sharpest(x, y, bound):
    """The vertex that is furthest off the chord of its neighbours, times that chord, and if all are
    kept: each is further off than ``bound``, or the ring turns back there, and no edge is shorter.
    """
    n = len(x)
    found, most = 0, -1.0
    every = True
    for k in range(n):
        before, after = k - 1, (k + 1) % n
        px, py = x[k] - x[before], y[k] - y[before]
        sx, sy = x[after] - x[before], y[after] - y[before]
        off = abs(sx * py - sy * px)
        back = px * (x[after] - x[k]) + py * (y[after] - y[k]) < 0.0
        sharp = off > bound * np.hypot(sx, sy) or back
        if not sharp or np.hypot(px, py) <= bound:
            every = False
            off = 0.0
        if off > most:
            found, most = k, off
    return found, every


@compiled
def corners(x, y, begin, bound):
    """Marks (n,) of the vertices to keep: the others lie within ``bound`` of the kept ones' chords.

    ``begin`` is a vertex that is kept for certain. Greedy: a run grows while it stays straight.
    """
    n = len(x)
    keep = np.zeros(n, np.bool_)
    keep[begin] = True
    last = begin
    start = (begin + 1) % n
    count = 0
    for step in range(1, n + 1):
        count += 1
        if not _straight(x, y, last, start, count, bound):
            last = (begin + step - 1) % n
            keep[last] = True
            start = (begin + step) % n
            count = 1
    return keep
