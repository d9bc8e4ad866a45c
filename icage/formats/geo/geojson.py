"""GeoJSON: features and geometries, named by their ids and properties. [Butler2016]"""

from __future__ import annotations

from typing import Any, Final, cast

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import CaseError, FormatError
from icage.formats.drawings.area import MAX_POINTS
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.geo.shapes import DEGREES, Found, add, drawing_of, may_be_degrees
from icage.formats.json_text import a_number, an_object, describe, parse_json, required

MAX_DEPTH: Final = 50
"""Collections in collections."""

GEOMETRIES: Final[dict[str, int]] = {
    "Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2,
    "MultiPolygon": 3,
}  # fmt: skip
"""How many lists are around each position."""

TYPES: Final = frozenset((*GEOMETRIES, "Feature", "FeatureCollection", "GeometryCollection"))
"""What "type" of a GeoJSON text may be."""


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing in a GeoJSON text. Raises FormatError."""
    found = Found()
    try:
        data = an_object(parse_json(content, "the GeoJSON file"), "the GeoJSON file")
        _walk(data, "the GeoJSON file", (), 0, found)
    except CaseError as error:
        raise FormatError(str(error)) from error
    return drawing_of(found, [DEGREES] if may_be_degrees(found) else [])


def _walk(
    data: dict[str, Any], where: str, names: tuple[str, ...], depth: int, found: Found
) -> None:
    if depth > MAX_DEPTH:
        raise FormatError(f"the GeoJSON file is nested more than {MAX_DEPTH} deep")
    kind = required(data, "type", where)
    if not isinstance(kind, str) or kind not in TYPES:
        raise FormatError(f"{where} has the type {describe(kind)}, which GeoJSON does not have")
    if kind == "FeatureCollection":
        for k, row in enumerate(_a_list(required(data, "features", where), f"{where}: features")):
            place = f"features[{k}]"
            _walk(an_object(row, place), place, names, depth + 1, found)
    elif kind == "GeometryCollection":
        rows = _a_list(required(data, "geometries", where), f"{where}: geometries")
        for k, row in enumerate(rows):
            place = f"geometries[{k}] of {where}"
            _walk(an_object(row, place), place, names, depth + 1, found)
    elif kind == "Feature":
        geometry = required(data, "geometry", where)
        if geometry is not None:
            own = (*names, *_names(data))
            place = f"the geometry of {where}"
            _walk(an_object(geometry, place), place, own, depth + 1, found)
    else:
        add(_geometry(kind, required(data, "coordinates", where), where), names, found)


def _names(feature: dict[str, Any]) -> tuple[str, ...]:
    """By which a feature can be picked."""
    properties = feature.get("properties")
    inner = cast("dict[str, Any]", properties) if isinstance(properties, dict) else {}
    values = (feature.get("id"), inner.get("name"), inner.get("id"))
    return tuple(
        str(value)
        for value in values
        if isinstance(value, str | int | float) and not isinstance(value, bool)
    )


def _geometry(kind: str, value: object, where: str) -> shapely.Geometry:
    depth = GEOMETRIES[kind]
    if kind == "Point":
        return shapely.Point(_positions([value], where)[0])
    if kind == "MultiPoint":
        return shapely.MultiPoint(_positions(value, where))
    if kind == "LineString":
        return _line(value, where)
    if kind == "MultiLineString":
        return shapely.MultiLineString([_line(row, where) for row in _a_list(value, where)])
    if depth == 2:
        return _polygon(value, where)
    return shapely.MultiPolygon([_polygon(row, where) for row in _a_list(value, where)])


def _line(value: object, where: str) -> shapely.LineString:
    points = _positions(value, where)
    if len(points) < 2:
        raise FormatError(f"{where} has a line of {len(points)} positions; 2 are needed")
    return shapely.LineString(points)


def _polygon(value: object, where: str) -> shapely.Polygon:
    rings = [_positions(row, where) for row in _a_list(value, where)]
    for ring in rings:
        if len(ring) < 4 or (ring[0] != ring[-1]).any():
            raise FormatError(
                f"{where} has a ring of {len(ring)} positions that is not closed: the first must "
                "be the last again, and 4 are needed"
            )
    return shapely.Polygon(rings[0], rings[1:]) if rings else shapely.Polygon()


def _positions(value: object, where: str) -> FloatArray:
    """(k, 2) = positions [x, y] or [x, y, height]; the height is left out."""
    rows = _a_list(value, where)
    if len(rows) > MAX_POINTS:
        raise FormatError(f"the file has more than {MAX_POINTS} points")
    points = np.empty((len(rows), 2))
    for k, row in enumerate(rows):
        numbers = _a_list(row, f"{where}: a position")
        if len(numbers) < 2:
            raise FormatError(f"{where} has a position of {len(numbers)} numbers; 2 are needed")
        points[k] = [a_number(number, f"{where}: a coordinate") for number in numbers[:2]]
    return points


def _a_list(value: object, where: str) -> list[Any]:
    if not isinstance(value, list):
        raise FormatError(f"{where} has {describe(value)}; a list is needed")
    return cast("list[Any]", value)
