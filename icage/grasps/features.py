"""Where a finger can carry force: straight edges and concave vertices. [Bunis2018, Sec. VII-A]

A grasp balances when the lines of force meet in one point P and the inward normals positively span
the plane. For an edge, P must lie in the strip over it; for a concave vertex, in the double cone
of its normals, here as two features, one for each side. (The paper's semi-infinite sectors are
sufficient, not necessary, and do not tell squeezing from stretching.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.grasps.kernels.hands import HandLimits
from icage.grasps.kernels.triples import (
    EDGE,
    VERTEX,
    contact_at,
    feasible_triples,
    points_of_triple,
)
from icage.outline import Outline

_REACH = 3.0
"""[diameter] Points of concurrency further than this from the object's middle are not looked at:
lines that meet there are nearly parallel, and such a grasp hardly holds an orientation."""

_CONCAVE = 1e-6
"""[1] Sine of the turn below which a vertex counts as straight: its double cone is as thin."""

_NO_SUM = 1e-9
"""[1] What the sum of two unit normals is divided by at least: at a vertex that turns right back it
is 0 and has no direction."""

_NEAR = 1.6
"""[diameter] Nearer than this to the object's middle they are looked for ..."""

_STEP = 0.1
"""[diameter] ... this far apart, where the middle of the set and its surroundings hold nothing."""


class Features(NamedTuple):
    """Contact features as arrays; ``planes`` (n, 2, 3) are a x + b y >= c for P."""

    kind: IntArray
    number: IntArray
    point: FloatArray
    normal: FloatArray
    planes: FloatArray

    def contacts(self, triple: IntArray, p: FloatArray) -> FloatArray:
        """Finger positions (3, 2) of a triple of features for a concurrency point P."""
        rows = [contact_at(self.kind[f], self.point[f], self.normal[f], p[0], p[1]) for f in triple]
        return np.array([(row.x, row.y) for row in rows])

    def feet(self, points: FloatArray) -> FloatArray:
        """(n, features, 2) finger positions on all features for points of concurrency (n, 2)."""
        gap = points[:, None, :] - self.point
        along = (gap * self.normal).sum(axis=2)
        on_edge = points[:, None, :] - along[..., None] * self.normal
        return np.where((self.kind == EDGE)[None, :, None], on_edge, self.point)

    def allows(self, triple: IntArray, p: FloatArray) -> bool:
        """Whether P lies in the sets of all three features."""
        planes = self.planes[triple].reshape(-1, 3)
        return bool((planes[:, 0] * p[0] + planes[:, 1] * p[1] >= planes[:, 2]).all())


_NEIGHBOURS = (1, -1, 2, -2, 3, -3)
"""Features along the outline that may take a finger over, nearest first."""


def neighbours(features: Features) -> IntArray:
    """(n, k) features that follow or precede each along the outline, nearest first."""
    place = features.number + np.where(features.kind == EDGE, 0.5, 0.0)
    order = np.argsort(place, kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return order[(rank[:, None] + np.array(_NEIGHBOURS)) % len(order)]


def features_of(
    outline: Outline,
    *,
    longer_than: float = 0.0,
    arc: tuple[FloatArray, float, float] | None = None,
) -> Features:
    """Edges (longer than a bound) and concave vertices.

    ``arc`` (centres (n, 2), radius, sagitta): chords of arcs of this radius round one of the
    centres, perhaps cut short, are no edges.
    """
    a = outline.vertices
    b = np.roll(a, -1, axis=0)
    side = b - a
    length = np.hypot(side[:, 0], side[:, 1])
    tangent = side / length[:, None]
    inward = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    edges = np.flatnonzero((length > longer_than) & ~_are_chords(a, b, arc, outline.diameter))
    strips = np.stack(
        [
            np.column_stack([tangent, (tangent * a).sum(axis=1)]),
            np.column_stack([-tangent, -(tangent * b).sum(axis=1)]),
        ],
        axis=1,
    )
    back = np.roll(tangent, 1, axis=0)
    before = np.roll(inward, 1, axis=0)
    turn = back[:, 0] * tangent[:, 1] - back[:, 1] * tangent[:, 0]
    concave = np.flatnonzero(turn < -_CONCAVE)
    # a concave corner turns clockwise: its normals run counterclockwise from this edge's to the
    # one before
    low, high = inward[concave], before[concave]
    cone = np.stack(
        [np.column_stack([-low[:, 1], low[:, 0]]), np.column_stack([high[:, 1], -high[:, 0]])],
        axis=1,
    )
    bound = (cone * a[concave][:, None, :]).sum(axis=2)
    cones = np.concatenate([cone, bound[:, :, None]], axis=2)
    middle = (low + high) / np.maximum(np.hypot(*(low + high).T), _NO_SUM)[:, None]
    return Features(
        kind=np.repeat([EDGE, VERTEX, VERTEX], [len(edges), len(concave), len(concave)]),
        number=np.concatenate([edges, concave, concave]),
        point=np.concatenate([a[edges], a[concave], a[concave]]),
        normal=np.concatenate([inward[edges], middle, middle]),
        planes=np.concatenate([strips[edges], cones, -cones]),
    )


_ON_ARC = 1e-9
"""[diameter] How far the end of a chord may be off its circle."""


def _are_chords(
    a: FloatArray, b: FloatArray, arc: tuple[FloatArray, float, float] | None, diameter: float
) -> BoolArray:
    """Which segments from a to b (n, 2) are chords of a circle of the radius round a centre."""
    if arc is None:
        return np.zeros(len(a), dtype=bool)
    centres, radius, sagitta = arc
    off = _ON_ARC * diameter

    def on(points: FloatArray) -> BoolArray:
        gap = points[:, None, :] - centres
        short = radius - np.hypot(gap[..., 0], gap[..., 1])
        return (short >= -off) & (short <= sagitta + off)

    return np.asarray((on(a) & on(b)).any(axis=1), dtype=np.bool_)


def balanced_triples(
    features: Features, outline: Outline, limits: HandLimits, part: int = 0, parts: int = 1
) -> tuple[IntArray, FloatArray]:
    """All triples of features that can balance and squeeze, and a concurrency point for each.

    ``limits`` are those of the hand on them. Only every ``parts``-th of the features comes first in
    a triple, from ``part`` on: all parts together are all triples.

    Complexity: O(n^3) clips of small convex polygons, about 0.2 us each.
    """
    size = outline.diameter
    return feasible_triples(
        features.kind, features.point, features.normal, features.planes,
        outline.centroid, _REACH * size, _NEAR * size, _STEP * size, limits, part, parts,
    )  # fmt: skip


def further_points(
    features: Features, outline: Outline, limits: HandLimits, triple: IntArray
) -> tuple[IntArray, FloatArray]:
    """Points of concurrency (n, 2) all over the set of a triple, and a triple (n, 3) for each.

    Its features are in counterclockwise order of their contacts, which depends on the point.
    """
    size = outline.diameter
    points, turns = points_of_triple(
        features.kind, features.point, features.normal, features.planes, outline.centroid,
        _REACH * size, _NEAR * size, _STEP * size, limits, triple,
    )  # fmt: skip
    return np.where(turns[:, None] > 0, triple, triple[[0, 2, 1]]), points
