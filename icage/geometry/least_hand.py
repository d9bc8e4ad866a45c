"""The smallest hand v = (d, w) in an intersection of half spaces, to rounding. Our own.

min |w|  s.t.  n_i . d + g_i . w >= c_i. Rows whose normals balance, sum lambda_i n_i = 0 with
lambda_i >= 0, leave half planes of w alone, and all that is known of w: two or three rows each.
Their point of least norm is w; the rows behind it say where d is.

Sums of a few numbers in an order of our own: libraries of linear algebra add in another one on
every number of threads, and the digits of a table would hang on the cores of a machine.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import combinations
from typing import Final

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray

_FEW: Final = 10
"""Rows that are looked at together; of more, those that the answer violates come in one by one."""

_OPPOSITE: Final = 1e-10
"""[rad] Normals this near to opposite are: they balance without a third."""

_MET: Final = 1e-12
"""[1] A row may be missed by this: rounding."""

_APART: Final = 1e-9
"""[rad] Normals nearer to parallel than this do not say where along them d is."""

_WRONG: Final = 1e-9
"""[1] Half planes that miss each other by more have no point in common."""


def least_hand(rows: FloatArray, levels: FloatArray, near: FloatArray) -> FloatArray | None:
    """The hand (4,) of least opening with ``rows @ v >= levels``, None if there is none.

    Where d is free, it is as near to ``near`` (2,) as it may be.

    Parameters
    ----------
    rows:
        (m, 4) n and g of each; the n are unit vectors.
    levels:
        (m,) of sizes about one.

    Examples
    --------
    Fingers at d, d + w and d + i w: left of x = 0, right of x = 1 and below y = -0.5.

    >>> rows = np.array([[-1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0], [0.0, -1.0, -1.0, 0.0]])
    >>> found = least_hand(rows, np.array([0.0, 1.0, 0.5]), np.zeros(2))
    >>> (found + 0.0).tolist()
    [0.0, -1.5, 1.0, 0.0]
    """
    count = len(levels)
    start = (rows[:, :2] * near).sum(axis=1) - levels
    held = np.sort(np.argsort(start, kind="stable")[:_FEW])
    for _ in range(count + 1):
        v = _least(rows[held], levels[held], near)
        if v is None or len(held) == count:
            return v
        slack = (rows * v).sum(axis=1) - levels
        slack[held] = np.inf
        worst = int(slack.argmin())
        if slack[worst] >= -_MET:
            return v
        held = np.append(held, worst)
    return None


def _least(rows: FloatArray, levels: FloatArray, near: FloatArray) -> FloatArray | None:
    n, g = rows[:, :2], rows[:, 2:]
    found = _least_w(n, g, levels)
    if found is None:
        return None
    w, behind = found
    d = _place(n, levels - (g * w).sum(axis=1), behind, near)
    return None if d is None else np.concatenate([d, w])


def _least_w(
    n: FloatArray, g: FloatArray, levels: FloatArray
) -> tuple[FloatArray, IntArray] | None:
    """The point w (2,) and the rows that hold it there."""
    weights, chosen = _balanced(n)
    way = (weights[:, :, None] * g[chosen]).sum(axis=1)
    level = (weights * levels[chosen]).sum(axis=1)
    size = np.hypot(way[:, 0], way[:, 1])
    empty = size <= _MET
    if bool((level[empty] > _WRONG).any()):
        return None
    way, level = way[~empty] / size[~empty, None], level[~empty] / size[~empty]
    found = least_norm(way, level)
    if found is None:
        return None
    w, tight = found
    behind = {int(k) for one in tight for k in chosen[~empty][one][weights[~empty][one] > 0.0]}
    return w, np.array(sorted(behind), dtype=np.int64)


def _balanced(n: FloatArray) -> tuple[FloatArray, IntArray]:
    """Weights (k, 3) and rows (k, 3) of unit normals (m, 2) that balance; a third of weight 0 is
    none.
    """
    pairs, triples = _choices(len(n))
    cross = n[:, None, 0] * n[None, :, 1] - n[:, None, 1] * n[None, :, 0]
    i, j = pairs.T
    opposite = (np.abs(cross[i, j]) <= _OPPOSITE) & ((n[i] * n[j]).sum(axis=1) < 0.0)
    two = np.column_stack([pairs, pairs[:, 0]])[opposite]
    i, j, k = triples.T
    turns = np.column_stack([cross[j, k], cross[k, i], cross[i, j]])
    turns = turns * np.where(turns[:, :1] < 0.0, -1.0, 1.0)
    largest = np.abs(turns).max(axis=1, initial=0.0)
    around = (turns > _MET * largest[:, None]).all(axis=1)
    weights = np.vstack([np.tile([1.0, 1.0, 0.0], (len(two), 1)), turns[around]])
    weights[len(two) :] /= largest[around, None]
    return weights, np.vstack([two, triples[around]])


@lru_cache(maxsize=_FEW * 4)
def _choices(count: int) -> tuple[IntArray, IntArray]:
    """All pairs (k, 2) and triples (k, 3) of so many rows."""

    def table(width: int) -> IntArray:
        flat = [k for one in combinations(range(count), width) for k in one]
        return np.array(flat, dtype=np.int64).reshape(-1, width)

    return table(2), table(3)


def _place(
    n: FloatArray, levels: FloatArray, behind: IntArray, near: FloatArray
) -> FloatArray | None:
    """The nearest d (2,) with n . d >= levels (m,), those ``behind`` w met exactly."""
    if not len(behind):
        found = least_norm(n, levels - (n * near).sum(axis=1))
        return None if found is None else near + found[0]
    m, c = n[behind], levels[behind]
    cross = m[:, None, 0] * m[None, :, 1] - m[:, None, 1] * m[None, :, 0]
    i, j = divmod(int(np.abs(cross).argmax()), len(m))
    if abs(cross[i, j]) > _APART:
        x = (c[i] * m[j, 1] - c[j] * m[i, 1]) / cross[i, j]
        y = (c[j] * m[i, 0] - c[i] * m[j, 0]) / cross[i, j]
        return np.array([x, y])
    foot, along = c[0] * m[0], np.array([-m[0, 1], m[0, 0]])
    slope, room = (n * along).sum(axis=1), levels - (n * foot).sum(axis=1)
    low = max((room[slope > _APART] / slope[slope > _APART]).tolist(), default=-np.inf)
    high = min((room[slope < -_APART] / slope[slope < -_APART]).tolist(), default=np.inf)
    if low > high + _WRONG:
        return None
    at = float((near * along).sum())
    return foot + min(max(at, low), max(low, high)) * along


def least_norm(ways: FloatArray, levels: FloatArray) -> tuple[FloatArray, list[int]] | None:
    """The point (2,) of least norm with way . p >= level for unit ways (k, 2), and which rows hold
    it there; None if there is none.

    One row after another, as in ``icage.cells.kernels.min_norm``: one that the point violates is
    tight at the next point, which lies on its line. [Seidel1991]

    >>> point, tight = least_norm(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([2.0, -1.0]))
    >>> point.tolist(), tight
    ([2.0, 0.0], [0])
    """
    order = np.argsort(-levels, kind="stable")
    ways, levels = ways[order], levels[order]
    p, tight = np.zeros(2), list[int]()
    for r, (way, level) in enumerate(zip(ways, levels, strict=True)):
        if way[0] * p[0] + way[1] * p[1] >= level - _MET:
            continue
        foot, along = level * way, np.array([-way[1], way[0]])
        slope = (ways[:r] * along).sum(axis=1)
        room = levels[:r] - (ways[:r] * foot).sum(axis=1)
        flat = np.abs(slope) <= _OPPOSITE
        if bool((room[flat] > _WRONG).any()):
            return None
        bounds = room / np.where(flat, 1.0, slope)
        low, at_low = _last(bounds, slope > _OPPOSITE)
        high, at_high = _last(-bounds, slope < -_OPPOSITE)
        high = -high
        if low > high + _WRONG:
            return None
        s, tight = 0.0, [r]
        if low > 0.0:
            s, tight = low, [r, at_low]
        elif high < 0.0:
            s, tight = high, [r, at_high]
        p = foot + s * along
    return p, [int(order[k]) for k in tight]


def _last(bounds: FloatArray, which: BoolArray) -> tuple[float, int]:
    """The largest bound where it is asked for, and its row; -inf and -1 without one."""
    if not bool(which.any()):
        return -np.inf, -1
    rows = np.flatnonzero(which)
    at = int(rows[int(bounds[rows].argmax())])
    return float(bounds[at]), at
