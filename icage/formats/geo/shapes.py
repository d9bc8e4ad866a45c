"""Geometries of shapely as shapes and lines of a drawing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import shapely

from icage.errors import FormatError
from icage.formats.drawings.area import MAX_POINTS
from icage.formats.drawings.curves import Polyline
from icage.formats.drawings.drawing import Drawing, Line, Ring, Shape
from icage.outline import LARGEST_COORDINATE

MAX_PARTS: Final = 10_000
"""Polygons and lines of a file."""

DEGREES: Final = (
    "coordinates are read as lengths in a plane; if these are degrees of longitude and latitude, "
    "project them first"
)


@dataclass(slots=True, eq=False)
class Found:
    """What has been read so far."""

    shapes: list[Shape] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    points: int = 0


def add(geometry: shapely.Geometry, names: tuple[str, ...], found: Found) -> None:
    """Add a geometry, parts of collections one by one.

    Raises
    ------
    FormatError:
        A polygon that is not valid, a kind that is not read, or too many points.
    """
    found.points += int(shapely.get_num_coordinates(geometry))
    if found.points > MAX_POINTS:
        raise FormatError(f"the file has more than {MAX_POINTS} points")
    for part in _parts(geometry):
        if len(found.shapes) + len(found.lines) >= MAX_PARTS:
            raise FormatError(f"the file has more than {MAX_PARTS} polygons and lines")
        kind = type(part).__name__
        if not (np.abs(shapely.get_coordinates(part)) <= LARGEST_COORDINATE).all():
            raise FormatError(
                f"a {kind} has coordinates that are not finite or beyond {LARGEST_COORDINATE:g}"
            )
        if shapely.is_empty(part):
            continue
        if isinstance(part, shapely.Polygon):
            if not part.is_valid:
                why = shapely.is_valid_reason(part)
                raise FormatError(f"polygon {len(found.shapes) + 1} is not valid: {why}")
            rings = (part.exterior, *part.interiors)
            found.shapes.append(Shape(tuple(_ring(ring) for ring in rings), names, "evenodd"))
        elif isinstance(part, shapely.LineString):
            found.lines.append(Line(_ring(part), names))
        elif isinstance(part, shapely.Point):
            found.left_out[kind] += 1
        else:
            raise FormatError(f"a {kind} is not read: polygons and lines are")


def drawing_of(found: Found, notes: Iterable[str]) -> Drawing:
    """The drawing; it states no size, so a unit or a width is needed."""
    said = list(notes)
    if found.left_out.total():
        count = found.left_out.total()
        said.append(f"{count} point{'s' * (count > 1)} left out: no outline")
    return Drawing(tuple(found.shapes), tuple(found.lines), sure=False, notes=tuple(said))


def may_be_degrees(found: Found) -> bool:
    """Whether all coordinates are such as longitude and latitude may be."""
    chains = [ring for shape in found.shapes for ring in shape.rings]
    points = [curve.points for ring in chains for curve in ring if isinstance(curve, Polyline)]
    return bool(points) and bool((np.abs(np.vstack(points)) <= [180.0, 90.0]).all())


def _parts(geometry: shapely.Geometry) -> Iterable[shapely.Geometry]:
    """The parts of collections, in order, without recursion."""
    waiting = [geometry]
    while waiting:
        one = waiting.pop()
        if isinstance(one, shapely.geometry.base.BaseMultipartGeometry):
            waiting += shapely.get_parts(one)[::-1].tolist()
        else:
            yield one


def _ring(line: shapely.LineString) -> Ring:
    return (Polyline(shapely.get_coordinates(line)),)
