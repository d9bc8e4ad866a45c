"""A flood over a grid of hands (x, y, turn, sigma): sigma_max to about one step of the grid.

The size grows step by step. At each size every grid pose with no finger inside the object is free;
free neighbours are one component, also with the same pose one size below. The answer is the size at
which the component that holds the target also holds the outside. Our own; it needs no geometry but
a test of points, and is as good as its step: a passage narrower than a step may be missed (the
answer is too large) and a wall thinner than one be stepped through (too small).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from scipy import ndimage
from scipy.cluster.hierarchy import DisjointSet

from benchmarks.peers.question import Question

OUTSIDE = 0
"""The set of the outside, and the number of poses in collision in arrays of sets."""

NEIGHBOURS = np.ones((3, 3, 3), dtype=bool)
"""Poses one step away along any axes at once."""


@dataclass(frozen=True)
class Flooded:
    """The target is apart from the outside at the one size and joined to it at the next."""

    apart: float
    joined: float
    poses: int
    """Hands that were tested."""

    @property
    def sigma_max(self) -> float:
        """Middle of the two."""
        return 0.5 * (self.apart + self.joined)


def flood(question: Question, step: float) -> Flooded | None:
    """The level of escape on a grid; None if no size up to ``question.largest`` lets it out.

    ``step`` [diameter] is how far a finger moves from one grid pose to the next, along each axis,
    with the hand at its target's size. The target's own pose is on the grid.
    """
    h, reach = step * question.diameter, float(np.abs(question.arms).max())
    rise = h / reach
    turns = math.ceil(2.0 * math.pi * reach * question.sigma_0 / h)
    sets = DisjointSet([OUTSIDE])
    below: tuple[np.ndarray, tuple[int, int]] | None = None
    last, tested = OUTSIDE, 0
    steps_up = math.ceil((question.largest - question.sigma_0) / rise)
    for j in range(-math.floor(question.sigma_0 / rise), steps_up + 1):
        sigma = question.sigma_0 + (j + 0.5) * rise
        free, at = _free(question, sigma, h, turns)
        tested += free.size
        slices, found = ndimage.label(free, structure=NEIGHBOURS, output=np.int64)
        slices[slices > 0] += last
        for number in range(last + 1, last + found + 1):
            sets.add(number)
        last += found
        _join(sets, slices[:, :, 0], slices[:, :, -1])  # the last turn is next to the first
        # outside the box no finger can touch; and a hand of hardly any size is out by its size
        sets.merge(OUTSIDE, int(slices[0, 0, 0]))
        if below is None:
            for number in np.unique(slices[slices > 0]):
                sets.merge(OUTSIDE, int(number))
        else:
            smaller, was = below
            i, j0 = at[0] - was[0], at[1] - was[1]
            same = slices[i : i + smaller.shape[0], j0 : j0 + smaller.shape[1]]
            _join(sets, same, smaller)
        below = slices, at
        if j >= 0:
            target = int(slices[at[0], at[1], 0])
            if target and sets.connected(target, OUTSIDE):
                return Flooded(sigma - rise, sigma, tested)
    return None


def _free(
    question: Question, sigma: float, h: float, turns: int
) -> tuple[np.ndarray, tuple[int, int]]:
    """Which poses of one size are free (x, y, turn), and where the target's (turn 0) is."""
    low_x, low_y, high_x, high_y = question.obstacle.bounds
    x0, y0 = question.reference.real, question.reference.imag
    margin = sigma * float(np.abs(question.arms).max()) + 2.0 * h
    before = [math.ceil((p - low + margin) / h) for p, low in ((x0, low_x), (y0, low_y))]
    after = [math.ceil((high + margin - p) / h) for p, high in ((x0, high_x), (y0, high_y))]
    x = x0 + h * np.arange(-before[0], after[0] + 1)
    y = y0 + h * np.arange(-before[1], after[1] + 1)
    free = np.ones((len(x), len(y), turns), dtype=bool)
    for turn in range(turns):
        for arm in sigma * np.exp(2j * np.pi * turn / turns) * question.arms:
            near_x = (x + arm.real > low_x) & (x + arm.real < high_x)
            near_y = (y + arm.imag > low_y) & (y + arm.imag < high_y)
            px, py = x[near_x] + arm.real, y[near_y] + arm.imag
            inside = shapely.contains_xy(question.obstacle, px[:, None], py[None, :])
            free[np.ix_(near_x, near_y, [turn])] &= ~inside[:, :, None]
    return free, (before[0], before[1])


def _join(sets: DisjointSet, one: np.ndarray, other: np.ndarray) -> None:
    both = (one > 0) & (other > 0)
    one, other = one[both], other[both]
    if len(one):  # each pair once, as one number: rows would take ten times as long to sort
        base = int(other.max()) + 1
        for pair in np.unique(one * base + other).tolist():
            sets.merge(*divmod(pair, base))
