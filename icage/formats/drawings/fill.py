"""The region that rings fill, by either rule of SVG, however they cross one another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.errors import FormatError
from icage.formats.drawings.crossings import check_crossings

FillRule = Literal["nonzero", "evenodd"]

MAX_WORK = 100_000_000
"""Faces times vertices of one path: seconds; ordinary drawings stay below a hundred thousand."""


def filled(rings: Sequence[FloatArray], rule: FillRule) -> shapely.Geometry:
    """Region filled by closed rings, each (k, 2) and open, together.

    The rings are cut at their crossings; a face belongs to the region if the winding number of
    all rings around it is not zero, or odd.
    """
    usable = [ring for ring in rings if len(np.unique(ring, axis=0)) >= 3]
    if not usable:
        return shapely.Polygon()
    if len(usable) == 1:
        alone = shapely.Polygon(usable[0])
        if alone.is_valid:
            return alone
    closed = [np.vstack([ring, ring[:1]]) for ring in usable]
    check_crossings(closed)
    edges = shapely.union_all([shapely.LineString(ring) for ring in closed])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(edges)))
    vertices = sum(len(ring) for ring in closed)
    if len(faces) * vertices > MAX_WORK:
        raise FormatError(
            f"a path with {vertices} points crosses itself into {len(faces)} faces; "
            f"at most {MAX_WORK:g} for their product"
        )
    windings = _windings(shapely.get_coordinates(shapely.point_on_surface(faces)), closed)
    inside = windings != 0 if rule == "nonzero" else windings % 2 == 1
    return shapely.union_all(faces[inside])


def _windings(points: FloatArray, closed: Sequence[FloatArray]) -> IntArray:
    """Winding number of the closed rings around each point (k, 2): signed upward crossings."""
    total = np.zeros(len(points), dtype=np.int64)
    a = np.vstack([ring[:-1] for ring in closed])
    b = np.vstack([ring[1:] for ring in closed])
    for k, (x, y) in enumerate(points):
        side = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])
        up = (a[:, 1] <= y) & (b[:, 1] > y) & (side > 0.0)
        down = (a[:, 1] > y) & (b[:, 1] <= y) & (side < 0.0)
        total[k] = int(up.sum()) - int(down.sum())
    return total
