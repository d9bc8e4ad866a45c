"""The least sigma on a polygon of hands of disc fingers at which forces balance and squeeze.

Of the forces that add up to none (``rays``) every two, weighted so that their torques cancel, are
one balance. It squeezes if T_a P_b - T_b P_a < 0, with the torques T_a >= 0 >= T_b and powers P;
both are affine in the hand. Where both powers are negative that is so, where none is it is not.
Else a linear inequality bounds it from outside, and the polygon is halved until that makes no
difference. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.friction.kernels.disc_features import POWER, TORQUE
from icage.friction.kernels.goal import cheapest
from icage.friction.kernels.polygon import clip, least
from icage.kernels.compiled import compiled

HALVED = 24
"""How often a polygon is halved at most."""

_FINE = 1e-12
"""[1] A balance whose power is this little positive, over torques and powers, still squeezes."""


@compiled
def least_balanced(n, z, ray, m, near, goal, below, loose_torque, loose_power, room, point):
    """Least sigma, or distance from the goal, of the ``n`` corners of ``room.polygon``, if that is
    under ``below``; else inf.

    ``ray`` has m rows; their torques and powers may be off by as much as is ``loose``.
    """
    polygon = room.polygon
    low, high = room.low, room.high
    up = False
    down = False
    squeezes = False
    for a in range(m):
        low[a, 0] = np.inf
        high[a, 0] = -np.inf
        low[a, 1] = np.inf
        high[a, 1] = -np.inf
        for k in range(n):
            torque = _torque(ray[a], polygon[k])
            power = _power(ray[a], polygon[k])
            low[a, 0] = min(low[a, 0], torque)
            high[a, 0] = max(high[a, 0], torque)
            low[a, 1] = min(low[a, 1], power)
            high[a, 1] = max(high[a, 1], power)
        up = up or high[a, 0] >= -loose_torque
        down = down or low[a, 0] <= loose_torque
        squeezes = squeezes or low[a, 1] < loose_power
    if not (up and down and squeezes):
        return np.inf
    best = below
    for a in range(m):
        if high[a, 0] < -loose_torque:
            continue
        one = _clipped(polygon, n, ray[a], 1.0, loose_torque, room.row, room.one)
        if one == 0 or (not goal.asked and least(room.one, one, room.some) >= best):
            continue
        for b in range(m):
            if low[b, 0] > loose_torque:
                continue
            if low[a, 1] >= loose_power and low[b, 1] >= loose_power:
                continue
            both = _clipped(room.one, one, ray[b], -1.0, loose_torque, room.row, room.halves[0])
            if both == 0:
                continue
            if a == b:  # alone: no torque, and negative power
                room.row[:] = 0.0
                room.row[2] = -ray[a, POWER]
                room.row[3] = -ray[a, POWER + 1]
                room.row[4] = loose_power
                both = clip(room.halves[0], both, room.row, room.half)
                sigma = cheapest(room.half, both, near, goal, z, best, room.spare, room.some)
            elif high[a, 1] < 0.0 and high[b, 1] < 0.0:
                sigma = cheapest(room.halves[0], both, near, goal, z, best, room.spare, room.some)
            else:
                sigma = _least_squeezing(
                    both, z, ray[a], ray[b], near, goal, best, loose_torque, loose_power, room
                )
            if sigma < best:
                best = sigma
                point[:] = room.some
    return best if best < below else np.inf


@compiled
def _torque(ray, hand):
    value = ray[TORQUE + 4]
    for c in range(4):
        value += ray[TORQUE + c] * hand[c]
    return value


@compiled
def _power(ray, hand):
    return ray[POWER] * hand[2] + ray[POWER + 1] * hand[3]


@compiled
def _clipped(corners, n, ray, sign, loose, row, kept):
    """Keep the hands with torques of this sign."""
    for c in range(5):
        row[c] = sign * ray[TORQUE + c]
    row[4] += loose
    return clip(corners, n, row, kept)


@compiled
def _least_squeezing(n, z, a, b, near, goal, below, loose_torque, loose_power, room):
    """The same on ``room.halves[0]`` where both balances together squeeze, at ``room.some``."""
    sizes, depth = room.sizes, room.depth
    row, found = room.row, room.found
    best = below
    sizes[0] = n
    depth[0] = 0
    top = 1
    while top:
        top -= 1
        n = sizes[top]
        corners = room.halves[top]
        least_a = np.inf
        least_b = np.inf
        for k in range(n):
            least_a = min(least_a, _power(a, corners[k]))
            least_b = min(least_b, _power(b, corners[k]))
        # T_a P_b - T_b P_a <= 0, from outside: every power at its least, every torque off
        _squeezing_row(row, a, b, least_a - loose_power, least_b - loose_power, loose_torque)
        n = clip(corners, n, row, room.half)
        sigma = cheapest(room.half, n, near, goal, z, best, room.spare, found)
        if sigma >= best:
            continue
        power_a = _power(a, found) - loose_power
        power_b = _power(b, found) - loose_power
        _squeezing_row(row, a, b, power_a, power_b, loose_torque)
        miss = row[4]
        for c in range(4):
            miss += row[c] * found[c]
        scale = abs(_torque(a, found) * power_b) + abs(_torque(b, found) * power_a)
        if miss >= -_FINE * scale or depth[top] >= HALVED or top + 2 > len(sizes):
            best = sigma
            room.some[:] = found
            continue
        if not _halving_row(row, room.half, n):
            best = sigma
            room.some[:] = found
            continue
        level = depth[top] + 1
        for _side in range(2):
            m = clip(room.half, n, row, room.halves[top])
            for c in range(5):
                row[c] = -row[c]
            if m:
                sizes[top] = m
                depth[top] = level
                top += 1
    return best if best < below else np.inf


@compiled
def _squeezing_row(row, a, b, power_a, power_b, loose):
    """The half space T_a P_b - T_b P_a <= 0 for given powers, torques off to the safe side."""
    for c in range(5):
        row[c] = b[TORQUE + c] * power_a - a[TORQUE + c] * power_b
    row[4] += loose * (abs(power_a) + abs(power_b))


@compiled
def _halving_row(row, corners, n):
    """The half space through the middle of the longest extent of w; False if that is nothing."""
    longest = 0.0
    for k in range(n):
        for i in range(k):
            x = corners[k, 2] - corners[i, 2]
            y = corners[k, 3] - corners[i, 3]
            if x * x + y * y > longest:
                longest = x * x + y * y
                row[2] = x
                row[3] = y
                row[4] = -0.5 * (
                    x * (corners[k, 2] + corners[i, 2]) + y * (corners[k, 3] + corners[i, 3])
                )
    row[0] = 0.0
    row[1] = 0.0
    return longest > 0.0
