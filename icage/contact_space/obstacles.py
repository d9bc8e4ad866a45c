"""Contact space obstacles: where the third finger would be inside the object.

[Bunis2018, Sec. IV-B]. The object's convex pieces are pulled back rectangle by rectangle (Eq. (4)),
as half planes: so a singular T needs no care. What is left of a rectangle are the free regions of
the search.
"""

from __future__ import annotations

import numpy as np
import shapely

from icage.arrays import BoolArray, FloatArray
from icage.contact_space.boundary import Boundary
from icage.contact_space.third_finger import Parallelogram
from icage.geometry.convex import merge_convex, triangulate
from icage.geometry.geos import union
from icage.hand import HandShape

NODED = 1e-11
"""[perimeter] Grid on which pulled back pieces are joined: above the tolerance of clipping, so that
no crack is left between two pieces, and a hundred times below what a figure or test can see."""

_CRACK = 10.0
"""[grid] A ring thinner than this is a crack."""


def interior_pieces(boundary: Boundary) -> list[FloatArray]:
    """Convex pieces (k, 2) of the object, counterclockwise, [unit]."""
    origin = boundary.start[0]
    vertices, triangles = triangulate(shapely.Polygon(boundary.start - origin))
    return [vertices[ring] + origin for ring in merge_convex(vertices, triangles)]


def rectangle_obstacle(
    parallelogram: Parallelogram, pieces: list[FloatArray]
) -> shapely.MultiPolygon:
    """The obstacle within one rectangle: polygonal, as T^-1 maps lines to lines.

    [Bunis2018, Lemma 4.1]
    """
    grid = NODED * float(parallelogram.size.max())
    return _union([parallelogram.clipped(piece) for piece in pieces], grid)


def obstacles(boundary: Boundary, hand: HandShape, pair: int) -> shapely.MultiPolygon:
    """CB_{i,i+1} = all (s_i, s_{i+1}) at which X_{i+2} lies in the object. [Bunis2018, Def. 5]

    Complexity: n^2 parallelograms against the object's pieces, most of them told apart at once.
    """
    pieces = interior_pieces(boundary)
    found: list[FloatArray] = []
    for j in range(len(boundary)):
        row = [Parallelogram.over(boundary, hand, pair, j, k) for k in range(len(boundary))]
        near = np.array([_may_meet(row, piece) for piece in pieces])
        for k, parallelogram in enumerate(row):
            hit = [pieces[c] for c in np.flatnonzero(near[:, k])]
            found += [parallelogram.clipped(piece) for piece in hit]
    return _union(found, NODED * boundary.perimeter)


def _may_meet(row: list[Parallelogram], piece: FloatArray) -> BoolArray:
    """Which parallelograms have no side of a convex piece between themselves and it."""
    corners = np.array([parallelogram.corners for parallelogram in row])
    side = np.roll(piece, -1, axis=0) - piece
    inward = np.column_stack([-side[:, 1], side[:, 0]])
    height = (corners @ inward.T) - (piece * inward).sum(axis=1)
    beyond = (height < 0.0).all(axis=1).any(axis=1)
    low, high = corners.min(axis=1), corners.max(axis=1)
    apart = (low > piece.max(axis=0)).any(axis=1) | (high < piece.min(axis=0)).any(axis=1)
    return ~(beyond | apart)


def _union(parts: list[FloatArray], grid: float) -> shapely.MultiPolygon:
    """Union of convex polygons; points and segments have no inside and are left out."""
    polygons = [shapely.Polygon(part) for part in parts if len(part) >= 3]
    solid = [polygon for polygon in polygons if polygon.area > 0.0]
    united = union(solid, grid, "contact space obstacle")
    kept = [p for p in shapely.get_parts(united) if isinstance(p, shapely.Polygon)]
    return shapely.MultiPolygon(
        [
            shapely.Polygon(p.exterior, [h for h in p.interiors if not _thin(h, grid)])
            for p in kept
            if not _thin(p.exterior, grid)
        ]
    )


def _thin(ring: shapely.LinearRing, grid: float) -> bool:
    return shapely.Polygon(ring).area <= _CRACK * grid * ring.length
