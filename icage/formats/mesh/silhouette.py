"""The silhouette of a mesh along the axis: the outer boundary of its projected triangles.

A projected edge with triangles on both sides of it lies inside. The others, the contour, hold the
boundary of the silhouette; so what they enclose is the silhouette and the holes in it. That needs
the union of some thousand contour edges, not of a million triangles. Holes are told from solids by
whether a triangle covers a point of them.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.area import without_slits
from icage.formats.drawings.crossings import check_tangle
from icage.formats.drawings.curves import Polyline
from icage.formats.drawings.drawing import Drawing, Ring, Shape

MAX_CONTOUR: Final = 100_000
"""Contour edges."""

CRACK: Final = 1e-6
"""[size] Narrower cracks between triangles are closed."""

_FLAT: Final = 1e-12
"""[size^2] A projected triangle of a smaller area is seen from its edge."""

_HOLES: Final = 100
"""Holes told at most, the largest."""


def silhouette(triangles: FloatArray) -> Drawing:
    """The drawing of triangles (n, 3, 3) seen along the last coordinate.

    Raises
    ------
    FormatError:
        Nothing is seen, or its contour is too much.
    """
    flat = triangles[:, :, :2]
    low = flat.min(axis=(0, 1))
    size = float((flat.max(axis=(0, 1)) - low).max())
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    seen = np.abs(area) > _FLAT * size**2
    if not seen.any():
        raise FormatError("the mesh has no area along this axis: look at it along another one")
    # All counterclockwise: an edge that runs both ways has triangles on both sides.
    turned = np.where((area[seen] > 0.0)[:, None, None], flat[seen], flat[seen][:, ::-1])
    contour = _contour(turned)
    if len(contour) > MAX_CONTOUR:
        raise FormatError(
            f"the contour of the mesh has {len(contour)} edges, at most {MAX_CONTOUR} are "
            "allowed: simplify the mesh, or cut it (--section)"
        )
    check_tangle(list(contour))
    whole = shapely.union_all(shapely.linestrings(contour), grid_size=CRACK / 100.0 * size)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(whole)))
    outer = without_slits(shapely.union_all(faces), CRACK * size)
    holes = _holes(faces, turned, size)
    shapes = tuple(
        Shape(tuple(_ring(ring) for ring in (part.exterior, *_inside(part, holes))), (), "evenodd")
        for part in shapely.get_parts(outer)
        if isinstance(part, shapely.Polygon) and not part.is_empty
    )
    return Drawing(shapes=shapes, sure=False)


def _contour(triangles: FloatArray) -> FloatArray:
    """(m, 2, 2) edges of counterclockwise triangles (n, 3, 2) that run in one direction only."""
    points, numbers = np.unique(triangles.reshape(-1, 2), axis=0, return_inverse=True)
    corner = numbers.reshape(-1, 3)
    a = corner.ravel()
    b = np.roll(corner, -1, axis=1).ravel()
    low, high = np.minimum(a, b), np.maximum(a, b)
    edges, where = np.unique(low * len(points) + high, return_inverse=True)
    forward = np.bincount(where.ravel(), a < b, minlength=len(edges)) > 0
    backward = np.bincount(where.ravel(), a > b, minlength=len(edges)) > 0
    alone = edges[forward != backward]
    return np.stack([points[alone // len(points)], points[alone % len(points)]], axis=1)


def _holes(faces: np.ndarray, triangles: FloatArray, size: float) -> shapely.Geometry:
    """Faces that no triangle covers, without slivers."""
    wide = faces[shapely.area(faces) > (1e3 * CRACK * size) ** 2]
    wide = wide[np.argsort(-shapely.area(wide))][:_HOLES]
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    found: list[shapely.Geometry] = []
    for face, point in zip(
        wide, shapely.get_coordinates(shapely.point_on_surface(wide)), strict=True
    ):
        near = ((low <= point) & (point <= high)).all(axis=1)
        inside = np.ones(int(near.sum()), dtype=bool)
        for p, q in ((a, b), (b, c), (c, a)):
            along, to = q[near] - p[near], point - p[near]
            inside &= along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0] >= 0.0
        if not inside.any():
            found.append(face)
    return shapely.union_all(found)


def _inside(part: shapely.Polygon, holes: shapely.Geometry) -> list[shapely.LinearRing]:
    """Outer rings of the holes in a part."""
    return [
        hole.exterior
        for hole in shapely.get_parts(holes)
        if isinstance(hole, shapely.Polygon) and not hole.is_empty and part.contains(hole)
    ]


def _ring(ring: shapely.LinearRing) -> Ring:
    return (Polyline(shapely.get_coordinates(ring)),)
