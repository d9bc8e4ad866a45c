"""Drawings for the tests, and distances between them and the polygons read from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely
from numpy.typing import ArrayLike

from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Reading
from icage.outline import Outline
from icage.units import Unit


def drawing(body: str, attributes: str = "") -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def read(
    folder: Path, body: str, width: float = 100.0, tolerance: float | None = None, **kwargs: str
) -> Outline:
    """The outline of a drawing with this body."""
    path = folder / "drawing.svg"
    path.write_text(drawing(body, **kwargs), encoding="utf-8")
    return read_svg(path, width, tolerance)


def read_svg(
    path: Path, width: float | None = None, tolerance: float | None = None, unit: Unit | None = "m"
) -> Outline:
    """The outline of a drawing in a file."""
    return trace_file(path, Reading(width=width, tolerance=tolerance, unit=unit)).outline


def placed(points: ArrayLike, width: float) -> np.ndarray:
    """Points of a drawing where ``read_svg`` must put them: y up, box at the origin."""
    up = np.asarray(points, dtype=float) * [1.0, -1.0]
    up = up - up.min(axis=0)
    return up * (width / up.max())


def hausdorff(outline: Outline, points: np.ndarray) -> float:
    """Distance both ways between an outline and a densely sampled closed curve (k, 2)."""
    ring = shapely.LinearRing(points)
    shapely.prepare([ring, outline.polygon.exterior])
    there = shapely.distance(outline.polygon.exterior, shapely.points(points)).max()
    fine = shapely.segmentize(outline.polygon.exterior, outline.diameter / 2000)
    back = shapely.distance(ring, shapely.points(shapely.get_coordinates(fine))).max()
    return float(max(there, back))


def ellipse(
    cx: float, cy: float, rx: float, ry: float, start: float = 0.0, stop: float = 2 * np.pi
) -> np.ndarray:
    u = np.linspace(start, stop, 4_001)
    return np.column_stack([cx + rx * np.cos(u), cy + ry * np.sin(u)])
