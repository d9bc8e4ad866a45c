"""Which hands are so near to another one that closing is said to have ended there. Our own."""

from __future__ import annotations

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.tolerance import NEAR_POSITION, NEAR_TURN


def are_beside(hands: FloatArray, other: FloatArray, diameter: float) -> BoolArray:
    """Which hands (k, fingers, 2) are as near to another (fingers, 2) as jams that are the target.

    Examples
    --------
    >>> hand = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]])
    >>> are_beside(np.stack([hand, hand + 0.003, hand + 0.01]), hand, 1.0).tolist()
    [True, True, False]
    """
    off = hands.mean(axis=1) - other.mean(axis=0)
    side, own = hands[:, 1] - hands[:, 0], other[1] - other[0]
    turn = np.arctan2(
        own[0] * side[:, 1] - own[1] * side[:, 0], own[0] * side[:, 0] + own[1] * side[:, 1]
    )
    near = np.hypot(off[:, 0], off[:, 1]) <= NEAR_POSITION * diameter
    return near & (np.abs(turn) <= NEAR_TURN)
