"""The straight edges and arcs of the grown object's boundary, in closed form.

Every edge moved out by the radius and every arc round a convex vertex is cut where another edge of
the object comes nearer than the radius. The set of points of a line, or of an arc of this very
radius, that are nearer than the radius to one segment is a single interval, so its two ends are
found in closed form. What no interval covers are the elements of the curve, and they are chained
into rings where their ends meet. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.discs.arc_stops import unit_vectors
from icage.discs.edges import Edges
from icage.discs.kernels.elements import arcs_left, lines_left
from icage.errors import GeometryError

_JOINED = 1e-9
"""[diameter] Ends of elements this near to each other are one corner."""


class Elements(NamedTuple):
    """Straight edges (``turn`` 0) and arcs, k of them.

    Attributes
    ----------
    number:
        (k,) the edge or the vertex of the outline without straight vertices that each belongs to.
    first, last:
        (k, 2) the ends.
    angle:
        (k,) [rad] direction at the start of an arc from its vertex.
    turn:
        (k,) [rad] of an arc, 0 for an edge.
    """

    number: IntArray
    first: FloatArray
    last: FloatArray
    angle: FloatArray
    turn: FloatArray

    def __len__(self) -> int:
        return len(self.number)

    @property
    def middle(self) -> FloatArray:
        """Points (k, 2) half way along: over the middle of the chord, for an arc."""
        half = 0.5 * (self.last - self.first)
        rise = np.tan(0.25 * self.turn)[:, None]
        return 0.5 * (self.first + self.last) + rise * np.column_stack([half[:, 1], -half[:, 0]])

    def of(self, which: IntArray) -> Elements:
        """Some of them, in this order."""
        return Elements(
            self.number[which], self.first[which], self.last[which], self.angle[which],
            self.turn[which],
        )  # fmt: skip

    def and_then(self, other: Elements) -> Elements:
        """These, and then others."""
        return Elements(
            np.concatenate([self.number, other.number]),
            np.concatenate([self.first, other.first]),
            np.concatenate([self.last, other.last]),
            np.concatenate([self.angle, other.angle]),
            np.concatenate([self.turn, other.turn]),
        )


def outer_ring(edges: Edges, radius: float, size: float) -> tuple[Elements, int]:
    """The outer ring of the grown object counterclockwise, and how many pockets growth has closed.

    ``size`` is the diameter of the outline.

    Raises
    ------
    GeometryError:
        The elements do not close.
    """
    every = _lines(edges, radius, size).and_then(_arcs(edges, radius, size))
    rings = [every.of(ring) for ring in _chained(every, size)]
    area = [_area(one) for one in rings]
    closed = sum(a < -_JOINED * size**2 for a in area)
    return rings[int(np.argmax(area))], closed


def _lines(edges: Edges, radius: float, size: float) -> Elements:
    """What is left of every edge moved out."""
    left = lines_left(edges, radius, size)
    number = left.number[:, 0]
    at, way = edges.start[number] + radius * edges.out[number], edges.way[number]
    none = np.zeros(len(number))
    return Elements(number, at + left.ends[:, :1] * way, at + left.ends[:, 1:] * way, none, none)


def _arcs(edges: Edges, radius: float, size: float) -> Elements:
    """What is left of the arc round every convex vertex."""
    left = arcs_left(edges, radius, size)
    number = left.number[:, 0]
    into = edges.way[number - 1]
    begin = np.arctan2(into[:, 1], into[:, 0]) - 0.5 * math.pi
    a, b = left.ends.T
    first = edges.start[number] + radius * unit_vectors(begin + a)
    last = edges.start[number] + radius * unit_vectors(begin + b)
    return Elements(number, first, last, begin + a, b - a)


def _chained(pieces: Elements, size: float) -> list[IntArray]:
    """The rings that elements form, each beginning where the one before ends."""
    far = np.hypot(
        pieces.last[:, 0, None] - pieces.first[:, 0], pieces.last[:, 1, None] - pieces.first[:, 1]
    )
    after = np.argmin(far, axis=1)
    gap = far[np.arange(len(far)), after]
    follows: list[int] = after.tolist()
    if float(gap.max()) > _JOINED * size or len(set(follows)) < len(follows):
        raise GeometryError("the grown object's boundary does not close")
    rings: list[IntArray] = []
    left = set(range(len(follows)))
    while left:
        k = min(left)
        ring: list[int] = []
        while k in left:
            left.remove(k)
            ring.append(k)
            k = follows[k]
        rings.append(np.array(ring, np.int64))
    return rings


def _area(ring: Elements) -> float:
    """Signed area, [unit^2], arcs as chords through their middles; enough to tell rings apart."""
    x, y = np.stack([ring.first, ring.middle], axis=1).reshape(-1, 2).T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
