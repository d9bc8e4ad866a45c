"""Which hands may be: the limits of a real hand, asked of three contacts."""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled


class HandLimits(NamedTuple):
    """What a hand on three contacts has to be like.

    Attributes
    ----------
    least_distance:
        [unit] Between two finger centres.
    least_angle:
        [rad] Of its triangle.
    widest:
        [1] Longest over shortest side.
    sigma_least, sigma_most:
        [unit] Its sigma on the contacts is at least the one and less than the other.
    phi_1, phi_2, within:
        [rad] The wanted shape, read from any finger; any shape if ``within`` is inf.
    """

    least_distance: float
    least_angle: float
    widest: float
    sigma_least: float
    sigma_most: float
    phi_1: float
    phi_2: float
    within: float

    @classmethod
    def apart(cls, least_distance: float, widest: float = math.inf) -> HandLimits:
        """Any hand whose fingers are so far apart."""
        return cls(least_distance, 0.0, widest, 0.0, math.inf, 0.0, 0.0, math.inf)


_FLATTEST = 0.05
"""[1] Least height over longest side of any hand that is searched."""


@compiled
def first_finger(x, y, limits):
    """Which of three counterclockwise contacts is finger 1 (0..2), and whether the hand may be: -1.

    Where a shape is wanted, the reading that is nearest to it; else the longest side is the one
    between fingers 1 and 2, which is sigma.
    """
    side = np.empty(3)
    angle = np.empty(3)
    for k in range(3):
        h = (k + 1) % 3
        side[k] = np.hypot(x[h] - x[k], y[h] - y[k])
    longest = max(side[0], side[1], side[2])
    shortest = min(side[0], side[1], side[2])
    if shortest < limits.least_distance or longest > limits.widest * shortest:
        return -1
    for k in range(3):
        h = (k + 1) % 3
        g = (k + 2) % 3
        ax, ay, bx, by = x[h] - x[k], y[h] - y[k], x[g] - x[k], y[g] - y[k]
        angle[k] = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        if angle[k] < limits.least_angle or ax * by - ay * bx < _FLATTEST * longest * longest:
            return -1
    first = 0
    if limits.within < np.inf:
        least = np.inf
        for k in range(3):
            off = max(
                abs(angle[k] - limits.phi_1), abs(math.pi - angle[(k + 1) % 3] - limits.phi_2)
            )
            if off < least:
                least, first = off, k
        if least > limits.within:
            return -1
    else:
        for k in range(3):
            if side[k] > side[first] * (1.0 + 1e-9):
                first = k
    if not limits.sigma_least <= side[first] < limits.sigma_most:
        return -1
    return first


@compiled
def touches(x, y, segments, reach):
    """Whether a finger on (x, y) is within ``reach`` of one of the segments (n, 4) x, y, x, y."""
    for k in range(len(segments)):
        ax, ay = segments[k, 0], segments[k, 1]
        sx, sy = segments[k, 2] - ax, segments[k, 3] - ay
        length = max(sx * sx + sy * sy, 1e-300)
        t = min(1.0, max(0.0, ((x - ax) * sx + (y - ay) * sy) / length))
        if np.hypot(ax + t * sx - x, ay + t * sy - y) <= reach:
            return True
    return False
