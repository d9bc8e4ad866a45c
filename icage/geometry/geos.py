"""Unions of polygons whose library may fail: its exceptions end here."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.errors import ShapelyError

from icage.errors import GeometryError

_COARSER = (1.0, 3.0, 10.0, 100.0, 1000.0)
"""[1] Grids that are tried, over the one wanted: noding on a fine grid can fail by rounding."""


def union(
    parts: Sequence[shapely.Polygon] | NDArray[np.object_], grid: float, what: str
) -> shapely.Geometry:
    """Union of polygons noded on a grid [unit], on a coarser one where that fails.

    Raises
    ------
    GeometryError:
        It fails on all of them; ``what`` says in the message what was computed.
    """
    failure: ShapelyError | None = None
    for factor in _COARSER:
        try:
            return shapely.union_all(parts, grid_size=factor * grid)
        except ShapelyError as error:
            failure = error
    raise GeometryError(f"{what}: the union of {len(parts)} polygons fails: {failure}")
