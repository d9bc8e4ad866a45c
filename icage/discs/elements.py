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

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.discs.arc_stops import unit_vectors
from icage.discs.edges import Edges
from icage.errors import GeometryError

_JOINED = 1e-9
"""[diameter] Ends of elements this near to each other are one corner."""

_NOTHING = 1e-12
"""[diameter] An element this short is rounding."""

_AT_END = 1e-12
"""[1] A crossing is taken to lie on a segment if its foot is this little beyond the end."""

_PARALLEL = 1e-12
"""[1] Sine of an angle between two edges that is none."""

_IN_REACH = 1e-6
"""[1] Edges are looked at up to this much further away than they can cover anything."""


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


class _Covered(NamedTuple):
    """Intervals (low, high) of lines or arcs, by number, that edges come too near to."""

    row: IntArray
    low: FloatArray
    high: FloatArray


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
    start = edges.start + radius * edges.out
    covered = _covered_lines(edges, start, radius, size)
    number, a, b = _left(covered, edges.length, np.full(len(start), _NOTHING * size))
    at, way = start[number], edges.way[number]
    none = np.zeros(len(number))
    return Elements(number, at + a[:, None] * way, at + b[:, None] * way, none, none)


def _covered_lines(edges: Edges, start: FloatArray, radius: float, size: float) -> _Covered:
    """Where each moved edge is nearer than the radius to another edge."""
    n, convex = len(start), edges.convex
    end = start + edges.length[:, None] * edges.way
    near = _boxes_meet(start, end, edges, radius * (1.0 + _IN_REACH) + _IN_REACH * size)
    index = np.arange(n)
    near[index, index] = False
    # beside a convex vertex the edges keep clear of each other
    near[index[convex], index[convex] - 1] = False
    near[index[convex] - 1, index[convex]] = False
    row, other = np.nonzero(near)
    ring_x, ring_y = edges.start[other].T
    way_x, way_y = edges.way[other].T
    out_x, out_y = edges.out[other].T
    start_x, start_y = start[row].T
    along_x, along_y = edges.way[row].T
    across_x, across_y = edges.out[row].T
    length = edges.length[other]
    slack = _AT_END * length
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)

    def meet(t: FloatArray, valid: BoolArray) -> None:
        np.minimum(low, t, out=low, where=valid)
        np.maximum(high, t, out=high, where=valid)

    with np.errstate(divide="ignore", invalid="ignore"):
        for last in (False, True):
            corner_x, corner_y = edges.end[other].T if last else (ring_x, ring_y)
            off_x, off_y = corner_x - start_x, corner_y - start_y
            along = off_x * along_x + off_y * along_y
            across = off_x * across_x + off_y * across_y
            half = np.sqrt(radius**2 - across**2)
            for sign in (-1.0, 1.0):
                t = along + sign * half
                beyond = (start_x + t * along_x - corner_x) * way_x
                beyond += (start_y + t * along_y - corner_y) * way_y
                meet(t, (half > 0.0) & (beyond >= -slack if last else beyond <= slack))
        gap = (start_x - ring_x) * out_x + (start_y - ring_y) * out_y
        slope = along_x * out_x + along_y * out_y
        steep = np.abs(slope) > _PARALLEL
        for sign in (-1.0, 1.0):
            t = (sign * radius - gap) / slope
            foot = (start_x + t * along_x - ring_x) * way_x
            foot += (start_y + t * along_y - ring_y) * way_y
            meet(t, steep & (foot >= -slack) & (foot <= length + slack))
        # a slot that the finger fits into with no room to spare is closed
        tight = ~steep & (np.abs(gap - radius) <= _NOTHING * size)
        tight &= along_x * way_x + along_y * way_y < 0.0
        along = (ring_x - start_x) * along_x + (ring_y - start_y) * along_y
        meet(along, tight)
        meet(along - length, tight)
    return _Covered(row, low, high)


def _arcs(edges: Edges, radius: float, size: float) -> Elements:
    """What is left of the arc round every convex vertex."""
    convex = np.flatnonzero(edges.convex)
    begin = np.arctan2(edges.way[convex - 1, 1], edges.way[convex - 1, 0]) - 0.5 * math.pi
    covered = _covered_arcs(edges, convex, begin, radius)
    again = 2.0 * math.pi
    twice = _Covered(
        np.concatenate([covered.row, covered.row]),
        np.concatenate([covered.low, covered.low + again]),
        np.concatenate([covered.high, covered.high + again]),
    )
    least = np.full(len(convex), _NOTHING * size / radius)
    arc, a, b = _left(twice, edges.turn[convex], least)
    number, angle = convex[arc], begin[arc] + a
    first = edges.start[number] + radius * unit_vectors(angle)
    last = edges.start[number] + radius * unit_vectors(begin[arc] + b)
    return Elements(number, first, last, angle, b - a)


def _covered_arcs(edges: Edges, convex: IntArray, begin: FloatArray, radius: float) -> _Covered:
    """Where circles round vertices are nearer than the radius to edges, [rad] from ``begin``.

    An interval may begin before that.
    """
    centre = edges.start[convex]
    near = _boxes_meet(centre, centre, edges, 2.0 * radius * (1.0 + _IN_REACH))
    row = np.arange(len(convex))
    near[row, convex] = near[row, convex - 1] = False
    row, other = np.nonzero(near)
    centre_x, centre_y = centre[row].T
    ring_x, ring_y = edges.start[other].T
    way_x, way_y = edges.way[other].T
    out_x, out_y = edges.out[other].T
    length = edges.length[other]
    off_x, off_y = ring_x - centre_x, ring_y - centre_y
    t = np.clip(-(off_x * way_x + off_y * way_y), 0.0, length)
    near_x, near_y = off_x + t * way_x, off_y + t * way_y
    nearest = np.arctan2(near_y, near_x)
    reached = np.hypot(near_x, near_y) < 2.0 * radius
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)

    def meet(angle: FloatArray, valid: BoolArray) -> None:
        t = (angle - nearest + math.pi) % (2.0 * math.pi) - math.pi
        np.minimum(low, t, out=low, where=valid & reached)
        np.maximum(high, t, out=high, where=valid & reached)

    def along(angle: FloatArray, from_x: FloatArray, from_y: FloatArray) -> FloatArray:
        """Foot on the edge's line of a point of the circle, from a point of the line."""
        x, y = centre_x + radius * np.cos(angle), centre_y + radius * np.sin(angle)
        return (x - from_x) * way_x + (y - from_y) * way_y

    slack = _AT_END * length
    with np.errstate(divide="ignore", invalid="ignore"):
        for last in (False, True):
            corner_x, corner_y = edges.end[other].T if last else (ring_x, ring_y)
            to_x, to_y = corner_x - centre_x, corner_y - centre_y
            half = np.arccos(np.hypot(to_x, to_y) / (2.0 * radius))
            towards = np.arctan2(to_y, to_x)
            for sign in (-1.0, 1.0):
                angle = towards + sign * half
                beyond = along(angle, corner_x, corner_y)
                meet(angle, (half > 0.0) & (beyond >= -slack if last else beyond <= slack))
        height = -(off_x * out_x + off_y * out_y)
        outward = np.arctan2(out_y, out_x)
        for side in (-1.0, 1.0):
            half = np.arccos(side - height / radius)
            for sign in (-1.0, 1.0):
                angle = outward + sign * half
                foot = along(angle, ring_x, ring_y)
                meet(angle, np.isfinite(half) & (foot >= -slack) & (foot <= length + slack))
    middle = (nearest - begin[row] + math.pi) % (2.0 * math.pi) - math.pi
    return _Covered(row, middle + low, middle + high)


def _boxes_meet(first: FloatArray, last: FloatArray, edges: Edges, reach: float) -> BoolArray:
    """Which boxes round segments (k, 2), grown by ``reach``, meet those round edges, (k, n)."""
    low, high = np.minimum(first, last) - reach, np.maximum(first, last) + reach
    least, most = np.minimum(edges.start, edges.end), np.maximum(edges.start, edges.end)
    meet = (low[:, 0, None] <= most[:, 0]) & (high[:, 0, None] >= least[:, 0])
    return meet & (low[:, 1, None] <= most[:, 1]) & (high[:, 1, None] >= least[:, 1])


def _left(
    covered: _Covered, length: FloatArray, least: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """What of [0, length] no interval covers, but for what is below ``least``: rows and ends."""
    row, low, high = covered
    use = np.flatnonzero((low < length[row]) & (high > 0.0) & (high - low > 0.0))
    use = use[np.lexsort((low[use], row[use]))]
    cuts: list[list[tuple[float, float]]] = [[] for _ in length]
    for k, a, b in zip(row[use].tolist(), low[use].tolist(), high[use].tolist(), strict=True):
        cuts[k].append((a, b))
    found: list[tuple[int, float, float]] = []
    for k, (own, whole, short) in enumerate(
        zip(cuts, length.tolist(), least.tolist(), strict=True)
    ):
        at = 0.0
        for a, b in own:
            if a - at > short:
                found.append((k, at, a))
            at = max(at, b)
        if whole - at > short:
            found.append((k, at, whole))
    numbers, first, last = zip(*found, strict=True) if found else ((), (), ())
    return np.array(numbers, np.int64), np.array(first, float), np.array(last, float)


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
