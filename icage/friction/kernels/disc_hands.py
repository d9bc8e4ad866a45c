"""The hands of disc fingers on chosen features, as a convex polygon that leaves none out.

Parts of arcs stand as their chords. A hand on the true arcs differs from one on the chords by no
more than their sagittas allow (``Slack``), and all that bounds the polygon is moved back by that.
[docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.friction.kernels.disc_features import ARC
from icage.friction.kernels.polygon import (
    finger_row,
    keep,
    keep_in_piece,
    keep_near,
    put_hands_of_two,
)
from icage.kernels.compiled import compiled

OUTSIDE = 3
"""Vertices that one free finger may be held off."""

_ON = 0.02
"""[1] How far a finger may be off its feature, over how far off its piece: features are those of
the true curve, pieces have lost the vertices that hardly turn."""

COLUMNS = 2 + 3 * OUTSIDE
"""Columns of the state of a finger: direction and half turn of its part of an arc; then, for each
vertex that it is held off, the number of that (-1: none), and a range of directions from it."""


class Slack(NamedTuple):
    """How far a hand on the true arcs may be from one on the chords.

    ``sag`` [unit]: both first fingers together; ``shift`` [unit]: any finger; ``w``: of w.
    """

    sag: float
    shift: float
    w: float


@compiled
def slack_of(z, finger, chosen, contacts, state):
    """The slack of the first two fingers in contact, from which the hand is built."""
    i, j = finger[0], finger[1]
    side_x = z[j, 0] - z[i, 0]
    side_y = z[j, 1] - z[i, 1]
    side = np.hypot(side_x, side_y)
    sag = 0.0
    for k in range(2):
        sag += sagitta(contacts, chosen[k], state[finger[k]])
    far = 1.0
    for f in range(len(z)):
        for k in range(2):
            x = z[f, 0] - z[finger[k], 0]
            y = z[f, 1] - z[finger[k], 1]
            far = max(far, np.hypot(x, y) / side)
    return Slack(sag, sag * far, sag / side)


@compiled
def sagitta(contacts, feature, state):
    """How far the arc of a finger's feature lies off its chord; 0 for what is no arc."""
    if contacts.kind[feature] != ARC:
        return 0.0
    return 2.0 * contacts.radius * math.sin(0.5 * state[1]) ** 2


@compiled
def place_of(contacts, feature, state, place):
    """Fill in a point and the side that starts there: an edge, a corner, a chord of an arc."""
    for c in range(4):
        place[c] = contacts.place[feature, c]
    if contacts.kind[feature] == ARC:
        r = contacts.radius
        first = state[0] - state[1]
        last = state[0] + state[1]
        place[0] += r * math.cos(first)
        place[1] += r * math.sin(first)
        place[2] = r * (math.cos(last) - math.cos(first))
        place[3] = r * (math.sin(last) - math.sin(first))


@compiled
def hands_on(pieces, z, cell, finger, chosen, count, contacts, state, slack, thick, room):
    """Corners of the hands, into ``room.polygon``; returns their number, 0 if there is none."""
    polygon, spare, place = room.polygon, room.spare, room.place
    for k in range(count):
        place_of(contacts, chosen[k], state[finger[k]], place[k])
    i, j = finger[0], finger[1]
    put_hands_of_two(place[0], place[1], z[i], z[j], polygon)
    n = 4
    row = room.row
    loose = thick + slack.shift
    for k in range(2, count):
        own = _ON * thick + slack.shift + sagitta(contacts, chosen[k], state[finger[k]])
        n = keep_near(place[k], z[finger[k]], own, row, polygon, n, spare)
        if n == 0:
            return 0
    for f in range(len(z)):
        n = keep_in_piece(pieces, cell[f], z[f], loose, row, polygon, n, spare)
        if n == 0:
            return 0
        for k in range(OUTSIDE):
            if state[f, 2 + 3 * k] >= 0.0:
                n = _held_off(z[f], contacts, state[f], k, loose, row, polygon, n, spare)
                if n == 0:
                    return 0
    return n


@compiled
def _held_off(z, contacts, state, k, loose, row, polygon, n, spare):
    """Keep the hands whose finger at z is outside the arc round a vertex, in a range of directions.

    Outside of the arc there is beyond its chord; the range is a sector of less than half a turn.
    """
    v = int(state[2 + 3 * k])
    middle = state[3 + 3 * k]
    half = state[4 + 3 * k]
    x, y = contacts.apex[v, 0], contacts.apex[v, 1]
    for turn in (0.0, 0.5 * math.pi - half, half - 0.5 * math.pi):
        n_x = math.cos(middle + turn)
        n_y = math.sin(middle + turn)
        finger_row(row, n_x, n_y, z[0], z[1])
        row[4] = loose - n_x * x - n_y * y
        if turn == 0.0:
            row[4] -= contacts.radius * math.cos(half)
        n = keep(polygon, n, row, spare)
    return n
