"""What the page is given: the plan, its regions for the eye, and the tables of the query."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import shapely

from experiments.explore.encoded import doubles, indices
from experiments.figures.drawing.shapes import polygons_of, tidied
from experiments.figures.plan import figure_regions
from experiments.io.one_line import one_line
from icage.cage import Cage
from icage.cells.query_tables import QueryTables
from icage.cells.regions import FingerRegion
from icage.formats.friction_json import friction_document
from icage.formats.plan_json import plan_document
from icage.friction.levels import FrictionLevel, JamTolerance

FORMAT: Final = "icage-explore/1"

DETAIL: Final = 4e-4
"""[1] Regions are drawn but for details this small against what they and the object span: less than
half a pixel of a screen."""


def explore_document(
    cage: Cage,
    tables: QueryTables,
    name: str,
    unit: str,
    friction: Sequence[FrictionLevel] = (),
    tolerance: JamTolerance | None = None,
) -> dict[str, Any]:
    """The document ``icage-explore/1``; lengths in ``unit``. [docs/formats.md, icage explore]

    In the name, marks that nobody sees (of the direction of writing, say) become escapes.
    """
    plan = plan_document(cage, (), one_line(name), unit, exact_fit=True)
    del plan["regions"]  # those of the page are simpler, and say so by another key
    if friction and tolerance is not None:
        plan.update(friction_document(friction, tolerance))
    return {
        "format": FORMAT,
        "plan": plan,
        "sigma_largest": cage.sigma_largest,
        "drawn_regions": _regions(cage),
        "query": query_document(tables),
    }


def query_document(tables: QueryTables) -> dict[str, Any]:
    """The tables of the query, arrays as ``experiments.explore.encoded`` writes them."""
    cage, pieces = tables.cage, tables.pieces
    return {
        "frame_at": tables.frame_at,
        "pieces_at": tables.pieces_at,
        "fingers": cage.cells.shape[1],
        "cap": tables.cap,
        "collision": tables.collision,
        "held": tables.held,
        "held_lost": tables.held_lost,
        "same_level": tables.same_level,
        "first": tables.first,
        "polygon_first": tables.polygon_first,
        "grasp_nodes": cage.grasp_nodes,
        "grasp_sigmas": cage.grasp_sigmas,
        "piece_start": indices(pieces.start),
        "corners": doubles(pieces.corners),
        "normals": doubles(pieces.normals),
        "cells": indices(cage.cells),
        "level": doubles(cage.level),
        "parent": indices(cage.parent),
        "stamp": doubles(cage.stamp),
        "outside": indices(tables.outside),
        "outside_level": doubles(tables.outside_level),
    }


def _regions(cage: Cage) -> list[dict[str, Any]]:
    """The regions from inside, as the figure of a plan has them."""
    inner = [region for region in figure_regions(cage) if region.bound == "inner"]
    if not inner:
        return []
    shapes = np.array([cage.outline.polygon, *(region.geometry for region in inner)], dtype=object)
    low_x, low_y, high_x, high_y = shapely.total_bounds(shapes)
    detail = DETAIL * max(high_x - low_x, high_y - low_y)
    return [_region(region, detail) for region in inner if not region.geometry.is_empty]


def _region(region: FingerRegion, detail: float) -> dict[str, Any]:
    return {
        "finger": region.finger,
        "level": region.level_name,
        "rings": [
            shapely.get_coordinates(ring)[:-1]
            for part in polygons_of(tidied(region.geometry, detail))
            for ring in (part.exterior, *part.interiors)
        ],
    }
