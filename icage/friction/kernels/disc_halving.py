"""What a bound on the jams of disc fingers depends on most, split in two.

A part of an arc that a finger is on, or a range of directions from a vertex whose arc a free finger
is held off. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.friction.kernels.disc_features import ARC
from icage.friction.kernels.disc_hands import OUTSIDE
from icage.kernels.compiled import compiled

_SHORT = 2e-10
"""[rad] Half the turn of a part of an arc that is halved no more."""

_NARROW = 1e-5
"""[rad] Half a range of directions from a vertex that is halved no more."""


@compiled
def halved(pieces, z, cell, subset, chosen, finger, count, contacts, state, point, thick, child):
    """Split what a bound depends on most into two ``child`` states; False if nothing matters.

    That is the longest part of an arc in contact, or the directions from a vertex whose arc a free
    finger is deeper in than that part is long.
    """
    widest = 0.0
    of = -1
    for k in range(count):
        if contacts.kind[chosen[k]] == ARC and state[finger[k], 1] > widest:
            widest = state[finger[k], 1]
            of = finger[k]
    deepest = 2.0 * thick
    if widest > _SHORT:
        deepest = max(deepest, contacts.radius * widest)
    deep = -1
    into = -1
    for f in range(len(z)):
        if subset[f]:
            continue
        x = point[0] + point[2] * z[f, 0] - point[3] * z[f, 1]
        y = point[1] + point[2] * z[f, 1] + point[3] * z[f, 0]
        for v in range(len(contacts.apex)):
            depth = contacts.radius - np.hypot(x - contacts.apex[v, 0], y - contacts.apex[v, 1])
            if depth > deepest and _room_for(state[f], v) >= 0:
                deepest = depth
                deep = f
                into = v
    if deep >= 0:
        k = _room_for(state[deep], into)
        if state[deep, 2 + 3 * k] < 0.0:
            state[deep, 2 + 3 * k] = into
            state[deep, 3 + 3 * k] = _away(pieces, cell[deep], contacts.apex[into])
            state[deep, 4 + 3 * k] = 0.5 * math.pi
        column = 3 + 3 * k
        row = deep
    elif widest > _SHORT:
        column = 0
        row = of
    else:
        return False
    half = 0.5 * state[row, column + 1]
    for k in range(2):
        child[k] = state
        child[k, row, column] += half if k else -half
        child[k, row, column + 1] = half
    return True


@compiled
def _room_for(state, v):
    """Where the state of a free finger has, or may take up, a vertex that it is held off; or -1."""
    free = -1
    for k in range(OUTSIDE):
        number = state[2 + 3 * k]
        if number == v:
            return k if state[4 + 3 * k] > _NARROW else -1
        if number < 0.0 and free < 0:
            free = k
    return free


@compiled
def _away(pieces, piece, apex):
    """A direction [rad] from a vertex inside the object, less than a quarter turn from all of a
    piece.
    """
    farthest = np.inf
    angle = 0.0
    for slot in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        v = pieces.slot_vertex[slot]
        n_x, n_y = pieces.normal_x[slot], pieces.normal_y[slot]
        inside = n_x * (apex[0] - pieces.x[v]) + n_y * (apex[1] - pieces.y[v])
        if inside < farthest:
            farthest = inside
            angle = math.atan2(n_y, n_x)
    return angle
