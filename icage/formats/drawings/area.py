"""The area of shapes, and the area that lines enclose, as polygons. Our own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.crossings import check_crossings
from icage.formats.drawings.curves import flatten
from icage.formats.drawings.drawing import Line, Ring, Shape
from icage.formats.drawings.ends import joined
from icage.formats.drawings.fill import filled

MAX_POINTS: Final = 200_000
"""Vertices of the flattened drawing."""

_ROUNDING: Final = 1e-12
"""[largest coordinate] Lines nearer to each other than this are one where they cross."""


def points_of(chain: Ring, within: float) -> FloatArray:
    """(k, 2) = the chain as a polyline at most ``within`` from it, both ends included."""
    flat = [flatten(curve, within) for curve in chain]
    return np.vstack([*(piece[:-1] for piece in flat), flat[-1][-1:]])


def area_of(shape: Shape, within: float) -> shapely.Geometry:
    """What a shape fills, after its clips; its boundary is at most ``within`` from the true one.

    Raises
    ------
    FormatError:
        Too many points.
    """
    rings = [points_of(ring, within)[:-1] for ring in shape.rings]
    check_points(sum(len(ring) for ring in rings))
    area = filled(rings, shape.rule)
    return _clipped(area, shape.clips, within)


def drawn_area(line: Line, within: float) -> shapely.Geometry:
    """What the drawn width of a line covers, after its clips."""
    points = points_of(line.chain, within)
    closed = bool((points[0] == points[-1]).all()) and len(points) > 3
    path = shapely.LinearRing(points) if closed else shapely.LineString(points)
    radius = line.width / 2.0
    if radius <= 0.0:
        return shapely.Polygon()
    # A quarter of a circle in chords of at most ``within``: 1 - cos(a/2) = within / radius.
    segments = int(np.ceil(np.pi / 4.0 / np.arccos(max(0.0, 1.0 - min(1.0, within / radius)))))
    area = shapely.buffer(
        path, radius, quad_segs=min(max(segments, 4), 400),
        cap_style=line.cap, join_style=line.join, mitre_limit=line.mitre_limit,
    )  # fmt: skip
    return _clipped(area, line.clips, within)


class Enclosed(NamedTuple):
    """What lines enclose together.

    Attributes
    ----------
    area:
        Every point that cannot get away without crossing a line.
    loose:
        (m, 2) = ends of lines that met no other end and lie outside of the area.
    nested:
        What closed lines inside of the area enclose, none of them on its boundary.
    """

    area: shapely.Geometry
    loose: FloatArray
    nested: shapely.Geometry


def enclosed(lines: Sequence[Line], within: float, gap: float) -> Enclosed:
    """What lines enclose; ends of lines nearer to each other than ``gap`` are one point.

    Raises
    ------
    FormatError:
        Too many points.
    """
    paths = [points_of(line.chain, within) for line in lines]
    check_points(sum(len(path) for path in paths))
    paths, loose = joined(paths, gap)
    paths = [path for path in paths if len(path) > 1]
    if not paths:
        return Enclosed(shapely.Polygon(), loose, shapely.Polygon())
    check_crossings(paths)
    grid = _ROUNDING * float(np.abs(np.vstack(paths)).max())
    whole = shapely.union_all([shapely.LineString(path) for path in paths], grid_size=grid)
    edges = shapely.get_parts(whole)
    faces, _, dangling, _ = shapely.polygonize_full(edges)
    area = without_slits(shapely.union_all(shapely.get_parts(faces)), within)
    if shapely.is_empty(dangling):
        loose = np.zeros((0, 2))
    elif len(loose):
        shapely.prepare(area)
        loose = loose[~shapely.covers(area, shapely.points(loose))]
    shapely.prepare(area)
    rings = shapely.get_parts(faces)
    inside = rings[shapely.contains_properly(area, rings)]
    return Enclosed(area, loose, shapely.union_all(inside))


def without_slits(area: shapely.Geometry, width: float) -> shapely.Geometry:
    """An area whose slits narrower than ``width`` are closed; it stays as it is if it has none.

    Edges that were meant to be one and differ by rounding leave slits, deep ones at times.
    """
    half = width / 2.0
    grown = shapely.buffer(area, half, join_style="mitre", mitre_limit=100.0)
    closed = shapely.buffer(grown, -half, join_style="mitre", mitre_limit=100.0)
    fewer = shapely.get_num_coordinates(closed) < shapely.get_num_coordinates(area)
    return shapely.union_all([area, closed]) if fewer else area


def check_points(count: int) -> None:
    """Refuse more than ``MAX_POINTS``."""
    if count > MAX_POINTS:
        raise FormatError(
            f"the flattened drawing has more than {MAX_POINTS} points; give a larger tolerance"
        )


def _clipped(
    area: shapely.Geometry, clips: Sequence[Sequence[Shape]], within: float
) -> shapely.Geometry:
    for clip in clips:
        area = shapely.intersection(
            area, shapely.union_all([area_of(shape, within) for shape in clip])
        )
    return area
