"""The area of shapes, and the area that lines enclose, as polygons. Our own."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.crossings import check_crossings, check_tangle
from icage.formats.drawings.curves import flatten
from icage.formats.drawings.drawing import Line, Ring, Shape
from icage.formats.drawings.ends import joined
from icage.formats.drawings.fill import filled
from icage.outline import LARGEST_COORDINATE

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
    check_points(len(points))
    check_crossings([points])
    meets = bool((points[0] == points[-1]).all()) and len(points) > 3
    closed = meets and not line.capped
    if closed:
        path = shapely.LinearRing(points)
    elif meets:  # a buffer would take it for a ring: parted in the middle of its first edge
        middle = (points[0] + points[1]) / 2.0
        parted = np.vstack([middle, points[1:]])
        path = shapely.MultiLineString([np.vstack([points[0], middle]), parted])
    else:
        path = shapely.LineString(points)
    radius = line.width / 2.0
    if radius <= 0.0:
        return shapely.Polygon()
    if radius > LARGEST_COORDINATE:
        raise FormatError(f"a line is wider than {LARGEST_COORDINATE:g}")
    # A quarter of a circle in chords of at most ``within``: 1 - cos(a/2) = within / radius.
    segments = int(np.ceil(np.pi / 4.0 / np.arccos(1.0 - min(1.0, max(1e-12, within / radius)))))
    area = shapely.buffer(
        path, radius, quad_segs=min(max(segments, 4), 400), cap_style=line.cap,
        join_style="bevel" if line.join == "mitre" else line.join,
    )  # fmt: skip
    if line.join == "mitre":
        area = shapely.union_all([area, *_mitres(points, closed, radius, line.mitre_limit)])
    return _clipped(area, line.clips, within)


def _mitres(
    points: FloatArray, closed: bool, radius: float, limit: float
) -> list[shapely.Geometry]:
    """The tips of corners whose length is within the limit; the others stay bevelled.

    A drawing's corner is one or the other; a buffer's own mitres would be cut off at the limit.
    """
    ring = points[:-1] if closed else points
    ring = ring[np.append(True, (np.diff(ring, axis=0) != 0.0).any(axis=1))]
    if closed and (ring[0] == ring[-1]).all():
        ring = ring[:-1]
    if len(ring) < 3:
        return []
    before = ring - np.roll(ring, 1, axis=0)
    lengths = np.hypot(before[:, 0], before[:, 1])
    before /= np.where(lengths > 0.0, lengths, 1.0)[:, None]  # 0: from the end to where it meets
    after = np.roll(before, -1, axis=0)
    turned = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    # length / width = 1 / sin(inner angle / 2) = 1 / cos(turn / 2)
    cosine = np.sqrt(np.maximum(0.0, (1.0 + (before * after).sum(axis=1)) / 2.0))
    sharp = (turned != 0.0) & (cosine * limit >= 1.0)
    if not closed:
        sharp[[0, -1]] = False
    outwards = np.where(turned > 0.0, radius, -radius)[:, None]
    first = ring + outwards * np.column_stack([before[:, 1], -before[:, 0]])
    last = ring + outwards * np.column_stack([after[:, 1], -after[:, 0]])
    with np.errstate(divide="ignore", invalid="ignore"):
        tip = ring + (first + last - 2.0 * ring) / (2.0 * cosine**2)[:, None]
    corners = np.stack([ring, first, tip, last], axis=1)[sharp]
    return [shapely.Polygon(corner) for corner in corners]


class Enclosed(NamedTuple):
    """What lines enclose together.

    Attributes
    ----------
    area:
        Every point that cannot get away without crossing a line.
    loose:
        (m, 2) = ends of lines that met no other end and lie outside of the area.
    faces:
        (k) polygons between lines: the area in its smallest pieces.
    """

    area: shapely.Geometry
    loose: FloatArray
    faces: NDArray[np.object_]

    def nested(self, area: shapely.Geometry | None = None) -> shapely.Geometry:
        """What closed lines inside of an area (the whole) enclose, none of them on its boundary."""
        around = self.area if area is None else area
        shapely.prepare(around)
        return shapely.union_all(self.faces[shapely.contains_properly(around, self.faces)])


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
        return Enclosed(shapely.Polygon(), loose, shapely.get_parts(shapely.MultiPolygon()))
    check_tangle(paths)
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
    return Enclosed(area, loose, shapely.get_parts(faces))


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
    if not clips:
        return area
    return shapely.intersection(area, _left_by(tuple(map(tuple, clips)), within))


@lru_cache(maxsize=32)
def _left_by(clips: tuple[tuple[Shape, ...], ...], within: float) -> shapely.Geometry:
    """What clips leave of everything; shapes that stand together ask for the same."""
    left: list[shapely.Geometry] = []
    for clip in clips:
        areas: list[shapely.Geometry] = []
        points = 0
        for shape in clip:
            areas.append(area_of(shape, within))
            points += int(shapely.get_num_coordinates(areas[-1]))
            check_points(points)
        one = shapely.union_all(areas)
        left = [shapely.intersection(left[0], one) if left else one]
    return left[0]
