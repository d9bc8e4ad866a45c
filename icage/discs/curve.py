"""The true curve of disc fingers: the boundary of the grown object, and polygons drawn from it.

Chords in place of its arcs lie inside it, tangents outside; both keep all its corners, exact to
rounding, with no union of polygons. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.discs.arc_stops import even_parts, graded_stops, unit_vectors
from icage.discs.edges import Edges
from icage.discs.elements import Elements, outer_ring
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
    elements: Elements
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
        # kernels are compiled for arrays that may be written to
        ring = np.array(without_straight_vertices(outline.vertices, outline.diameter))
        elements, closed = outer_ring(Edges.of(ring), radius, outline.diameter)
        found = cls(outline, radius, ring, elements, closed)
        found._check()
        return found

    def _check(self) -> None:
        """Every end and middle of an element is at the radius from the object."""
        points = np.concatenate([self.elements.first, self.elements.middle])
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
        arc, at = self._stops(segments, through)
        follows = arc[1:] == arc[:-1]
        inside = np.flatnonzero(follows[1:] & follows[:-1]) + 1
        return self._ring(arc[inside], at[inside], np.full(len(inside), self.radius))

    def outer(self, segments: int, through: FloatArray | None = None) -> Outline:
        """Tangents for the arcs: outside the curve, with all its corners; see ``inner``.

        Raises
        ------
        GeometryError:
            The tangents of two arcs run into each other: more segments are needed.
        """
        arc, at = self._stops(segments, through, touched=True)
        begin = np.flatnonzero(arc[1:] == arc[:-1])
        step = at[begin + 1] - at[begin]
        reach = self.radius / np.cos(0.5 * step)
        return self._ring(arc[begin], at[begin] + 0.5 * step, reach)

    def sagitta(self, segments: int) -> float:
        """Most that the inner polygon may lie inside the curve, [unit]."""
        turn = self.elements.turn
        widest = float((turn / even_parts(turn, segments)).max(initial=0.0))
        return self.radius * (1.0 - math.cos(0.5 * widest))

    def on_arcs(self, contacts: FloatArray) -> FloatArray:
        """Those of the points (k, 2) that are on an arc."""
        _, on = self._angles(contacts)
        return contacts[on.any(axis=0)]

    def distance(self, points: FloatArray) -> FloatArray:
        """Distance (k,) of points (k, 2) from the curve, [unit]."""
        every = self.elements
        to = points - every.first[:, None]
        side = every.last - every.first
        t = (to * side[:, None]).sum(axis=2)
        t = np.clip(t / np.maximum((side**2).sum(axis=1), 1e-300)[:, None], 0.0, 1.0)
        is_arc = every.turn > 0.0
        t[is_arc] = np.round(t[is_arc])  # of an arc its ends
        off = to - t[..., None] * side[:, None]
        least = np.hypot(off[..., 0], off[..., 1]).min(axis=0)
        off = points - self.ring[every.number[is_arc], None]
        far = np.hypot(off[..., 0], off[..., 1])
        angle = np.arctan2(off[..., 1], off[..., 0]) - every.angle[is_arc, None]
        over = angle % (2.0 * math.pi) <= every.turn[is_arc, None]
        gap = np.where(over, np.abs(far - self.radius), np.inf)
        return np.minimum(least, gap.min(axis=0, initial=np.inf))

    def _ring(self, arc: IntArray, at: FloatArray, reach: FloatArray) -> Outline:
        """The corners of the curve, and in each arc (element) the points at these angles [rad] from
        its start and distances from its vertex.
        """
        every = self.elements
        over = self.ring[every.number[arc]]
        over = over + reach[:, None] * unit_vectors(every.angle[arc] + at)
        order = np.argsort(np.concatenate([np.arange(len(every)), arc]), kind="stable")
        return Outline.computed(np.concatenate([every.first, over])[order])

    def _stops(
        self, segments: int, through: FloatArray | None, *, touched: bool = False
    ) -> tuple[IntArray, FloatArray]:
        """Element, ascending, and angle [rad] from its start of all points where arcs are split,
        both ends among them.
        """
        turn = self.elements.turn
        parts = even_parts(turn, segments)
        parts[turn == 0.0] = -1
        graded = {} if through is None else self._on_elements(through)
        parts[list(graded)] = -1
        arc = np.repeat(np.arange(len(turn)), parts + 1)
        place = np.arange(len(arc)) - np.repeat(np.cumsum(parts + 1) - parts - 1, parts + 1)
        at = place * (turn / parts)[arc]
        if not graded:
            return arc, at
        stops = {
            k: graded_stops(float(turn[k]), segments, angles, touched=touched)
            for k, angles in graded.items()
        }
        arc = np.concatenate([arc, np.repeat(list(stops), [len(one) for one in stops.values()])])
        order = np.argsort(arc, kind="stable")
        return arc[order], np.concatenate([at, *stops.values()])[order]

    def _angles(self, points: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Angles [rad] of points (k, 2) from the start of every element, and on which arcs they
        are, (elements, k) both.
        """
        every = self.elements
        off = points - self.ring[every.number, None]
        far = np.hypot(off[..., 0], off[..., 1])
        t = (np.arctan2(off[..., 1], off[..., 0]) - every.angle[:, None]) % (2.0 * math.pi)
        on = np.abs(far - self.radius) <= CONTACT_OFF * self.outline.diameter
        return t, on & (t > _AT_END) & (t < every.turn[:, None] - _AT_END)

    def _on_elements(self, points: FloatArray) -> dict[int, list[float]]:
        """Element -> angles from its start at which points (k, 2) are on it, of the arcs."""
        t, on = self._angles(points)
        return {int(k): t[k, on[k]].tolist() for k in np.flatnonzero(on.any(axis=1))}
