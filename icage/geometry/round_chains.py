"""Apexes over round stretches of an outline, so that no sliver reaches from each edge far away.

Outside a convex polygon of n edges every convex piece touches one edge, so n pieces are needed; but
a triangulation on the polygon's own vertices lets all of them reach far out, where a finger that
touches nothing then counts n positions. Here some ten edges at a time get one point above them, the
apex: a fan of thin triangles joins it to the edges, and a few large pieces do beyond. Any point
outside the object will do, so the pieces stay exact. Our own.
[docs/decisions/0013-round-objects.md]
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.geometry.convex import Point, orientation

_FEWEST: Final = 4
"""Edges from the first to the last of a stretch, at least: fewer gain nothing."""

_MOST: Final = 12
"""The same on average: best between 300 and 600 edges, within a tenth from 9 to 15."""

_SPREAD: Final = 0.4
"""[_MOST, _WIDEST] Stretches are longer and shorter by up to this: were all alike, three fingers
whole stretches apart would come under their apexes together, in the most cells."""

_GOLDEN: Final = 0.6180339887498949
"""[1] Multiples of it modulo 1 are spread evenly and never repeat."""

_WIDEST: Final = math.radians(25.0)
"""[rad] Turn of a stretch, at most, on average: under a flat cap few hands have three fingers."""

_FLATTEST: Final = math.radians(0.05)
"""[rad] ... and at least, or the fan is thinner than it need be."""

_LIFT: Final = 2.0
"""[height of where the first and the last edge meet] Height of the apex: well above both lines, so
that no piece has an angle that only rounding tells from a straight one."""


class Stretch(NamedTuple):
    """Edges ``first`` to ``last`` of a ring (edge k starts at vertex k), and a point above them.

    The first and the last edge stay as they are; the apex has a triangle with each one between.
    """

    first: int
    last: int
    apex: Point


class Covered(NamedTuple):
    """A ring with apexes over its round stretches.

    Attributes
    ----------
    coarse:
        Vertices of a simple ring round the given one: numbers below n are its own, n + k is apex k.
    apexes:
        (k, 2).
    fans:
        Counterclockwise triangles between both rings.
    """

    coarse: IntArray
    apexes: FloatArray
    fans: list[list[int]]


def stretches(ring: FloatArray) -> list[Stretch]:
    """Round stretches of a counterclockwise ring (n, 2), with apexes outside of it; by first edge.

    No cap (apex and both ends of its fan) meets another one or another part of the ring.

    Examples
    --------
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    >>> found = stretches(np.column_stack([np.cos(angle), np.sin(angle)]))
    >>> len(found), found[0].first, found[0].last
    (16, 0, 7)
    >>> stretches(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    []
    """
    found: list[Stretch] = []
    for first, last in _groups(turns(ring)):
        apex = _apex(ring, first, last)
        if apex is not None:
            found.append(Stretch(first, last, apex))
    return _clear(ring, found)


def with_apexes(ring: FloatArray) -> Covered:
    """The apexes over a ring, the ring through them, and the triangles in between."""
    n = len(ring)
    found = stretches(ring)
    over = {(s.first + 1) % n: n + k for k, s in enumerate(found)}
    under = {v % n for s in found for v in range(s.first + 2, s.last)}
    coarse = [w for v in range(n) if v not in under for w in ((v, over[v]) if v in over else (v,))]
    fans = [
        [n + k, (v + 1) % n, v % n] for k, s in enumerate(found) for v in range(s.first + 1, s.last)
    ]
    apexes = np.array([s.apex for s in found]).reshape(-1, 2)
    return Covered(np.array(coarse, dtype=np.int64), apexes, fans)


def turns(ring: FloatArray) -> FloatArray:
    """Angle (n,) [rad] from edge k - 1 to edge k of a ring (n, 2), positive at a convex vertex."""
    side = np.roll(ring, -1, axis=0) - ring
    before = np.roll(side, 1, axis=0)
    cross = before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0]
    return np.arctan2(cross, (before * side).sum(axis=1))


def _groups(turn: FloatArray) -> list[tuple[int, int]]:
    """First and last edges of groups with left turns only; the last may be n or more."""
    n = len(turn)
    gentle = np.where(turn > 0.0, turn, np.inf)
    sums = sum(np.roll(gentle, -k) for k in range(_FEWEST))
    if n <= _FEWEST or not bool(np.any(sums <= _WIDEST * (1.0 + _SPREAD))):
        return []
    sharp = np.flatnonzero((turn <= 0.0) | (turn > _WIDEST / 2.0))
    begin = int(sharp[0]) if len(sharp) else 0
    groups: list[tuple[int, int]] = []
    angle: list[float] = np.roll(turn, -begin).tolist()  # edge k here is begin + k of the ring
    first = 0
    while first < n:
        share = ((len(groups) + 1) * _GOLDEN) % 1.0
        size = 1.0 - _SPREAD + 2.0 * _SPREAD * share
        longest, widest = round(_MOST * size), _WIDEST * size
        last, sum_of_turns = first, 0.0
        while last - first < longest and last < n:
            more = angle[(last + 1) % n]
            if not 0.0 < more <= widest - sum_of_turns:
                break
            last, sum_of_turns = last + 1, sum_of_turns + more
        if last - first >= _FEWEST and sum_of_turns >= _FLATTEST:
            groups.append((begin + first, begin + last))
        first = max(last, first + 1)
    return groups


def _apex(ring: FloatArray, first: int, last: int) -> Point | None:
    """A point above a group of edges that sees them all, or None if rounding spoils it."""
    n = len(ring)
    a, a_end = ring[first % n], ring[(first + 1) % n]
    b, b_end = ring[last % n], ring[(last + 1) % n]
    along, back = a_end - a, b_end - b
    sine = along[0] * back[1] - along[1] * back[0]
    if sine <= 0.0:
        return None
    reach = ((b - a_end)[0] * back[1] - (b - a_end)[1] * back[0]) / sine
    foot = 0.5 * (a_end + b)
    x, y = (foot + _LIFT * (a_end + reach * along - foot)).tolist()
    points: list[Point] = [(u, v) for u, v in ring[np.arange(first, last + 2) % n].tolist()]
    sees = all(orientation(q, p, (x, y)) > 0 for p, q in pairwise(points))
    return (x, y) if sees else None


def _clear(ring: FloatArray, found: list[Stretch]) -> list[Stretch]:
    """The stretches whose caps meet neither the ring elsewhere nor the cap of an earlier one."""
    if not found:
        return []
    n = len(ring)
    ends = np.array([(s.first + 1, s.last) for s in found]) % n
    apexes = np.array([s.apex for s in found])
    corners = np.stack([ring[ends[:, 0]], apexes, ring[ends[:, 1]]], axis=1)
    caps: list[Any] = np.asarray(shapely.polygons(corners)).tolist()
    sides = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    edges: list[Any] = np.asarray(shapely.linestrings(sides)).tolist()
    blocked: set[int] = set()
    for k, edge in shapely.STRtree(edges).query(caps, predicate="intersects").T.tolist():
        if (edge - found[k].first) % n > found[k].last - found[k].first:
            blocked.add(k)
    for k, other in sorted(shapely.STRtree(caps).query(caps, predicate="intersects").T.tolist()):
        if other < k and other not in blocked:
            blocked.add(k)
    return [s for k, s in enumerate(found) if k not in blocked]
