"""Forces on the fingers of a hand v = (d, w), and the directions that what pushes leaves.

A level at which the sublevel sets change has a hand whose forces balance: w = sum lambda_i grad g_i
with lambda_i >= 0 at the gaps g_i of the features that it touches. Our own.
[docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.hand import HandShape

_PUSHES = 1e-9
"""[1] A force this small, over the largest, is none."""

_ROUNDING = 10.0 * float(np.finfo(np.float64).eps)
"""[1] A column that shortens the miss by less, over the size of all columns, does not help."""

_TURNS = 3
"""Columns that are taken up, over their number; more is going round in the circles of rounding."""

_APART = 1e-4
"""[1] Least over largest singular value of columns all of which may press at once. Of columns that
are nearly alike, as where an arc goes over into its edge, one is enough; taking them up one by one
finds that."""

_WEDGED = 1e6
"""[1] Forces beyond this, over the vector that they balance, come from rounding."""

_TINY = float(np.finfo(np.float64).tiny)


def finger_maps(hand: HandShape) -> FloatArray:
    """Matrices (fingers, 2, 4) that take a hand v to the centre of each finger."""
    return np.array([[[1.0, 0.0, z.real, -z.imag], [0.0, 1.0, z.imag, z.real]] for z in hand.z])


def slope_of_half_square(v: FloatArray) -> FloatArray:
    """Derivative (4,) of w . w / 2, whose minima are those of sigma."""
    return np.array([0.0, 0.0, v[2], v[3]])


def pushing(columns: FloatArray, wanted: FloatArray) -> tuple[FloatArray, float]:
    """Forces >= 0 (k,) whose sum over columns (m, k) comes nearest to a vector, and the miss.

    The active set method of [Lawson1974], for a handful of columns; scipy's takes as long to be
    loaded as a plan.

    Examples
    --------
    >>> force, miss = pushing(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([2.0, -3.0]))
    >>> force.tolist(), miss
    ([2.0, 0.0], 3.0)
    """
    count = columns.shape[1]
    force, off = np.zeros(count), wanted
    if not count:
        return force, float(np.linalg.norm(wanted))
    best, _, rank, size = np.linalg.lstsq(columns, wanted, rcond=None)
    apart = rank == count and size[-1] > _APART * size[0]
    if apart and best.min() > 0.0:  # all press: most often so, and nothing else to try
        return np.asarray(best, dtype=np.float64), float(np.linalg.norm(wanted - columns @ best))
    least = _ROUNDING * max(columns.shape) * float(np.abs(columns).sum(axis=0).max())
    pressing: list[int] = []
    for _ in range(_TURNS * count):
        helps = columns.T @ off
        helps[pressing] = 0.0
        most = int(np.argmax(helps))
        if not helps[most] > least:
            break
        pressing.append(most)
        pressing, force = _without_pulling(columns, wanted, pressing, force)
        off = wanted - columns @ force
    return force, float(np.linalg.norm(off))


def _without_pulling(
    columns: FloatArray, wanted: FloatArray, pressing: list[int], force: FloatArray
) -> tuple[list[int], FloatArray]:
    """Forces (k,) of the least miss, of those that press and would not pull then; which these are.

    From forces that do not pull straight to the best ones, as far as none pulls; who would pull
    first is left out.
    """
    while pressing:
        best = np.linalg.lstsq(columns[:, pressing], wanted, rcond=None)[0]
        found = np.zeros(len(force))
        if best.min() > 0.0:
            found[pressing] = best
            return pressing, found
        now = force[pressing]
        room = np.full(len(now), np.inf)
        pulls = best <= 0.0
        room[pulls] = now[pulls] / np.maximum(now - best, _TINY)[pulls]
        way = float(room.min())
        found[pressing] = now + way * (best - now)
        pressing = [k for k, r in zip(pressing, room, strict=True) if r > way]
        force = np.zeros(len(force))
        force[pressing] = found[pressing]
    return pressing, np.zeros(len(force))


def balanced(columns: FloatArray, wanted: FloatArray, within: float) -> FloatArray | None:
    """Forces >= 0 (k,) whose sum over columns is a vector; None if they miss it.

    ``within`` bounds the miss over the length of the vector. Walls that face each other across a
    finger balance anything by the rounding of their directions, with forces beyond all others:
    that is no balance.
    """
    force, miss = pushing(columns, wanted)
    size = float(np.linalg.norm(wanted))
    if miss > within * size or float(force.max(initial=0.0)) > _WEDGED * size:
        return None
    return force


def pushes(force: FloatArray) -> BoolArray:
    """Which forces (k,) are more than rounding of the largest."""
    return force > _PUSHES * np.abs(force).max()


def free_directions(slopes: FloatArray) -> FloatArray:
    """Unit directions (k, 4) along which none of the gaps with these slopes (m, 4) changes."""
    _, size, right = np.linalg.svd(slopes)
    return np.asarray(right[int((size > 1e-9 * size.max(initial=0.0)).sum()) :])
