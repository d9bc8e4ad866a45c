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


class Element(NamedTuple):
    """A straight edge (``turn`` 0) or an arc of the curve, counterclockwise round the object.

    ``number`` is the edge or the vertex of the outline without straight vertices that it belongs
    to, ``first`` and ``last`` (2,) are its ends, ``angle`` [rad] the direction at the start of an
    arc from its vertex.
    """

    number: int
    first: FloatArray
    last: FloatArray
    angle: float
    turn: float

    @property
    def middle(self) -> FloatArray:
        """The point (2,) half way along it: over the middle of the chord, if it is an arc."""
        half = 0.5 * (self.last - self.first)
        rise = math.tan(0.25 * self.turn)
        return 0.5 * (self.first + self.last) + rise * np.array([half[1], -half[0]])


def outer_ring(edges: Edges, radius: float, size: float) -> tuple[tuple[Element, ...], int]:
    """The outer ring of the grown object, and how many pockets the growth has closed.

    ``size`` is the diameter of the outline.

    Raises
    ------
    GeometryError:
        The elements do not close.
    """
    rings = _chained(_lines(edges, radius, size) + _arcs(edges, radius, size), size)
    area = [_area(one) for one in rings]
    closed = sum(a < -_JOINED * size**2 for a in area)
    return tuple(rings[int(np.argmax(area))]), closed


def _lines(edges: Edges, radius: float, size: float) -> list[Element]:
    """What is left of every edge moved out."""
    start = edges.start + radius * edges.out
    low, high = _covered_lines(edges, start, radius, size)
    index = np.arange(len(start))
    low[index, index] = np.inf
    convex = np.flatnonzero(edges.convex)
    low[convex, convex - 1] = np.inf
    low[convex - 1, convex] = np.inf
    found: list[Element] = []
    for q, (at, way) in enumerate(zip(start, edges.way, strict=True)):
        for a, b in _left(low[q], high[q], float(edges.length[q]), _NOTHING * size):
            found.append(Element(q, at + a * way, at + b * way, 0.0, 0.0))
    return found


def _covered_lines(
    edges: Edges, start: FloatArray, radius: float, size: float
) -> tuple[FloatArray, FloatArray]:
    """Interval (n, n) of each moved edge (row) that is nearer than the radius to each edge."""
    n = len(start)
    ring, way, out, length = edges.start, edges.way, edges.out, edges.length
    slack = _AT_END * length[None]
    low, high = np.full((n, n), np.inf), np.full((n, n), -np.inf)

    def meet(t: FloatArray, valid: BoolArray) -> None:
        low[valid] = np.minimum(low, t)[valid]
        high[valid] = np.maximum(high, t)[valid]

    with np.errstate(divide="ignore", invalid="ignore"):
        for end in (0, 1):
            corner = edges.end if end else ring
            off = corner[None] - start[:, None]
            along = (off * way[:, None]).sum(axis=2)
            across = (off * out[:, None]).sum(axis=2)
            half = np.sqrt(radius**2 - across**2)
            for sign in (-1.0, 1.0):
                t = along + sign * half
                point = start[:, None] + t[..., None] * way[:, None]
                beyond = ((point - corner[None]) * way[None]).sum(axis=2)
                meet(t, (half > 0.0) & (beyond >= -slack if end else beyond <= slack))
        gap = ((start[:, None] - ring[None]) * out[None]).sum(axis=2)
        slope = (way[:, None] * out[None]).sum(axis=2)
        for sign in (-1.0, 1.0):
            t = (sign * radius - gap) / slope
            point = start[:, None] + t[..., None] * way[:, None]
            foot = ((point - ring[None]) * way[None]).sum(axis=2)
            steep = np.abs(slope) > _PARALLEL
            meet(t, steep & (foot >= -slack) & (foot <= length[None] + slack))
        # a slot that the finger fits into with no room to spare is closed
        tight = (np.abs(slope) <= _PARALLEL) & (np.abs(gap - radius) <= _NOTHING * size)
        tight &= (way[:, None] * way[None]).sum(axis=2) < 0.0
        along = ((ring[None] - start[:, None]) * way[:, None]).sum(axis=2)
        meet(along, tight)
        meet(along - length[None], tight)
    return low, high


def _arcs(edges: Edges, radius: float, size: float) -> list[Element]:
    """What is left of the arc round every convex vertex."""
    convex = np.flatnonzero(edges.convex)
    begin = np.arctan2(edges.way[convex - 1, 1], edges.way[convex - 1, 0]) - 0.5 * math.pi
    nearest, low, high = _covered_arcs(edges, edges.start[convex], radius)
    row = np.arange(len(convex))
    high[row, convex], high[row, convex - 1] = -np.inf, -np.inf
    low[row, convex], low[row, convex - 1] = np.inf, np.inf
    # from the start of the arc; an interval may begin before it
    middle = (nearest - begin[:, None] + math.pi) % (2.0 * math.pi) - math.pi
    found: list[Element] = []
    again = 2.0 * math.pi
    for k, v in enumerate(convex.tolist()):
        a, b = middle[k] + low[k], middle[k] + high[k]
        lows, highs = np.concatenate([a, a + again]), np.concatenate([b, b + again])
        turn = float(edges.turn[v])
        for first, last in _left(lows, highs, turn, _NOTHING * size / radius):
            angle = float(begin[k]) + first
            ends = edges.start[v] + radius * unit_vectors(np.array([angle, float(begin[k]) + last]))
            found.append(Element(v, ends[0], ends[1], angle, last - first))
    return found


def _covered_arcs(
    edges: Edges, centre: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where circles (rows) are nearer than the radius to edges (columns), [rad].

    The direction of the edge's nearest point, and how far the interval goes to either side of it.
    """
    ring, way, out, length = edges.start, edges.way, edges.out, edges.length
    off = ring[None] - centre[:, None]
    t = np.clip(-(off * way[None]).sum(axis=2), 0.0, length[None])
    near = off + t[..., None] * way[None]
    nearest = np.arctan2(near[..., 1], near[..., 0])
    low, high = np.full(nearest.shape, np.inf), np.full(nearest.shape, -np.inf)
    reached = np.hypot(near[..., 0], near[..., 1]) < 2.0 * radius

    def meet(angle: FloatArray, valid: BoolArray) -> None:
        t = (angle - nearest + math.pi) % (2.0 * math.pi) - math.pi
        valid = valid & reached
        low[valid] = np.minimum(low, t)[valid]
        high[valid] = np.maximum(high, t)[valid]

    def point(angle: FloatArray) -> FloatArray:
        return centre[:, None] + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    slack = _AT_END * length[None]
    with np.errstate(divide="ignore", invalid="ignore"):
        for end in (0, 1):
            corner = edges.end if end else ring
            to = corner[None] - centre[:, None]
            half = np.arccos(np.hypot(to[..., 0], to[..., 1]) / (2.0 * radius))
            for sign in (-1.0, 1.0):
                angle = np.arctan2(to[..., 1], to[..., 0]) + sign * half
                beyond = ((point(angle) - corner[None]) * way[None]).sum(axis=2)
                meet(angle, (half > 0.0) & (beyond >= -slack if end else beyond <= slack))
        height = -(off * out[None]).sum(axis=2)
        for side in (-1.0, 1.0):
            half = np.arccos(side - height / radius)
            for sign in (-1.0, 1.0):
                angle = np.arctan2(out[:, 1], out[:, 0])[None] + sign * half
                foot = ((point(angle) - ring[None]) * way[None]).sum(axis=2)
                meet(angle, np.isfinite(half) & (foot >= -slack) & (foot <= length[None] + slack))
    return nearest, low, high


def _left(
    low: FloatArray, high: FloatArray, length: float, least: float
) -> list[tuple[float, float]]:
    """What of [0, length] no interval (low, high) covers, but for what is below ``least``."""
    use = np.flatnonzero((low < length) & (high > 0.0) & (high - low > 0.0))
    found: list[tuple[float, float]] = []
    at = 0.0
    for k in use[np.argsort(low[use], kind="stable")].tolist():
        if low[k] - at > least:
            found.append((at, float(low[k])))
        at = max(at, float(high[k]))
    if length - at > least:
        found.append((at, length))
    return found


def _chained(pieces: list[Element], size: float) -> list[list[Element]]:
    """The rings that elements form, each beginning where the one before ends."""
    first = np.array([e.first for e in pieces])
    last = np.array([e.last for e in pieces])
    far = np.hypot(*(last[:, None] - first[None]).transpose(2, 0, 1))
    after: IntArray = np.argmin(far, axis=1).astype(np.int64)
    gap = far[np.arange(len(pieces)), after]
    if float(gap.max()) > _JOINED * size or len(set(after.tolist())) < len(pieces):
        raise GeometryError("the grown object's boundary does not close")
    rings: list[list[Element]] = []
    left = set(range(len(pieces)))
    while left:
        k = min(left)
        ring: list[Element] = []
        while k in left:
            left.remove(k)
            ring.append(pieces[k])
            k = int(after[k])
        rings.append(ring)
    return rings


def _area(ring: list[Element]) -> float:
    """Signed area, [unit^2], arcs as chords through their middles; enough to tell rings apart."""
    x, y = np.array([p for e in ring for p in (e.first, e.middle)]).T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
