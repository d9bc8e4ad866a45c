"""Forces on the fingers of a hand v = (d, w), and the directions that what pushes leaves.

A level at which the sublevel sets change has a hand whose forces balance: w = sum lambda_i grad g_i
with lambda_i >= 0 at the gaps g_i of the features that it touches. Our own.
[docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.hand import HandShape
from icage.kernels.forces import pushing_of

_PUSHES = 1e-9
"""[1] A force this small, over the largest, is none."""

_WEDGED = 1e6
"""[1] Forces beyond this, over the vector that they balance, come from rounding."""


def finger_maps(hand: HandShape) -> FloatArray:
    """Matrices (fingers, 2, 4) that take a hand v to the centre of each finger."""
    return np.array([[[1.0, 0.0, z.real, -z.imag], [0.0, 1.0, z.imag, z.real]] for z in hand.z])


def slope_of_half_square(v: FloatArray) -> FloatArray:
    """Derivative (4,) of w . w / 2, whose minima are those of sigma."""
    return np.array([0.0, 0.0, v[2], v[3]])


def pushing(columns: FloatArray, wanted: FloatArray) -> tuple[FloatArray, float]:
    """Forces >= 0 (k,) whose sum over columns (m, k) comes nearest to a vector, and the miss.

    The active set method of [Lawson1974], for a handful of columns.

    Examples
    --------
    >>> force, miss = pushing(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([2.0, -3.0]))
    >>> force.tolist(), miss
    ([2.0, 0.0], 3.0)
    """
    found = pushing_of(np.ascontiguousarray(columns), wanted)
    return found.force, found.miss


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
