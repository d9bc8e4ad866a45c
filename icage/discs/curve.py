"""The true curve of disc fingers: the boundary of the grown object, and polygons drawn from it.

Chords in place of its arcs lie inside it, tangents outside; both keep all its corners, exact to
rounding, with no union of polygons. Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.discs.edges import Edges
from icage.discs.elements import Elements, outer_ring
from icage.discs.kernels.arc_stops import (
    OnArcs,
    near_arcs,
    on_arcs,
    ring_with,
    split_arcs,
    widest_part,
)
from icage.errors import GeometryError
from icage.geometry.exterior import without_straight_vertices
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.tolerance import COLLISION, CONTACT_OFF


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
        return self._drawn(segments, through, touched=False)

    def outer(self, segments: int, through: FloatArray | None = None) -> Outline:
        """Tangents for the arcs: outside the curve, with all its corners; see ``inner``.

        Raises
        ------
        GeometryError:
            The tangents of two arcs run into each other: more segments are needed.
        """
        return self._drawn(segments, through, touched=True)

    def sagitta(self, segments: int) -> float:
        """Most that the inner polygon may lie inside the curve, [unit]."""
        return self.radius * (1.0 - math.cos(0.5 * widest_part(self.elements.turn, segments)))

    def on_arcs(self, contacts: FloatArray) -> FloatArray:
        """Those of the points (k, 2) that are on an arc."""
        on = np.zeros(len(contacts), dtype=np.bool_)
        on[self._found_on_arcs(contacts).point] = True
        return contacts[on]

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

    def _drawn(self, segments: int, through: FloatArray | None, *, touched: bool) -> Outline:
        """Chords for the arcs, or tangents, which are ``touched`` at their middles."""
        every = self.elements
        on = self._found_on_arcs(np.empty((0, 2)) if through is None else through)
        over = split_arcs(every.turn, segments, on, touched)
        direction = every.angle[over.element] + over.angle
        reach = self.radius / np.cos(over.half)
        ring = ring_with(
            every, self.ring, over.element, np.cos(direction), np.sin(direction), reach
        )
        return Outline.computed(ring)

    def _found_on_arcs(self, points: FloatArray) -> OnArcs:
        """Which of the points (k, 2) are on arcs, and where."""
        slack = CONTACT_OFF * self.outline.diameter
        # kernels are compiled for arrays that may be written to
        points = np.array(points, dtype=np.float64)
        near = near_arcs(self.elements, self.ring, self.radius, points, slack)
        return on_arcs(self.elements, near, np.arctan2(near.way_y, near.way_x))
