"""The least sigma on a convex polygon of hands, of those that are not within the tolerance.

The hands outside the tolerance are no convex set, but a union of such: those turned too far one
way or the other (two half planes of w, exactly), and those whose middle is out of a disc. The
outside of a disc is covered by half planes that cut a little into it, and those that matter are
split until it is no more than rounding. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.friction.kernels.polygon import clip, finger_row, least
from icage.kernels.compiled import compiled

_SECTORS = 16
"""Half planes round the disc to begin with."""

_DEEPEST = 40
"""Splits of a sector: far more than the depth of its cut allows."""

_EDGE = 1e-9
"""[1] A hand this near to the edge of the tolerance is outside of it."""


class Near(NamedTuple):
    """The hands that count as the target. Lengths in the object's unit.

    The middle of the fingers, at ``mid`` of the unit hand, within ``reach`` of ``at``; the
    direction of w within ``turn`` [rad] of the unit vector ``ahead``. ``fine`` [unit]: how far the
    cover of the disc's outside may cut into it. An infinite ``reach`` or ``turn`` asks nothing;
    another ``turn`` is less than a quarter turn.
    """

    at_x: float
    at_y: float
    reach: float
    ahead_x: float
    ahead_y: float
    turn: float
    mid_x: float
    mid_y: float
    fine: float


@compiled
def is_far(q, near):
    """Whether a hand (4,) is outside the tolerance."""
    x = q[0] + q[2] * near.mid_x - q[3] * near.mid_y - near.at_x
    y = q[1] + q[2] * near.mid_y + q[3] * near.mid_x - near.at_y
    if np.hypot(x, y) >= near.reach * (1.0 - _EDGE):
        return True
    across = near.ahead_x * q[3] - near.ahead_y * q[2]
    along = near.ahead_x * q[2] + near.ahead_y * q[3]
    return abs(math.atan2(across, along)) >= near.turn * (1.0 - _EDGE)


@compiled
def least_far(corners, n, near, below, part, point):
    """Least sigma on the polygon outside the tolerance, at ``point``, if it is under ``below``.

    ``part`` is room for a polygon. Returns inf where there is none.
    """
    found = np.empty(4)
    sigma = least(corners, n, found)
    if sigma >= below:
        return np.inf
    if is_far(found, near):
        point[:] = found
        return sigma
    best = below
    row = np.zeros(5)
    for way in (-1.0, 1.0):
        if np.isinf(near.turn):
            break
        # w turned by more than ``turn`` that way: cross(edge of the sector, w) of that sign
        c = math.cos(near.turn)
        s = way * math.sin(near.turn)
        edge_x = near.ahead_x * c - near.ahead_y * s
        edge_y = near.ahead_x * s + near.ahead_y * c
        row[:] = 0.0
        row[2] = -way * edge_y
        row[3] = way * edge_x
        m = clip(corners, n, row, part)
        sigma = least(part, m, found)
        if sigma < best:
            best = sigma
            point[:] = found
    if np.isinf(near.reach):
        return best if best < below else np.inf
    stack = np.empty((_SECTORS + _DEEPEST, 2))
    half = math.pi / _SECTORS
    for k in range(_SECTORS):
        stack[k, 0] = 2.0 * half * k
        stack[k, 1] = half
    top = _SECTORS
    while top:
        top -= 1
        middle = stack[top, 0]
        half = stack[top, 1]
        n_x = math.cos(middle)
        n_y = math.sin(middle)
        finger_row(row, n_x, n_y, near.mid_x, near.mid_y)
        row[4] = -n_x * near.at_x - n_y * near.at_y - near.reach * math.cos(half)
        m = clip(corners, n, row, part)
        sigma = least(part, m, found)
        if sigma >= best - near.fine:
            continue
        # 2 sin^2(half / 2) = 1 - cos(half), without cancellation
        cut = 2.0 * near.reach * math.sin(0.5 * half) ** 2
        if is_far(found, near) or cut <= near.fine or top + 2 > len(stack):
            best = sigma
            point[:] = found
            continue
        stack[top, 0] = middle - 0.5 * half
        stack[top, 1] = 0.5 * half
        stack[top + 1, 0] = middle + 0.5 * half
        stack[top + 1, 1] = 0.5 * half
        top += 2
    return best if best < below else np.inf
