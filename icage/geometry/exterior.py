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
from icage.geometry.convex import columns, join_convex, triangles_on
from icage.geometry.kernels.pieces import slots_of
from icage.geometry.round_chains import with_apexes
from icage.hand import HandShape
from icage.kernels.straight import corners, sharpest
from icage.outline import Outline
from icage.tolerance import MERGE_VERTEX


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
    x, y = columns(points)
    begin, all_kept = sharpest(x, y, bound)
    return points if all_kept else points[corners(x, y, begin, bound)]


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
    used, fans = np.arange(len(vertices)), np.empty((0, 3), dtype=np.int64)
    if apexes:
        coarse, above, fans = with_apexes(ring)
        vertices = np.concatenate([vertices, above])
        used = np.concatenate([used[:corner], corner + coarse])
    around = vertices[used]
    room = shapely.Polygon(box, [around[corner:]])
    triangles = used[triangles_on(around, room)]
    joined = len(triangles) if merge else 0
    triangles = np.concatenate([triangles, corner + fans])
    return _as_pieces(vertices, triangles, joined, outline.diameter), origin


def _as_pieces(vertices: FloatArray, triangles: IntArray, joined: int, diameter: float) -> Pieces:
    """The first triangles joined to convex pieces, and the others, as flat arrays."""
    x, y = columns(vertices)
    pieces = join_convex(x, y, triangles, joined)
    slots = slots_of(x, y, *pieces)
    return Pieces(
        x=x,
        y=y,
        ptr=pieces.ptr,
        slot_vertex=slots.vertex,
        slot_neighbour=slots.neighbour,
        normal_x=slots.normal_x,
        normal_y=slots.normal_y,
        wall_from=slots.wall_from,
        wall_to=slots.wall_to,
        scale=diameter,
        diameter=diameter,
    )
