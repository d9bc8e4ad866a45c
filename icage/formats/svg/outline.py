"""Outline of an SVG drawing: exterior ring of the union of its filled shapes.

Strokes, text and images paint no area here. x to the right, y upwards (SVG's y negated); the
drawing is scaled so that the longer side of its bounding box is the width asked for, and moved so
that the box's lower left corner is (0, 0).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError, InputError
from icage.formats.files import read_bytes
from icage.formats.svg.curves import Curve, flatten
from icage.formats.svg.fill import filled
from icage.formats.svg.shapes import Shape, drawn_shapes
from icage.formats.svg.simplify import simplified
from icage.formats.svg.tree import MAX_BYTES, drawable
from icage.outline import LARGEST_COORDINATE, Outline
from icage.units import Unit

DEFAULT_TOLERANCE: Final = 1e-3
"""[width] Tolerance where none is given. [docs/formats.md, Case file]"""

TOLERANCE_RANGE: Final = (1e-6, 0.1)
"""[width] Finer is beyond any drawing, coarser is no outline of it."""

MAX_POINTS: Final = 200_000
"""Vertices of the flattened drawing."""

_PIXEL: Final[dict[Unit, float]] = {"m": 0.0254 / 96.0, "cm": 2.54 / 96.0, "mm": 25.4 / 96.0}
"""[unit] A pixel of a drawing that states its size: 96 an inch. [CSS2024, Sec. 6.2]"""

_FLATTEN: Final = 0.02
_SIMPLIFY: Final = 0.95
"""[tolerance] Shares of flattening (small, since it also moves the crossings of shapes) and of
simplification."""


def read_svg(
    path: Path, width: float | None = None, tolerance: float | None = None, unit: Unit = "m"
) -> Outline:
    """Outline of the drawing in a file, in ``unit``.

    Parameters
    ----------
    path:
        The SVG file.
    width:
        [unit] Longer side of the outline's bounding box; if None, the size the file states.
    tolerance:
        [unit] Bound of the distance between drawing and outline, flattening and simplification
        together; 0.1 % of the width if None.
    unit:
        Unit of the outline.

    Raises
    ------
    FormatError:
        Not a readable SVG drawing, no fill in it, several separate parts, no size stated where
        none is given, or numbers out of range.
    OutlineError:
        The outline has more vertices than an ``Outline`` may have.
    """
    if width is not None:
        if not (math.isfinite(width) and width > 0.0):
            raise FormatError(f"width is {width:g}; a finite number above 0 is needed")
        _relative(tolerance, width)
    try:
        content, own_unit = drawable(read_bytes(path, MAX_BYTES, "an SVG drawing"))
        if width is None and own_unit is None:
            raise FormatError("the drawing states no size in mm, cm or in; a width is needed")
        shapes = list(drawn_shapes(content))
        drawn = _size(_corners(shapes))
        # A shape without area may reach further than the silhouette: measured once more.
        drawn = _size(_part(shapes, DEFAULT_TOLERANCE * drawn))
        wide = drawn * _PIXEL[unit] if width is None else width
        relative = _relative(tolerance, wide)
        region = _part(shapes, relative * drawn)
        ring = simplified(_ring(region), _SIMPLIFY * relative * _size(region))
        low_corner = ring.min(axis=0)
        return Outline((ring - low_corner) * (wide / (ring.max(axis=0) - low_corner).max()))
    except InputError as error:
        raise type(error)(str(error) if str(path) in str(error) else f"{path}: {error}") from error


def stated_unit(path: Path) -> Unit | None:
    """Unit to answer in for a drawing that states its size: cm for cm, mm for every other length.

    None if it states none. Raises what ``read_svg`` raises for a file that is no drawing.
    """
    try:
        own_unit = drawable(read_bytes(path, MAX_BYTES, "an SVG drawing"))[1]
    except InputError as error:
        raise type(error)(str(error) if str(path) in str(error) else f"{path}: {error}") from error
    if own_unit is None:
        return None
    return "cm" if own_unit == "cm" else "mm"


def _relative(tolerance: float | None, width: float) -> float:
    """The tolerance as a share of the width."""
    relative = DEFAULT_TOLERANCE if tolerance is None else tolerance / width
    low, high = TOLERANCE_RANGE
    if not low * (1 - 1e-9) <= relative <= high * (1 + 1e-9):
        raise FormatError(
            f"tolerance is {relative * width:g}; {low * width:g} to {high * width:g} is allowed "
            f"({low:g} to {high:g} of the width)"
        )
    return relative


def _corners(shapes: Sequence[Shape]) -> shapely.MultiPoint:
    """Ends and turning points of all curves: they have the bounding box of the drawing."""
    points = [curve.at(_ends(curve)) for _, rings in shapes for ring in rings for curve in ring]
    if not points:
        raise FormatError("nothing in the drawing is filled; a filled shape is needed")
    corners = np.vstack(points)
    if not np.isfinite(corners).all() or np.abs(corners).max() > LARGEST_COORDINATE:
        raise FormatError(
            f"the drawing has coordinates that are not finite or beyond {LARGEST_COORDINATE:g}"
        )
    return shapely.MultiPoint(corners)


def _part(shapes: Sequence[Shape], tolerance: float) -> shapely.Polygon:
    """Union of all fills; parts smaller than the tolerance are dust."""
    if tolerance <= 0.0:
        raise FormatError("the filled shapes have no area")
    regions: list[shapely.Geometry] = []
    total = 0
    for rule, rings in shapes:
        flat = [
            np.vstack([flatten(curve, _FLATTEN * tolerance)[:-1] for curve in ring])
            for ring in rings
        ]
        total += sum(len(ring) for ring in flat)
        if total > MAX_POINTS:
            raise FormatError(
                f"the flattened drawing has more than {MAX_POINTS} points; give a larger tolerance"
            )
        regions.append(filled(flat, rule))
    parts = [part for part in _polygons(shapely.union_all(regions)) if _size(part) > tolerance]
    if not parts:
        raise FormatError("the filled shapes have no area")
    if len(parts) > 1:
        areas = sorted((part.area for part in parts), reverse=True)
        shares = ", ".join(f"{100 * area / sum(areas):.3g} %" for area in areas[:4])
        raise FormatError(
            f"the drawing has {len(parts)} separate filled parts (areas {shares}"
            f"{', ...' if len(areas) > 4 else ''}); one connected silhouette is needed"
        )
    return shapely.Polygon(parts[0].exterior)


def _polygons(region: shapely.Geometry) -> list[shapely.Polygon]:
    parts = shapely.get_parts(region)
    return [part for part in parts if isinstance(part, shapely.Polygon) and not part.is_empty]


def _ring(part: shapely.Polygon) -> FloatArray:
    return shapely.get_coordinates(part.exterior)[:-1]


def _size(part: shapely.Polygon | shapely.MultiPoint) -> float:
    """Longer side of the bounding box."""
    x_low, y_low, x_high, y_high = part.bounds
    return max(x_high - x_low, y_high - y_low)


def _ends(curve: Curve) -> FloatArray:
    return np.array([0.0, *curve.turns(), 1.0])
