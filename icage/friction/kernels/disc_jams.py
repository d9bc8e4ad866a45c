"""The least far jam of disc fingers, by branch and bound over parts of arcs.

A choice puts some fingers on features of their pieces (an edge, a corner, a part of an arc) and
leaves the others anywhere in theirs. On edges its jams are found at once; on parts of arcs, and
where a free finger is between an arc and the polygon that stands for it, only a bound is, and the
part is halved until it is so short that it no longer matters. Every bound is on the safe side,
and so is what is left when there are too many halves. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.friction.kernels.disc_balance import HALVED, least_balanced
from icage.friction.kernels.disc_features import (
    ARC,
    MOST_EDGES,
    generators,
    rays,
)
from icage.friction.kernels.disc_halving import halved
from icage.friction.kernels.disc_hands import (
    COLUMNS,
    hands_on,
    place_of,
    slack_of,
)
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal, cheapest
from icage.friction.kernels.jams import LeastJam
from icage.friction.kernels.polygon import least
from icage.kernels.compiled import compiled

_ROOM = 96
"""Corners of a polygon: four, one for each half space, and some for rounding."""

_TRIES = 10_000
"""Bounds that are computed for one choice; what has not been decided then counts as a jam."""

_GAP = 4e-10
"""[1] Parts that could lower a level by less (relative) are not halved; it is lowered by what they
could. Where forces balance along the curve sigma hardly changes, and all parts there would be: it
has to be more than the bounds of the shortest parts are off, ..."""

_DOUBLED = 500
"""... and it doubles after so many bounds for one choice: those parts grow many as they shrink."""

_STACK = 256
"""Parts that wait."""


class Choices(NamedTuple):
    """Ways for fingers to stand on features in cells, by least sigma of their far hands, ascending.

    ``cell``, ``subset`` (k,); ``chosen`` (k, fingers) features, of as many as touch; ``bound``
    (k,) [unit], below which no far hand of them is in the component.
    """

    cell: np.ndarray
    subset: np.ndarray
    chosen: np.ndarray
    bound: np.ndarray


class Room(NamedTuple):
    """Room for polygons and rows, so that nothing is made anew for every choice."""

    polygon: np.ndarray
    spare: np.ndarray
    one: np.ndarray
    half: np.ndarray
    halves: np.ndarray
    sizes: np.ndarray
    depth: np.ndarray
    place: np.ndarray
    row: np.ndarray
    found: np.ndarray
    some: np.ndarray
    edge: np.ndarray
    ray: np.ndarray
    low: np.ndarray
    high: np.ndarray


@compiled
def _room(fingers):
    edges = fingers * (MOST_EDGES + 2)
    most = min(edges * (edges - 1) * (edges - 2) // 6, 400)
    return Room(
        np.empty((_ROOM, 4)), np.empty((_ROOM, 4)), np.empty((_ROOM, 4)), np.empty((_ROOM, 4)),
        np.empty((HALVED + 4, _ROOM, 4)), np.empty(HALVED + 4, np.int64),
        np.empty(HALVED + 4, np.int64), np.empty((fingers, 4)), np.zeros(5), np.empty(4),
        np.empty(4), np.empty((edges, 6)), np.empty((most, 7)), np.empty((most, 2)),
        np.empty((most, 2)),
    )  # fmt: skip


@compiled
def possible_choices(pieces, z, cells, levels, contacts, subsets, near, goal, below, thick):
    """Every choice with far hands under ``below``, whatever forces do, in no order.

    The ``goal`` asks for nothing.
    """
    fingers = len(z)
    room = _room(fingers)
    state = np.full((fingers, COLUMNS), -1.0)
    finger, chosen = np.empty(fingers, np.int64), np.zeros(fingers, np.int64)
    point = np.empty(4)
    cell_of, subset_of = np.empty(256, np.int64), np.empty(256, np.int64)
    chosen_of, bound_of = np.empty((256, fingers), np.int64), np.empty(256)
    n = 0
    for c in range(len(cells)):
        for subset in range(len(subsets)):
            count = 0
            total = 1
            for f in range(fingers):
                if subsets[subset, f]:
                    finger[count] = f
                    count += 1
                    piece = cells[c, f]
                    total *= contacts.ptr[piece + 1] - contacts.ptr[piece]
            for number in range(total):
                left = number
                for k in range(count):
                    piece = cells[c, finger[k]]
                    size = contacts.ptr[piece + 1] - contacts.ptr[piece]
                    feature = contacts.which[contacts.ptr[piece] + left % size]
                    left //= size
                    chosen[k] = feature
                    for col in range(2):
                        state[finger[k], col] = contacts.angle[feature, col]
                if not _sizes_fit(
                    z, finger, chosen, count, contacts, state, levels[c], below, thick, room.place
                ):
                    continue
                bound = _bound(
                    pieces, z, cells[c], finger, chosen, count, contacts, state, 0.0, near, goal,
                    below, thick, room, point,
                )  # fmt: skip
                bound = max(bound, levels[c])
                if bound >= below:
                    continue
                if n == len(bound_of):
                    cell_of = np.concatenate((cell_of, cell_of))
                    subset_of = np.concatenate((subset_of, subset_of))
                    chosen_of = np.concatenate((chosen_of, chosen_of))
                    bound_of = np.concatenate((bound_of, bound_of))
                cell_of[n] = c
                subset_of[n] = subset
                chosen_of[n] = chosen
                bound_of[n] = bound
                n += 1
    return Choices(cell_of[:n], subset_of[:n], chosen_of[:n], bound_of[:n])


@compiled
def bounds_of(pieces, z, cells, contacts, subsets, choices, near, goal, phi, below, thick):
    """Bounds (k,) [unit] of the choices for friction of an angle; inf from ``below`` on."""
    fingers = len(z)
    room = _room(fingers)
    state = np.full((fingers, COLUMNS), -1.0)
    finger = np.empty(fingers, np.int64)
    point = np.empty(4)
    bound = np.full(len(choices.bound), np.inf)
    for k in range(len(bound)):
        if choices.bound[k] >= (goal.most if goal.asked else below):
            continue
        cell, chosen = cells[choices.cell[k]], choices.chosen[k]
        count = _begun(subsets[choices.subset[k]], chosen, contacts, finger, state)
        found = _bound(
            pieces, z, cell, finger, chosen, count, contacts, state, phi, near, goal, below, thick,
            room, point,
        )  # fmt: skip
        bound[k] = found if goal.asked else max(found, choices.bound[k])
    return bound


@compiled
def least_disc_jam(
    pieces, z, cells, contacts, subsets, choices, bounds, order, near, goal, phi, below, thick
):
    """The far jam of least sigma, or the jam nearest to the goal, if that is under ``below``.

    ``bounds`` (k,) are those of the choices for this angle of friction ``phi`` [rad] or more,
    ``order`` sorts them. Lengths in the unit of the pieces; ``thick``: how far a finger may be off.
    """
    fingers = len(z)
    room = _room(fingers)
    finger = np.empty(fingers, np.int64)
    states = np.full((_STACK, fingers, COLUMNS), -1.0)
    waiting, points = np.empty(_STACK), np.empty((_STACK, 4))
    state = np.empty((fingers, COLUMNS))
    child, point = np.empty((2, fingers, COLUMNS)), np.empty((2, 4))
    bound = np.empty(2)
    hand = np.zeros(4)
    touches = np.zeros(fingers, np.bool_)
    best = below
    lowest = np.inf
    for position in range(len(order)):
        choice = order[position]
        if bounds[choice] >= best * (1.0 - _GAP):
            if best < below:
                lowest = min(lowest, bounds[choice])
            break
        cell, chosen = cells[choices.cell[choice]], choices.chosen[choice]
        floor = bounds[choice]
        subset = subsets[choices.subset[choice]]
        states[0] = -1.0
        count = _begun(subset, chosen, contacts, finger, states[0])
        found = _bound(
            pieces, z, cell, finger, chosen, count, contacts, states[0], phi, near, goal, best,
            thick, room, points[0],
        )  # fmt: skip
        waiting[0] = max(found, floor)
        top = 1
        tries = 0
        while top:
            top -= 1
            gap = _GAP * 2.0 ** (tries / _DOUBLED)
            if waiting[top] >= best * (1.0 - gap):
                if waiting[top] < lowest:
                    lowest = waiting[top]
                    if best == below:
                        hand[:] = points[top]
                        touches[:] = subset
                continue
            state[:] = states[top]
            if (
                tries >= _TRIES
                or top + 2 > _STACK
                or not halved(
                    pieces, z, cell, subset, chosen, finger, count, contacts, state, points[top],
                    thick, child,
                )
            ):  # fmt: skip
                best = waiting[top]
                hand[:] = points[top]
                touches[:] = subset
                continue
            own = waiting[top]
            for k in range(2):
                tries += 1
                bound[k] = _bound(
                    pieces, z, cell, finger, chosen, count, contacts, child[k], phi, near,
                    goal, best, thick, room, point[k],
                )  # fmt: skip
                bound[k] = max(bound[k], own)
            # the lower one is looked at first
            first = 1 if bound[1] > bound[0] else 0
            for k in (first, 1 - first):
                if bound[k] < best:
                    states[top] = child[k]
                    points[top] = point[k]
                    waiting[top] = bound[k]
                    top += 1
    least_found = min(best, lowest)
    return LeastJam(
        least_found if least_found < below * (1.0 - _GAP) else np.inf, hand, touches
    )  # fmt: skip


@compiled
def _begun(subset, chosen, contacts, finger, state):
    """Fill in the fingers that touch and their parts of arcs; returns how many touch."""
    count = 0
    for f in range(len(subset)):
        if subset[f]:
            finger[count] = f
            for col in range(2):
                state[f, col] = contacts.angle[chosen[count], col]
            count += 1
    return count


@compiled
def _bound(
    pieces, z, cell, finger, chosen, count, contacts, state, phi, near, goal, below, thick, room,
    point,
):  # fmt: skip
    """No far jam of these features in this cell is smaller, if that is under ``below``; else inf.

    For ``phi`` = 0 no hand at all. ``point`` is where the bound would be reached.
    """
    slack = slack_of(z, finger, chosen, contacts, state)
    n = hands_on(pieces, z, cell, finger, chosen, count, contacts, state, slack, thick, room)
    if n == 0:
        return np.inf
    # what the value sought may be less on the true arcs
    off = slack.shift if goal.asked else slack.w
    under = below + off
    if goal.asked:
        goal = Goal(goal.fingers, goal.most + slack.w, True)
    elif slack.w > 0.0:
        small = least(room.polygon, n, room.some)
        near = _smaller(near, slack, slack.w / max(small, 1e-300))
    if phi == 0.0:
        value = cheapest(room.polygon, n, near, goal, z, under, room.spare, point)
        return value - off
    g = generators(contacts, finger, chosen, count, state, phi, room.edge)
    m = rays(z, room.edge, g, room.ray)
    if m == 0:
        return np.inf
    reach = 0.0
    for f in range(len(z)):
        reach = max(reach, np.hypot(z[f, 0], z[f, 1]))
    value = least_balanced(
        n, z, room.ray, m, near, goal, under, 0.01 * thick + slack.shift,
        slack.w * reach + 1e-15 * contacts.radius, room, point,
    )  # fmt: skip
    return value - off


@compiled
def _smaller(near, slack, turn):
    """The tolerance less what a hand on the true arcs may be off."""
    return Near(
        near.at_x, near.at_y, max(0.0, near.reach - slack.shift), near.ahead_x, near.ahead_y,
        max(0.0, near.turn - 1.6 * turn), near.mid_x, near.mid_y, near.fine,
    )  # fmt: skip


@compiled
def _sizes_fit(z, finger, chosen, count, contacts, state, least, most, thick, place):
    """Whether every two features are neither too near nor too far apart for sigma in a range."""
    r = contacts.radius
    for k in range(count):
        place_of(contacts, chosen[k], state[finger[k]], place[k])
    for a in range(count):
        for b in range(a + 1, count):
            side = np.hypot(z[finger[b], 0] - z[finger[a], 0], z[finger[b], 1] - z[finger[a], 1])
            p, q = place[a], place[b]
            x = q[0] + 0.5 * q[2] - p[0] - 0.5 * p[2]
            y = q[1] + 0.5 * q[3] - p[1] - 0.5 * p[3]
            apart = np.hypot(x, y)
            half = 0.5 * (np.hypot(p[2], p[3]) + np.hypot(q[2], q[3])) + thick
            for k in (a, b):
                if contacts.kind[chosen[k]] == ARC:
                    half += r * (1.0 - math.cos(state[finger[k], 1]))
            if apart - half > most * side or apart + half < least * side - thick:
                return False
    return True
