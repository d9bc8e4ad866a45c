"""A placement made better until its distances balance: linear steps that only ever gain.

Every step moves no finger further than the clearance it has, so that no finger meets the object on
the way and the hand stays in its component. Our own. [docs/theory.md, Sec. 11]
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled_borrowing
from icage.placing.kernels.boxes import clearance, distance_rows, place_finger
from icage.placing.kernels.program import UNKNOWNS, most_of_least

SIZE = 3
"""The last coordinate of a hand."""

_STEPS = 300
"""Tries at most."""

_SHORTEST = 1e-14
"""[diameter] Steps shorter than this are rounding."""

_NARROWER = 0.3
"""[1] The next step's length after one that gained nothing."""


@compiled_borrowing
def capped(clear, sigma, level, share):
    """The tolerance of a hand with this clearance: capped by the level if the opening errs."""
    return min(clear, share * (level - sigma)) if share > 0.0 else clear


@compiled_borrowing
def level_row(program, rows, level, share, middle, half):
    """The row of the cap; returns how many rows there are then."""
    program.counts[rows] = 1.0
    program.offset[rows] = share * (level - middle[3])
    for j in range(UNKNOWNS):
        program.slope[rows, j] = -share * half[3] if j == SIZE else 0.0
    return rows + 1


@compiled_borrowing
def polish(asked, every, hand, value, program, room):
    """Move a hand (4,) of this tolerance to a better one near by; returns its tolerance.

    ``every`` (fingers,) names the list of all edges for each finger.
    """
    middle, half, other = room.middle, room.half, room.other
    arm, edges, near = asked.arm, asked.edges, asked.near
    longest = 0.0
    for k in range(len(arm)):
        longest = max(longest, np.hypot(arm[k, 0], arm[k, 1]))
    clear = clearance(edges, near, every, arm, asked.radius, hand, room.finger)
    if clear <= 0.0:
        return value
    step = 0.25 * clear
    for _ in range(_STEPS):
        if step < _SHORTEST * asked.size:
            break
        half[0] = step
        half[1] = step
        half[2] = step / (longest * hand[3])
        low = max(asked.least, hand[3] - step / longest)
        high = min(asked.top, hand[3] + step / longest)
        half[3] = max(0.0, 0.5 * (high - low))
        for j in range(UNKNOWNS):
            middle[j] = hand[j]
        middle[SIZE] = low + half[SIZE]
        rows = distance_rows(
            program, 0, edges, near, every, arm, asked.radius, middle, half, True, room.finger,
            room.pick,
        )  # fmt: skip
        if asked.share > 0.0:
            rows = level_row(program, rows, asked.level, asked.share, middle, half)
        most_of_least(program, rows, -np.inf)
        for j in range(4):
            other[j] = middle[j] + program.at[j] * half[j]
        other[3] = min(asked.top, max(asked.least, other[3]))
        moved = 0.0
        for k in range(len(arm)):
            place_finger(arm, k, hand, room.finger)
            x = room.finger[0]
            y = room.finger[1]
            place_finger(arm, k, other, room.finger)
            moved = max(moved, np.hypot(room.finger[0] - x, room.finger[1] - y))
        found = clearance(edges, near, every, arm, asked.radius, other, room.finger)
        better = capped(found, other[3], asked.level, asked.share)
        if better > value and moved < clear:
            value = better
            clear = found
            for j in range(4):
                hand[j] = other[j]
        else:
            step *= _NARROWER
    return value
