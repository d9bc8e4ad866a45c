"""The true curve of disc fingers: the boundary of the grown object as straight edges and arcs.

Every edge moved out by the radius and every arc round a convex vertex is cut where another edge of
the object comes nearer than the radius. The set of points of a line, or of an arc of this very
radius, that are nearer than the radius to one segment is a single interval, so its two ends are
found in closed form. What is left are the elements of the curve, and where two of them meet, its
corners: exact to rounding, with no union of polygons. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.errors import GeometryError
from icage.geometry.exterior import without_straight_vertices
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import COLLISION, CONTACT_OFF

_JOINED = 1e-9
"""[diameter] Ends of elements this near to each other are one corner."""

_NOTHING = 1e-12
"""[diameter] An element this short is rounding."""

_AT_END = 1e-12
"""[1] A crossing is taken to lie on a segment if its foot is this little beyond the end."""

_PARALLEL = 1e-12
"""[1] Sine of an angle between two edges that is none."""

_WHOLE = 1e-6
"""[segment] An arc this little longer than a whole number of segments gets no further one."""

_RESTING = 1e-3
"""[rad] Half the chord on which a contact of an arc rests, so that it has the arc's own normal
there; 5e-7 radii inside the arc."""

_GRADED = 3.0
"""[1] Beyond the resting chord each segment ends this many times as far from the contact: chords
are then flat against the distance from it, and levels there are those of the true curve."""


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


@dataclass(frozen=True, slots=True)
class TrueCurve:
    """The outer boundary of an outline grown by the radius of a finger."""

    outline: Outline
    radius: float
    ring: FloatArray
    """(n, 2) the outline without straight vertices."""
    elements: tuple[Element, ...]
    closed_pockets: int

    @classmethod
    def of(cls, outline: Outline, radius: float) -> TrueCurve:
        """Grow an outline.

        Raises
        ------
        GeometryError:
            The elements do not close: two parts of the object are exactly two radii apart, or
            nearly so, and rounding decides.
        """
        ring = without_straight_vertices(outline.vertices, outline.diameter)
        pieces = _lines(ring, radius, outline.diameter) + _arcs(ring, radius, outline.diameter)
        rings = _chained(pieces, outline.diameter)
        area = [_area(one) for one in rings]
        outer = int(np.argmax(area))
        holes = sum(a < -_JOINED * outline.diameter**2 for a in area)
        found = cls(outline, radius, ring, tuple(rings[outer]), holes)
        found._check()
        return found

    def _check(self) -> None:
        """Every end and middle of an element is at the radius from the object."""
        points = [e.first for e in self.elements]
        points += [_middle(e, self.ring, self.radius) for e in self.elements]
        centre = self.ring.mean(axis=0)
        depth = depth_inside(self.ring - centre, np.array(points) - centre, self.radius)
        worst = float(np.abs(depth).max())
        if worst > COLLISION * self.outline.diameter:
            raise GeometryError(f"growing the outline by {self.radius} is off by {worst}")

    def inner(self, segments: int, through: FloatArray | None = None) -> Outline:
        """Chords for the arcs: inside the curve, with all its corners.

        ``segments`` a quadrant at least; on an arc that one of the points ``through`` (k, 2) is on,
        that point lies over the middle of a short chord and the others are graded.
        """
        rows: list[FloatArray] = []
        wanted = self._on_elements(through)
        for k, e in enumerate(self.elements):
            rows.append(e.first[None])
            if e.turn:
                at = _stops(e.turn, segments, wanted.get(k, []))[1:-1]
                rows.append(self.ring[e.number] + self.radius * _unit(e.angle + at))
        return Outline.computed(np.vstack(rows))

    def outer(self, segments: int, through: FloatArray | None = None) -> Outline:
        """Tangents for the arcs: outside the curve, with all its corners; see ``inner``.

        Raises
        ------
        GeometryError:
            The tangents of two arcs run into each other: more segments are needed.
        """
        rows: list[FloatArray] = []
        wanted = self._on_elements(through)
        for k, e in enumerate(self.elements):
            rows.append(e.first[None])
            if e.turn:
                at = _stops(e.turn, segments, wanted.get(k, []), touched=True)
                step = np.diff(at)
                reach = self.radius / np.cos(0.5 * step)
                way = _unit(e.angle + at[:-1] + 0.5 * step)
                rows.append(self.ring[e.number] + reach[:, None] * way)
        grown = Outline.computed(np.vstack(rows))
        if not grown.polygon.is_valid:
            raise GeometryError("tangents of two arcs cross")
        return grown

    def sagitta(self, segments: int) -> float:
        """Most that the inner polygon may lie inside the curve, [unit]."""
        steps = [float(_stops(e.turn, segments, [])[1]) for e in self.elements if e.turn]
        return self.radius * (1.0 - math.cos(0.5 * max(steps, default=0.0)))

    def on_arcs(self, contacts: FloatArray) -> FloatArray:
        """Those of the points (k, 2) that are on an arc."""
        on = [p for p in contacts if self._on_elements(p[None])]
        return np.array(on).reshape(-1, 2)

    def distance(self, points: FloatArray) -> FloatArray:
        """Distance (k,) of points (k, 2) from the curve, [unit]."""
        least = np.full(len(points), np.inf)
        for e in self.elements:
            if e.turn:
                off = points - self.ring[e.number]
                far = np.hypot(off[:, 0], off[:, 1])
                t = (np.arctan2(off[:, 1], off[:, 0]) - e.angle) % (2.0 * math.pi)
                least = np.where(t <= e.turn, np.minimum(least, np.abs(far - self.radius)), least)
            side = e.last - e.first
            t = np.clip((points - e.first) @ side / max(float(side @ side), 1e-300), 0.0, 1.0)
            if e.turn:
                t = np.round(t)  # of an arc its ends
            near = np.hypot(*(e.first + t[:, None] * side - points).T)
            least = np.minimum(least, near)
        return least

    def _on_elements(self, points: FloatArray | None) -> dict[int, list[float]]:
        """Element -> angles from its start at which points (k, 2) are on it, of the arcs."""
        found: dict[int, list[float]] = {}
        if points is None:
            return found
        near = CONTACT_OFF * self.outline.diameter
        for x, y in points.tolist():
            far = np.hypot(self.ring[:, 0] - x, self.ring[:, 1] - y)
            for v in np.flatnonzero(np.abs(far - self.radius) <= near).tolist():
                direction = math.atan2(y - self.ring[v, 1], x - self.ring[v, 0])
                for k, e in enumerate(self.elements):
                    if e.turn and e.number == v:
                        t = (direction - e.angle) % (2.0 * math.pi)
                        if _NOTHING < t < e.turn - _NOTHING:
                            found.setdefault(k, []).append(t)
        return found


def _stops(
    turn: float, segments: int, contacts: list[float], *, touched: bool = False
) -> FloatArray:
    """Angles from 0 to ``turn`` that split an arc, at the contacts on it too if ``touched``.

    Round every contact a short chord, then longer and longer ones up to the common length.
    """
    coarse = 0.5 * math.pi / segments
    if not contacts:
        return np.linspace(0.0, turn, max(1, math.ceil(turn / coarse - _WHOLE)) + 1)
    resting = sorted(set(contacts))
    stops = [0.0, turn]
    for k, t in enumerate(resting):
        room = [abs(t - u) / 3.0 for u in resting[max(0, k - 1) : k + 2] if u != t]
        half = min([_RESTING, t, turn - t, *room])
        while half < coarse:
            stops += [t - half, t + half]
            half *= _GRADED
    # a stop inside the resting chord of another contact would spoil it
    kept = [
        s
        for s in sorted(set(stops))
        if 0.0 <= s <= turn
        and all(
            abs(s - t) >= 0.999 * min(_RESTING, t, turn - t) or _own(s, t, resting) for t in resting
        )
    ]
    if touched:
        kept = sorted({*kept, *resting})
    angles = [0.0]
    for low, high in pairwise(kept):
        parts = max(1, math.ceil((high - low) / coarse - _WHOLE))
        angles.extend(np.linspace(low, high, parts + 1)[1:].tolist())
    return np.array(angles)


def _own(stop: float, contact: float, resting: list[float]) -> bool:
    """Whether a stop belongs to the contact it is nearest to."""
    return min(resting, key=lambda t: abs(t - stop)) == contact


def _unit(angle: FloatArray) -> FloatArray:
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _middle(e: Element, ring: FloatArray, radius: float) -> FloatArray:
    if not e.turn:
        return 0.5 * (e.first + e.last)
    return ring[e.number] + radius * _unit(np.array([e.angle + 0.5 * e.turn]))[0]


def _turns(ring: FloatArray) -> FloatArray:
    """Turn (n,) [rad] of the outline at each vertex, positive where it is convex."""
    side = np.roll(ring, -1, axis=0) - ring
    back = np.roll(side, 1, axis=0)
    cross = back[:, 0] * side[:, 1] - back[:, 1] * side[:, 0]
    return np.arctan2(cross, (back * side).sum(axis=1))


def _lines(ring: FloatArray, radius: float, size: float) -> list[Element]:
    """What is left of every edge moved out."""
    n = len(ring)
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(side[:, 0], side[:, 1])
    way = side / length[:, None]
    out = np.column_stack([way[:, 1], -way[:, 0]])
    start = ring + radius * out
    low, high = _covered_lines(ring, way, out, length, start, radius, size)
    index = np.arange(n)
    low[index, index] = np.inf
    convex = _turns(ring) > 0.0
    low[index[convex], index[convex] - 1] = np.inf
    low[index[convex] - 1, index[convex]] = np.inf
    found: list[Element] = []
    for q in range(n):
        for a, b in _left(low[q], high[q], float(length[q]), _NOTHING * size):
            found.append(Element(q, start[q] + a * way[q], start[q] + b * way[q], 0.0, 0.0))
    return found


def _covered_lines(
    ring: FloatArray, way: FloatArray, out: FloatArray, length: FloatArray, start: FloatArray,
    radius: float, size: float,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Interval (n, n) of each moved edge (row) that is nearer than the radius to each edge."""
    n = len(ring)
    low, high = np.full((n, n), np.inf), np.full((n, n), -np.inf)

    def meet(t: FloatArray, valid: BoolArray) -> None:
        low[valid] = np.minimum(low, t)[valid]
        high[valid] = np.maximum(high, t)[valid]

    with np.errstate(divide="ignore", invalid="ignore"):
        for end in (0, 1):
            corner = np.roll(ring, -1, axis=0) if end else ring
            off = corner[None] - start[:, None]
            along = (off * way[:, None]).sum(axis=2)
            across = (off * out[:, None]).sum(axis=2)
            half = np.sqrt(radius**2 - across**2)
            for sign in (-1.0, 1.0):
                t = along + sign * half
                point = start[:, None] + t[..., None] * way[:, None]
                beyond = ((point - corner[None]) * way[None]).sum(axis=2)
                slack = _AT_END * length[None]
                meet(t, (half > 0.0) & (beyond >= -slack if end else beyond <= slack))
        gap = ((start[:, None] - ring[None]) * out[None]).sum(axis=2)
        slope = (way[:, None] * out[None]).sum(axis=2)
        for sign in (-1.0, 1.0):
            t = (sign * radius - gap) / slope
            point = start[:, None] + t[..., None] * way[:, None]
            foot = ((point - ring[None]) * way[None]).sum(axis=2)
            slack = _AT_END * length[None]
            steep = np.abs(slope) > _PARALLEL
            meet(t, steep & (foot >= -slack) & (foot <= length[None] + slack))
        # a slot that the finger fits into with no room to spare is closed
        tight = (np.abs(slope) <= _PARALLEL) & (np.abs(gap - radius) <= _NOTHING * size)
        tight &= (way[:, None] * way[None]).sum(axis=2) < 0.0
        along = ((ring[None] - start[:, None]) * way[:, None]).sum(axis=2)
        meet(along, tight)
        meet(along - length[None], tight)
    return low, high


def _arcs(ring: FloatArray, radius: float, size: float) -> list[Element]:
    """What is left of the arc round every convex vertex."""
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(side[:, 0], side[:, 1])
    way = side / length[:, None]
    turns = _turns(ring)
    convex = np.flatnonzero(turns > 0.0)
    begin = np.arctan2(way[convex - 1, 1], way[convex - 1, 0]) - 0.5 * math.pi
    nearest, low, high = _covered_arcs(ring, way, length, ring[convex], radius)
    row = np.arange(len(convex))
    high[row, convex], high[row, convex - 1] = -np.inf, -np.inf
    low[row, convex], low[row, convex - 1] = np.inf, np.inf
    # from the start of the arc; an interval may begin before it
    middle = (nearest - begin[:, None] + math.pi) % (2.0 * math.pi) - math.pi
    found: list[Element] = []
    for k, v in enumerate(convex.tolist()):
        a, b = middle[k] + low[k], middle[k] + high[k]
        again = 2.0 * math.pi
        lows, highs = np.concatenate([a, a + again]), np.concatenate([b, b + again])
        turn = float(turns[v])
        for first, last in _left(lows, highs, turn, _NOTHING * size / radius):
            angle = float(begin[k]) + first
            ends = ring[v] + radius * _unit(np.array([angle, float(begin[k]) + last]))
            found.append(Element(v, ends[0], ends[1], angle, last - first))
    return found


def _covered_arcs(
    ring: FloatArray, way: FloatArray, length: FloatArray, centre: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where circles (rows) are nearer than the radius to edges (columns), [rad].

    The direction of the edge's nearest point, and how far the interval goes to either side of it.
    """
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
            corner = np.roll(ring, -1, axis=0) if end else ring
            to = corner[None] - centre[:, None]
            half = np.arccos(np.hypot(to[..., 0], to[..., 1]) / (2.0 * radius))
            for sign in (-1.0, 1.0):
                angle = np.arctan2(to[..., 1], to[..., 0]) + sign * half
                beyond = ((point(angle) - corner[None]) * way[None]).sum(axis=2)
                meet(angle, (half > 0.0) & (beyond >= -slack if end else beyond <= slack))
        out = np.column_stack([way[:, 1], -way[:, 0]])
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
    points: list[FloatArray] = []
    for e in ring:
        points.append(e.first)
        if e.turn:
            # the middle of the arc over the middle of its chord
            half = 0.5 * (e.last - e.first)
            rise = math.tan(0.25 * e.turn)
            points.append(0.5 * (e.first + e.last) + rise * np.array([half[1], -half[0]]))
    x, y = np.array(points).T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
