"""Hexagonal bins of points in the plane, with a rate in each. Our own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Hexagons:
    """Bins (k): centres (k, 2), trials (k,) and how many of them were hits (k,).

    ``width`` is from flat side to flat side, in the unit of the points; ``which`` (n,) the bin of
    each of them.
    """

    width: float
    centres: FloatArray
    trials: IntArray
    hits: IntArray
    which: IntArray

    @property
    def corners(self) -> FloatArray:
        """Corners (k, 6, 2) of the bins."""
        turn = np.exp(1j * np.pi * (np.arange(6) / 3.0 + 0.5)) * self.width / np.sqrt(3.0)
        return self.centres[:, None] + np.column_stack([turn.real, turn.imag])

    def holding(self, some: BoolArray) -> BoolArray:
        """Which bins (k,) hold any of some of the points (n,)."""
        return np.bincount(self.which[some], minlength=len(self.trials)) > 0


def bin_hexagons(points: FloatArray, hits: BoolArray, width: float) -> Hexagons:
    """Bins of points (n, 2), each a hit or not (n,); only bins that hold a point.

    The centres form two rectangular grids, shifted by half a cell: a point belongs to the nearest
    centre of both.

    >>> one = bin_hexagons(np.array([[0.0, 0.0], [0.1, 0.0], [5.0, 0.0]]), np.array([1, 0, 1]), 1.0)
    >>> one.trials.tolist(), one.hits.tolist()
    ([2, 1], [1, 1])
    """
    cell = width * np.array([1.0, np.sqrt(3.0)])
    nearest = [np.round(points / cell + shift) - shift for shift in (0.0, 0.5)]
    far = [np.hypot(*(points - at * cell).T) for at in nearest]
    # twice the place is a whole number: even on the first grid, odd on the second
    at = np.where((far[0] <= far[1])[:, None], *nearest)
    places, which = np.unique(np.round(2.0 * at).astype(np.int64), axis=0, return_inverse=True)
    which = which.reshape(-1)
    trials = np.bincount(which, minlength=len(places))
    found = np.bincount(which, weights=np.asarray(hits, dtype=np.float64), minlength=len(places))
    return Hexagons(width, 0.5 * places * cell, trials, found.astype(np.int64), which)
