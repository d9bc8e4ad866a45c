"""What is sought on a polygon of jams: the least sigma outside a tolerance, or the nearest hand."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.friction.kernels.far import least_far
from icage.friction.kernels.polygon import clip, finger_row
from icage.kernels.compiled import compiled

_CUTS = 120
"""Rounds of cuts; each takes a good third of what is left of the polygon."""

_LEFT = 1e-9
"""[1] What could be nearer by less (relative) is not looked for."""


class Goal(NamedTuple):
    """A hand (fingers, 2) to which jams under ``most`` [unit] are to be near, if ``asked``."""

    fingers: np.ndarray
    most: float
    asked: bool


@compiled
def cheapest(corners, n, near, goal, z, below, part, point):
    """Least sigma outside the tolerance, or least distance if the goal asks for it, at ``point``.

    ``part`` is room for a polygon. Returns inf where there is none under ``below``.
    """
    if not goal.asked:
        return least_far(corners, n, near, below, part, point)
    return _nearest(corners, n, goal, z, below, part, point)


@compiled
def _nearest(corners, n, goal, z, below, part, point):
    """Least of the largest finger's distance from the goal: cuts through the middle."""
    if n == 0:
        return np.inf
    left = np.empty((len(part), 4))
    left[:n] = corners[:n]
    row = np.empty(5)
    at = np.empty(4)
    away = np.empty((len(z), 2))
    best = below
    for _ in range(_CUTS):
        _middle(left, n, at)
        distance = 0.0
        for f in range(len(z)):
            away[f, 0] = at[0] + at[2] * z[f, 0] - at[3] * z[f, 1] - goal.fingers[f, 0]
            away[f, 1] = at[1] + at[2] * z[f, 1] + at[3] * z[f, 0] - goal.fingers[f, 1]
            distance = max(distance, np.hypot(away[f, 0], away[f, 1]))
        sigma = np.hypot(at[2], at[3])
        if sigma <= goal.most and distance < best:
            best = distance
            point[:] = at
        if sigma > goal.most:
            row[:] = 0.0
            row[2] = -at[2] / sigma
            row[3] = -at[3] / sigma
            row[4] = goal.most
            n = clip(left, n, row, part)
            left[:n] = part[:n]
        for f in range(len(z)):
            far = np.hypot(away[f, 0], away[f, 1])
            if n == 0 or far == 0.0:
                continue
            n_x = -away[f, 0] / far
            n_y = -away[f, 1] / far
            finger_row(row, n_x, n_y, z[f, 0], z[f, 1])
            row[4] = best * (1.0 - _LEFT) - n_x * goal.fingers[f, 0] - n_y * goal.fingers[f, 1]
            n = clip(left, n, row, part)
            left[:n] = part[:n]
        if n == 0:
            break
    return best if best < below else np.inf


@compiled
def _middle(corners, n, at):
    """The middle of a polygon's sides: many corners in one place do not pull it there."""
    at[:] = 0.0
    whole = 0.0
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        square = 0.0
        for c in range(4):
            square += (corners[b, c] - corners[a, c]) ** 2
        length = np.sqrt(square)
        whole += length
        for c in range(4):
            at[c] += 0.5 * length * (corners[a, c] + corners[b, c])
    if whole > 0.0:
        at /= whole
    else:
        at[:] = corners[0]
