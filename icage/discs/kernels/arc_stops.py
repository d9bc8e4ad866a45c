"""Where arcs are split into chords or tangents, and the corners of the polygons drawn so."""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import longer

RESTING = 1e-3
"""[rad] Half the chord on which a contact of an arc rests. Were the contact a corner of the chords,
its normal would be off by half a step on either side, and a grasp could slide away that the arc
holds. The chord lies only 5e-7 radii inside."""

_GRADED = 3.0
"""[1] Beyond the resting chord each segment ends this many times as far from the contact: chords
are then flat against the distance from it, and levels there are those of the true curve."""

_WHOLE = 1e-6
"""[segment] An arc this little longer than a whole number of segments gets no further one: a right
angle that the rounding of a distant drawing has opened is split as the right angle is."""

_AT_END = 1e-12
"""[rad] A contact this near to the end of an arc counts as at the end."""

_TURN = 2.0 * math.pi


class NearArcs(NamedTuple):
    """Points at the radius from vertices, by element: the element, the point, and the way to it."""

    element: np.ndarray
    point: np.ndarray
    way_x: np.ndarray
    way_y: np.ndarray


class OnArcs(NamedTuple):
    """Points on arcs, by element: the element, the point, and its angle [rad] from the start."""

    element: np.ndarray
    point: np.ndarray
    angle: np.ndarray


class Corners(NamedTuple):
    """Corners over arcs: the element, ascending, the angle [rad] from its start, and half the
    step [rad] of the tangent that meets the next one there (0 for chords: on the arc itself).
    """

    element: np.ndarray
    angle: np.ndarray
    half: np.ndarray


@compiled
def near_arcs(every, ring, radius, points, slack):
    """Which of the points (k, 2) are at the radius, but for ``slack``, from the elements' vertices.

    What is made of the way to them, their direction, is numpy's to say.
    """
    found, way = np.empty((len(points) + 1, 2), np.int64), np.empty((len(points) + 1, 2))
    count = 0
    for e in range(len(every.turn)):
        if every.turn[e] <= 0.0:
            continue
        x, y = ring[every.number[e], 0], ring[every.number[e], 1]
        for k in range(len(points)):
            off_x, off_y = points[k, 0] - x, points[k, 1] - y
            if abs(np.hypot(off_x, off_y) - radius) <= slack:
                if count == len(found):
                    found, way = longer(found), longer(way)
                found[count, 0], found[count, 1] = e, k
                way[count, 0], way[count, 1] = off_x, off_y
                count += 1
    return NearArcs(
        found[:count, 0].copy(), found[:count, 1].copy(),
        way[:count, 0].copy(), way[:count, 1].copy(),
    )  # fmt: skip


@compiled
def on_arcs(every, near, direction):
    """Those of the points ``near``, in these directions (k,) [rad], that the arcs reach to."""
    element, point = np.empty_like(near.element), np.empty_like(near.element)
    angle = np.empty_like(direction)
    count = 0
    for k in range(len(direction)):
        e = near.element[k]
        t = (direction[k] - every.angle[e]) % _TURN
        if _AT_END < t < every.turn[e] - _AT_END:
            element[count], point[count], angle[count] = e, near.point[k], t
            count += 1
    return OnArcs(element[:count], point[:count], angle[:count])


@compiled_borrowing
def _coarse(segments):
    """[rad] The common length of so many segments a quadrant."""
    return 0.5 * math.pi / segments


@compiled_borrowing
def parts_of(turn, segments):
    """Into how many equal parts an arc [rad] is split, ``segments`` a quadrant or more."""
    return max(1, int(math.ceil(turn / _coarse(segments) - _WHOLE)))


@compiled
def widest_part(turn, segments):
    """[rad] The widest part of arcs (k,), 0 if there is none."""
    widest = 0.0
    for k in range(len(turn)):
        widest = max(widest, turn[k] / parts_of(turn[k], segments))
    return widest


@compiled_borrowing
def _put(ascending, count, t):
    """One more number among the first ``count``, unless it is there; returns how many there are."""
    k = count
    while k > 0 and ascending[k - 1] > t:
        k -= 1
    if k > 0 and ascending[k - 1] == t:
        return count
    for j in range(count, k, -1):
        ascending[j] = ascending[j - 1]
    ascending[k] = t
    return count + 1


@compiled
def resting_halves(turn, contacts):
    """Contacts on an arc, ascending, and half the chord that each rests on: ``resting_chords``."""
    resting = np.empty(len(contacts))
    count = 0
    for k in range(len(contacts)):
        count = _put(resting, count, contacts[k])
    half = np.empty(count)
    for k in range(count):
        t = resting[k]
        half[k] = min(RESTING, t, turn - t)
        if k > 0:
            half[k] = min(half[k], abs(t - resting[k - 1]) / 3.0)
        if k + 1 < count:
            half[k] = min(half[k], abs(t - resting[k + 1]) / 3.0)
    return resting[:count], half


@compiled_borrowing
def _spoils(stop, turn, resting):
    """Whether a stop would lie in the resting chord of a contact that is not the nearest one."""
    nearest = 0
    for k in range(len(resting)):
        if abs(resting[k] - stop) < abs(resting[nearest] - stop):
            nearest = k
    for k in range(len(resting)):
        t = resting[k]
        if k != nearest and abs(stop - t) < 0.999 * min(RESTING, t, turn - t):
            return True
    return False


@compiled
def _graded(turn, segments, contacts, touched):
    """Angles that split an arc round every contact, and at its ends: a short chord, then longer and
    longer ones up to the common length; and at the contacts if ``touched``.
    """
    coarse = _coarse(segments)
    resting, half = resting_halves(turn, contacts)
    room = 2 + len(resting)
    for k in range(len(resting)):
        reach = half[k]
        while reach < coarse:
            room += 2
            reach *= _GRADED
    knots = np.empty(room)
    count = _put(knots, 0, 0.0)
    count = _put(knots, count, turn)
    for k in range(len(resting)):
        reach = half[k]
        while reach < coarse:
            for sign in (-1.0, 1.0):
                stop = resting[k] + sign * reach
                if 0.0 < stop < turn and not _spoils(stop, turn, resting):
                    count = _put(knots, count, stop)
            reach *= _GRADED
        if touched and 0.0 < resting[k] < turn:
            count = _put(knots, count, resting[k])
    return knots[:count]


@compiled
def stops_between(knots, segments):
    """Angles, ascending, that split an arc at the knots and evenly in between."""
    count = 1
    for k in range(1, len(knots)):
        count += parts_of(knots[k] - knots[k - 1], segments)
    stops = np.empty(count)
    stops[0] = knots[0]
    at = 1
    for k in range(1, len(knots)):
        low, high = knots[k - 1], knots[k]
        parts = parts_of(high - low, segments)
        step = (high - low) / parts
        for j in range(1, parts):
            stops[at] = j * step + low
            at += 1
        stops[at] = high
        at += 1
    return stops


@compiled
def _even(turn, segments):
    """Angles that split an arc evenly."""
    parts = parts_of(turn, segments)
    step = turn / parts
    stops = np.empty(parts + 1)
    for j in range(parts + 1):
        stops[j] = j * step
    return stops


@compiled
def split_arcs(turn, segments, on, touched):
    """``Corners`` of chords, or of tangents if ``touched``, for elements that turn by (k,) [rad].

    ``on``: the contacts on arcs round which chords are graded, and which tangents touch at.
    """
    element, place = np.empty((64, 1), np.int64), np.empty((64, 2))
    count = 0
    begin = 0
    for e in range(len(turn)):
        end = begin
        while end < len(on.element) and on.element[end] == e:
            end += 1
        if turn[e] > 0.0:
            if end > begin:
                knots = _graded(turn[e], segments, on.angle[begin:end], touched)
                stops = stops_between(knots, segments)
            else:
                stops = _even(turn[e], segments)
            while count + len(stops) > len(element):
                element, place = longer(element), longer(place)
            for j in range(0 if touched else 1, len(stops) - 1):
                half = 0.5 * (stops[j + 1] - stops[j]) if touched else 0.0
                element[count, 0] = e
                place[count, 0], place[count, 1] = stops[j] + half, half
                count += 1
        begin = end
    return Corners(element[:count, 0].copy(), place[:count, 0].copy(), place[:count, 1].copy())


@compiled
def ring_with(every, ring, element, along_x, along_y, reach):
    """The corners of the curve, and after each those over its arc: in this direction from the arc's
    vertex, this far.
    """
    points = np.empty((len(every.turn) + len(element), 2))
    at = 0
    k = 0
    for e in range(len(every.turn)):
        points[at, 0], points[at, 1] = every.first[e, 0], every.first[e, 1]
        at += 1
        while k < len(element) and element[k] == e:
            vertex = every.number[e]
            points[at, 0] = ring[vertex, 0] + reach[k] * along_x[k]
            points[at, 1] = ring[vertex, 1] + reach[k] * along_y[k]
            at += 1
            k += 1
    return points
