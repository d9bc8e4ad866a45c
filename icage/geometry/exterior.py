"""Convex pieces of the plane around the object. [Bunis2018, Sec. V-A]

The box around the object is so large that nothing is lost: for sigma at or above diameter /
shortest side of the unit hand at most one finger is inside the convex hull and the hand escapes;
below it, a finger outside the box means that the whole triangle is off the hull.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.errors import GeometryError
from icage.geometry.convex import merge_convex, triangulate, twins
from icage.geometry.round_chains import with_apexes
from icage.hand import HandShape
from icage.kernels.straight import corners
from icage.outline import Outline
from icage.tolerance import MERGE_VERTEX

WALL = -1
"""Neighbour of a slot that is an edge of the object."""

BOX = -2
"""Neighbour of a slot that is an edge of the box."""


class Pieces(NamedTuple):
    """Convex pieces as flat arrays, for the kernels; slot s is an edge of one piece.

    Coordinates are relative to ``origin``. Piece k owns the slots ptr[k]:ptr[k + 1], and slot s
    runs from vertex slot_vertex[s] to the next slot's, counterclockwise round its piece.
    """

    x: FloatArray
    y: FloatArray
    ptr: IntArray
    slot_vertex: IntArray
    slot_neighbour: IntArray
    normal_x: FloatArray
    normal_y: FloatArray
    wall_from: IntArray
    wall_to: IntArray
    scale: float
    diameter: float

    @property
    def total(self) -> int:
        """Number of pieces."""
        return len(self.ptr) - 1


def largest_sigma(diameter: float, hand: HandShape) -> float:
    """Sigma at and above which the hand has escaped, whatever its placement. Our own."""
    return diameter / shortest_side(hand)


def shortest_side(hand: HandShape) -> float:
    """Shortest side of the unit hand."""
    return min(1.0, abs(hand.z_3), abs(hand.z_3 - 1.0))


def without_straight_vertices(vertices: FloatArray, diameter: float) -> FloatArray:
    """Drop vertices that lie within MERGE_VERTEX of the chord of their kept neighbours.

    Subdivided edges then give the very same pieces, and no triangle is thinner than what the
    rounding of a rotated drawing can decide.
    """
    bound = MERGE_VERTEX * diameter
    points = np.asarray(vertices)
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    side = after - before
    off = np.abs(
        side[:, 0] * (points[:, 1] - before[:, 1]) - side[:, 1] * (points[:, 0] - before[:, 0])
    )
    length = np.hypot(side[:, 0], side[:, 1])
    sharp = (off > bound * length) | (((points - before) * (after - points)).sum(axis=1) < 0.0)
    short = np.hypot(*(points - before).T) <= bound
    if bool((sharp & ~short).all()):
        return points
    begin = int(np.argmax(off * (sharp & ~short)))
    x, y = np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1])
    return points[corners(x, y, begin, bound)]


def exterior_pieces(
    outline: Outline, hand: HandShape, *, merge: bool = True, apexes: bool = True
) -> tuple[Pieces, FloatArray]:
    """Convex pieces of the box minus the object, and the origin their coordinates are relative to.

    ``merge=False`` keeps the raw triangles, ``apexes=False`` the outline's own vertices even where
    it is round: slower, and other formulations of the same space.
    """
    origin = outline.vertices[0].copy()
    ring = without_straight_vertices(outline.vertices - origin, outline.diameter)
    if len(ring) < 3:
        raise GeometryError("the outline is nothing but straight vertices")
    longest = max(1.0, abs(hand.z_3), abs(hand.z_3 - 1.0))
    margin = 1.01 * outline.diameter * longest / shortest_side(hand)
    low, high = ring.min(axis=0) - margin, ring.max(axis=0) + margin
    box = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    corner = len(box)
    vertices = np.concatenate([box, ring])
    used, fans = np.arange(len(vertices)), list[list[int]]()
    if apexes:
        coarse, above, fans = with_apexes(ring)
        vertices = np.concatenate([vertices, above])
        used = np.concatenate([used[:corner], corner + coarse])
    _, triangles = triangulate(shapely.Polygon(box, [vertices[used[corner:]]]))
    triangles = used[triangles]
    rings = merge_convex(vertices, triangles) if merge else triangles.tolist()
    rings += [[corner + v for v in triangle] for triangle in fans]
    return _as_pieces(vertices, rings, outline.diameter), origin


def _as_pieces(vertices: FloatArray, rings: list[list[int]], diameter: float) -> Pieces:
    sizes = np.array([len(r) for r in rings])
    ptr = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    slot_vertex = np.array([v for r in rings for v in r], dtype=np.int64)
    slot_end = np.array([v for r in rings for v in r[1:] + r[:1]], dtype=np.int64)
    owner = np.repeat(np.arange(len(rings)), sizes)
    side = vertices[slot_end] - vertices[slot_vertex]
    length = np.hypot(side[:, 0], side[:, 1])
    twin = twins(slot_vertex, slot_end, len(vertices))
    outside = np.where((slot_vertex < 4) & (slot_end < 4), BOX, WALL)
    neighbour = np.where(twin >= 0, owner[twin], outside)
    walls = np.flatnonzero(neighbour == WALL)
    return Pieces(
        x=np.ascontiguousarray(vertices[:, 0]),
        y=np.ascontiguousarray(vertices[:, 1]),
        ptr=ptr,
        slot_vertex=slot_vertex,
        slot_neighbour=neighbour,
        normal_x=-side[:, 1] / length,
        normal_y=side[:, 0] / length,
        wall_from=slot_vertex[walls],
        wall_to=slot_end[walls],
        scale=diameter,
        diameter=diameter,
    )
