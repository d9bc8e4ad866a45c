"""The true curve of disc fingers: the boundary of the grown object, and polygons drawn from it.

Chords in place of its arcs lie inside it, tangents outside; both keep all its corners, exact to
rounding, with no union of polygons. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.discs.arc_stops import even_stops, graded_stops, unit_vectors
from icage.discs.edges import Edges
from icage.discs.elements import Element, outer_ring
from icage.errors import GeometryError
from icage.geometry.exterior import without_straight_vertices
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import COLLISION, CONTACT_OFF

_AT_END = 1e-12
"""[rad] A contact this near to the end of an arc counts as at the end."""


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
        elements, closed = outer_ring(Edges.of(ring), radius, outline.diameter)
        found = cls(outline, radius, ring, elements, closed)
        found._check()
        return found

    def _check(self) -> None:
        """Every end and middle of an element is at the radius from the object."""
        points = np.array([p for e in self.elements for p in (e.first, e.middle)])
        centre = self.ring.mean(axis=0)
        depth = depth_inside(self.ring - centre, points - centre, self.radius)
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
                at = graded_stops(e.turn, segments, wanted.get(k, []))[1:-1]
                rows.append(self.ring[e.number] + self.radius * unit_vectors(e.angle + at))
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
                at = graded_stops(e.turn, segments, wanted.get(k, []), touched=True)
                step = np.diff(at)
                reach = self.radius / np.cos(0.5 * step)
                way = unit_vectors(e.angle + at[:-1] + 0.5 * step)
                rows.append(self.ring[e.number] + reach[:, None] * way)
        grown = Outline.computed(np.vstack(rows))
        if not grown.polygon.is_valid:
            raise GeometryError("tangents of two arcs cross")
        return grown

    def sagitta(self, segments: int) -> float:
        """Most that the inner polygon may lie inside the curve, [unit]."""
        steps = [float(even_stops(e.turn, segments)[1]) for e in self.elements if e.turn]
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
                        if _AT_END < t < e.turn - _AT_END:
                            found.setdefault(k, []).append(t)
        return found
