"""The least far jam: every choice of contact features in every cell of the target's component.

A choice puts some fingers on features (an edge or a vertex of their piece) and leaves the others
anywhere in their pieces. Its hands are a convex polygon (two contacts), a segment or a point
(three): the fingers on their features, the free ones in their pieces, and w in the sector in which
forces balance. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.friction.kernels.balance import EVERYTHING, NOTHING, balancing
from icage.friction.kernels.goal import cheapest
from icage.friction.kernels.polygon import keep, keep_in_piece, keep_near, put_hands_of_two
from icage.kernels.compiled import compiled

_ROOM = 96
"""Corners of a polygon: four, one for each half space, and some for rounding."""


class LeastJam(NamedTuple):
    """The jam found: sigma (inf: none), the hand (4,), and which fingers touch (fingers,)."""

    sigma: float
    hand: np.ndarray
    touches: np.ndarray


@compiled
def least_jam(pieces, z, cells, levels, contacts, subsets, near, goal, below, thick):
    """The far jam of least sigma, or the jam nearest to a goal, if that is under ``below``.

    Parameters
    ----------
    pieces, z:
        Of the free space; fingers (f, 2) of the unit hand.
    cells, levels:
        (n, f) the cells of the target's component, and the levels (n,) at which it reaches them,
        ascending.
    contacts:
        The features of the pieces with their cones.
    subsets:
        (k, f) which fingers touch, for every way in which at least two do.
    near, goal, below:
        The hands that count as the target; a hand that jams may be sought near to; a level or a
        distance [unit].
    thick:
        [unit] How far a finger may be off its feature.
    """
    fingers = len(z)
    hand = np.zeros(4)
    touches = np.zeros(fingers, np.bool_)
    point = np.empty(4)
    polygon, spare = np.empty((_ROOM, 4)), np.empty((_ROOM, 4))
    finger, chosen = np.empty(fingers, np.int64), np.empty(fingers, np.int64)
    sector = np.empty(2)
    best = below
    for c in range(len(cells)):
        most = goal.most if goal.asked else best
        if levels[c] >= most:
            break
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
                    chosen[k] = contacts.ptr[piece] + left % size
                    left //= size
                most = goal.most if goal.asked else best
                if not _sizes_fit(z, finger, chosen, count, contacts, levels[c], most, thick):
                    continue
                kind = balancing(z, finger, contacts.cone, chosen, count, sector)
                if kind == NOTHING:
                    continue
                n = _hands_on(
                    pieces, z, cells[c], finger, chosen, count, contacts, thick, polygon, spare
                )
                if n and kind != EVERYTHING:
                    n = _within(polygon, n, sector, thick, spare)
                if n == 0:
                    continue
                sigma = cheapest(polygon, n, near, goal, z, best, spare, point)
                if sigma < best:
                    best = sigma
                    hand[:] = point
                    touches[:] = subsets[subset]
    return LeastJam(best if best < below else np.inf, hand, touches)


@compiled
def _sizes_fit(z, finger, chosen, count, contacts, least, most, thick):
    """Whether every two features are neither too near nor too far apart for sigma in a range."""
    for a in range(count):
        for b in range(a + 1, count):
            side = np.hypot(z[finger[b], 0] - z[finger[a], 0], z[finger[b], 1] - z[finger[a], 1])
            p, q = contacts.place[chosen[a]], contacts.place[chosen[b]]
            x = q[0] + 0.5 * q[2] - p[0] - 0.5 * p[2]
            y = q[1] + 0.5 * q[3] - p[1] - 0.5 * p[3]
            apart = np.hypot(x, y)
            half = 0.5 * (np.hypot(p[2], p[3]) + np.hypot(q[2], q[3])) + thick
            if apart - half > most * side or apart + half < least * side - thick:
                return False
    return True


@compiled
def _hands_on(pieces, z, cell, finger, chosen, count, contacts, thick, polygon, spare):
    """Corners of the hands with these fingers on these features and the others in their pieces."""
    i, j = finger[0], finger[1]
    p, q = contacts.place[chosen[0]], contacts.place[chosen[1]]
    put_hands_of_two(p, q, z[i], z[j], polygon)
    n = 4
    row = np.empty(5)
    touching = 0
    for f in range(len(z)):
        if touching < count and finger[touching] == f:
            if touching >= 2:
                n = keep_near(contacts.place[chosen[touching]], z[f], thick, row, polygon, n, spare)
            touching += 1
        else:
            n = keep_in_piece(pieces, cell[f], z[f], thick, row, polygon, n, spare)
        if n == 0:
            return 0
    return n


@compiled
def _within(polygon, n, sector, thick, spare):
    """Keep the hands whose w points into a sector of at most half a turn."""
    row = np.zeros(5)
    row[4] = thick
    # left of the right edge, right of the left edge, and ahead
    for turn in (0.5 * math.pi - sector[1], sector[1] - 0.5 * math.pi, 0.0):
        row[2] = math.cos(sector[0] + turn)
        row[3] = math.sin(sector[0] + turn)
        n = keep(polygon, n, row, spare)
    return n
