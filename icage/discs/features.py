"""Edges and convex vertices that the fingers of a hand touch, and the gaps that they leave it.

A hand is v = (d, w), and the gap g(v) of a feature is the distance of a finger from a straight edge
or from a convex vertex, less the radius. Arcs run into edges without a kink and corners of the
curve are concave, so gaps are smooth and free space near a hand is where none is negative. Our own.
[docs/theory.md, Sec. 4]
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.discs.balance import finger_maps
from icage.discs.edges import Edges
from icage.discs.kernels.features import Sides, near_features
from icage.geometry.exterior import without_straight_vertices
from icage.hand import HandShape
from icage.kernels.locate import depth_inside
from icage.outline import Outline

_OF_HALF_SQUARE = np.diag([0.0, 0.0, 1.0, 1.0])
"""Second derivative of w . w / 2."""


class Feature(NamedTuple):
    """Finger ``finger`` (0..) at an edge or at a vertex of the outline, by number."""

    finger: int
    number: int
    is_arc: bool


class Chosen(NamedTuple):
    """Some features as arrays: of m of them the maps (m, 2, 4) of their fingers, a point (m, 2)
    that each goes through, normals (m, 2) of the edges, and which are arcs, (m,).
    """

    maps: FloatArray
    point: FloatArray
    out: FloatArray
    is_arc: BoolArray


class Gaps(NamedTuple):
    """Gaps (m,) of features, their unit normals (m, 2) and slopes (m, 4), the derivatives by v."""

    value: FloatArray
    normal: FloatArray
    slope: FloatArray


class Features:
    """The features of one outline for the fingers of one hand and radius.

    Lengths inside are in diameters, from the middle of the outline; so are hands v (4,).
    """

    def __init__(self, outline: Outline, radius: float, hand: HandShape) -> None:
        self.size = outline.diameter
        self.radius = radius / self.size
        ring = without_straight_vertices(outline.vertices, self.size)
        self._origin = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
        self._ring = np.ascontiguousarray((ring - self._origin) / self.size)
        self._edges = edges = Edges.of(self._ring)
        self._hand = hand
        self._maps = finger_maps(hand)
        self.sides = Sides(
            edges.start, edges.length, edges.way, edges.out, edges.convex, self._maps, self.radius
        )

    # ------------------------------------------------------------------ hands

    def scaled(self, contacts: FloatArray) -> FloatArray:
        """Contacts (..., 2) [unit] in diameters."""
        return (contacts - self._origin) / self.size

    def as_hand(self, contacts: FloatArray) -> FloatArray:
        """The hands v (..., 4) with contacts (..., fingers, 2) [unit]."""
        at = self.scaled(contacts)
        return np.concatenate([at[..., 0, :], at[..., 1, :] - at[..., 0, :]], axis=-1)

    def as_contacts(self, v: FloatArray) -> FloatArray:
        """Contacts (fingers, 2) [unit] of a hand."""
        f = (v[0] + 1j * v[1]) + (v[2] + 1j * v[3]) * self._hand.z
        return np.column_stack([f.real, f.imag]) * self.size + self._origin

    def fingers(self, v: FloatArray) -> FloatArray:
        """The finger centres (fingers, 2) of a hand, or their moves for a change of it."""
        return self._maps @ v

    def longest_move(self, step: FloatArray) -> float:
        """How far the finger moves that moves furthest, if v changes by ``step`` (4,)."""
        return float(np.hypot(*self.fingers(step).T).max())

    def depths(self, contacts: FloatArray) -> FloatArray:
        """How far points (k, 2) [unit] are inside the curve, negative outside, (k,)."""
        return depth_inside(self._ring, self.scaled(contacts), self.radius)

    # ------------------------------------------------------------------ which

    def named(self, which: IntArray) -> list[Feature]:
        """The features with these numbers (m,), as the kernels have them."""
        n = len(self._ring)
        return [Feature(k // (2 * n), k % n, bool(k % (2 * n) >= n)) for k in which.tolist()]

    def numbers(self, features: list[Feature]) -> IntArray:
        """The numbers (m,) of features."""
        n = len(self._ring)
        return np.array([2 * n * f.finger + n * f.is_arc + f.number for f in features], np.int64)

    def near(self, v: FloatArray, reach: float) -> list[Feature]:
        """Features within ``reach`` of being touched, of all fingers."""
        return self.named(near_features(self.sides, v, reach, reach))

    def beside(self, v: FloatArray, feature: Feature, slack: float) -> Feature | None:
        """The next feature along the curve, if a finger is more than ``slack`` past its end.

        Off the end of an edge that is its vertex, off the end of an arc the edge beside it. The
        vertex may be one that is not convex, and so no feature at all.
        """
        finger, q, is_arc = feature
        way, n = self._edges.way, len(self._ring)
        off = self._maps[finger] @ v - self._ring[q]
        along = float(off @ way[q])
        if not is_arc:
            if along < -slack:
                return Feature(finger, q, True)
            if along > self._edges.length[q] + slack:
                return Feature(finger, (q + 1) % n, True)
        elif along > slack:
            return Feature(finger, q, False)
        elif float(off @ way[q - 1]) < -slack:
            return Feature(finger, (q - 1) % n, False)
        return None

    def edges_at(self, v: FloatArray, arc: Feature, within: float) -> list[Feature]:
        """The edges that an arc goes over into where the finger that touches it is ``within``."""
        finger, q, _ = arc
        at = self._maps[finger] @ v - self._ring[q]
        beside = ((q - 1) % len(self._ring), q)
        return [
            Feature(finger, edge, False)
            for edge in beside
            if float(np.hypot(*(at - self.radius * self._edges.out[edge]))) <= within
        ]

    def exists(self, feature: Feature) -> bool:
        """Whether it is an edge or a vertex that is convex."""
        return not feature.is_arc or bool(self._edges.convex[feature.number])

    def deepest(self, v: FloatArray, least: float) -> Feature | None:
        """The feature that a finger is deepest inside, if any is deeper than ``least``."""
        points = self.fingers(v)
        depth = depth_inside(self._ring, points, self.radius)
        k = int(np.argmax(depth))
        if depth[k] <= least:
            return None
        off, t = self._from_edges(points[k])
        q = int(np.argmin(np.hypot(*off.T)))
        if t[q] <= 0.0 or t[q] >= self._edges.length[q]:
            vertex = Feature(k, q if t[q] <= 0.0 else (q + 1) % len(self._ring), True)
            if self.exists(vertex):
                return vertex
        return Feature(k, q, False)

    # ------------------------------------------------------------------ gaps

    def chosen(self, features: list[Feature]) -> Chosen:
        """Features as arrays, for several hands."""
        number = [f.number for f in features]
        return Chosen(
            self._maps[[f.finger for f in features]],
            self._ring[number],
            self._edges.out[number],
            np.array([f.is_arc for f in features], dtype=bool),
        )

    def gaps(self, v: FloatArray, features: list[Feature]) -> Gaps:
        """The gaps that features leave a hand."""
        return self.gaps_of(v, self.chosen(features))

    def gaps_of(self, v: FloatArray, chosen: Chosen) -> Gaps:
        """The same for features that were chosen before."""
        off = chosen.maps @ v - chosen.point
        x, y = off.T
        far = np.hypot(x, y)
        normals = np.where(
            chosen.is_arc[:, None], off / np.maximum(far, 1e-300)[:, None], chosen.out
        )
        value = normals[:, 0] * x + normals[:, 1] * y - self.radius
        return Gaps(value, normals, (normals[:, None] @ chosen.maps)[:, 0])

    def curvature(self, chosen: Chosen, gaps: Gaps, force: FloatArray) -> FloatArray:
        """Second derivative (4, 4) of w . w / 2 - sum of force times gap."""
        hessian = _OF_HALF_SQUARE.copy()
        if chosen.is_arc.any():
            normal = gaps.normal[chosen.is_arc]
            across = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
            rows = (across[:, None] @ chosen.maps[chosen.is_arc])[:, 0]
            bend = (force / (self.radius + gaps.value))[chosen.is_arc]
            hessian -= (rows.T * bend) @ rows
        return hessian

    def _from_edges(self, point: FloatArray) -> tuple[FloatArray, FloatArray]:
        """To a point from the nearest points of all edges (n, 2), and where these are on them."""
        edges = self._edges
        off = point - edges.start
        t = np.clip((off * edges.way).sum(axis=1), 0.0, edges.length)
        return off - t[:, None] * edges.way, t
