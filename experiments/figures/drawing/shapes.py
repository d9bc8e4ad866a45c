"""From shapely to matplotlib, and the round numbers of a scale bar."""

from __future__ import annotations

import math

import numpy as np
import shapely
from matplotlib.path import Path
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry


def as_path(geometry: BaseGeometry) -> Path:
    """One path through all rings of the polygons in ``geometry``; holes stay open.

    Outer rings run counterclockwise and holes clockwise, so that even-odd and non-zero filling
    agree.
    """
    pieces: list[NDArray[np.float64]] = []
    codes: list[NDArray[np.uint8]] = []
    for polygon in polygons_of(geometry):
        turned = shapely.orient_polygons(polygon)
        for ring in (turned.exterior, *turned.interiors):
            points = shapely.get_coordinates(ring)
            code = np.full(len(points), Path.LINETO, dtype=np.uint8)
            code[0], code[-1] = Path.MOVETO, Path.CLOSEPOLY
            pieces.append(points)
            codes.append(code)
    if not pieces:
        return Path(np.empty((0, 2)))
    return Path(np.concatenate(pieces), np.concatenate(codes))


def is_blank(path: Path) -> bool:
    """Whether there is nothing on a path."""
    return np.size(path.vertices) == 0


def as_pair(point: NDArray[np.float64]) -> tuple[float, float]:
    """A point (2,) as matplotlib's annotations take it."""
    x, y = point.tolist()
    return x, y


def polygons_of(geometry: BaseGeometry) -> list[shapely.Polygon]:
    """The polygons in a geometry, none of them empty; points and lines are left out."""
    parts = shapely.get_parts(geometry)
    return [part for part in parts if isinstance(part, shapely.Polygon) and not part.is_empty]


def scale_bar_length(longest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``longest``.

    >>> scale_bar_length(73.0), scale_bar_length(0.0021), scale_bar_length(10.0)
    (50.0, 0.002, 10.0)
    """
    power = 10.0 ** math.floor(math.log10(longest) + 1e-12)
    step = max(step for step in (1.0, 2.0, 5.0) if step * power <= longest * (1.0 + 1e-12))
    return float(f"{step * power:.12g}")


def tidied(geometry: BaseGeometry, detail: float) -> shapely.MultiPolygon:
    """The same area for drawing: nothing in it smaller than ``detail``, few vertices."""
    closed = geometry.buffer(detail, join_style="mitre").buffer(-detail, join_style="mitre")
    parts = polygons_of(shapely.make_valid(shapely.simplify(closed, 0.5 * detail)))
    kept = [
        shapely.Polygon(
            part.exterior, [h for h in part.interiors if shapely.Polygon(h).area > 9.0 * detail**2]
        )
        for part in parts
        if part.area > detail**2
    ]
    return shapely.MultiPolygon(kept)
