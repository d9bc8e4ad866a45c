"""Largest distance between two of some points."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

_ROUNDING = 1e-9
"""[1] Points are compared if they may be the furthest but for this much."""


@compiled_borrowing
def _furthest(x, y, from_x, from_y):
    """The point that is furthest from a place, and the square of how far it is."""
    found, most = 0, -1.0
    for k in range(len(x)):
        off_x, off_y = x[k] - from_x, y[k] - from_y
        square = off_x * off_x + off_y * off_y
        if square > most:
            found, most = k, square
    return found, most


@compiled
def largest_square(x, y):
    """The square of the largest distance between two points.

    All pairs whose distances from the middle say that they may have it: half of all pairs at most.
    """
    n = len(x)
    middle_x, middle_y = 0.5 * (x.min() + x.max()), 0.5 * (y.min() + y.max())
    start, reach = _furthest(x, y, middle_x, middle_y)
    reach = np.sqrt(reach)
    least = np.sqrt(_furthest(x, y, x[start], y[start])[1]) * (1.0 - _ROUNDING)
    near = np.empty(n, np.int64)
    count = 0
    largest = 0.0
    for k in range(n):
        off_x, off_y = x[k] - middle_x, y[k] - middle_y
        if np.sqrt(off_x * off_x + off_y * off_y) + reach < least:
            continue
        for c in range(count):
            off_x, off_y = x[k] - x[near[c]], y[k] - y[near[c]]
            largest = max(largest, off_x * off_x + off_y * off_y)
        near[count] = k
        count += 1
    return largest
