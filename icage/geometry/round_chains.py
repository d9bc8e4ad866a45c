"""Apexes over round stretches of an outline, so that no sliver reaches from each edge far away.

Outside a convex polygon of n edges every convex piece touches one edge, so n pieces are needed; but
a triangulation on the polygon's own vertices lets all of them reach far out, where a finger that
touches nothing then counts n positions. Here some ten edges at a time get one point above them, the
apex: a fan of thin triangles joins it to the edges, and a few large pieces do beyond. Any point
outside the object will do, so the pieces stay exact. Our own.
[docs/decisions/0013-round-objects.md]
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.convex import Point
from icage.geometry.kernels.round_chains import round_stretches, under_apexes


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
        (m, 3) counterclockwise triangles between both rings.
    """

    coarse: IntArray
    apexes: FloatArray
    fans: IntArray


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
    found = round_stretches(np.ascontiguousarray(ring), turns(ring))
    rows = zip(found.first.tolist(), found.last.tolist(), found.apex.tolist(), strict=True)
    return [Stretch(first, last, (x, y)) for first, last, (x, y) in rows]


def with_apexes(ring: FloatArray) -> Covered:
    """The apexes over a ring, the ring through them, and the triangles in between."""
    found = round_stretches(np.ascontiguousarray(ring), turns(ring))
    coarse, fans = under_apexes(len(ring), found.first, found.last)
    return Covered(coarse, found.apex, fans)


def turns(ring: FloatArray) -> FloatArray:
    """Angle (n,) [rad] from edge k - 1 to edge k of a ring (n, 2), positive at a convex vertex."""
    edge = np.arange(len(ring))
    side = ring[edge - len(ring) + 1] - ring
    before = side[edge - 1]
    cross = before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0]
    return np.arctan2(cross, (before * side).sum(axis=1))
