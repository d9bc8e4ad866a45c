"""The figure of a plan: object, target grasp, caging regions, escape puncture, values.

matplotlib's Figure without pyplot: no window, no global state, the same bytes for the same cage.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg

from experiments.figures.drawing.caption import caption_lines, draw_caption, strip_height
from experiments.figures.drawing.plan_view import draw_plan_view, frame_of
from experiments.figures.drawing.sheet import Bounds, Sheet, lay_out
from experiments.figures.drawing.written import check_suffix, settings, write
from icage.cage import Cage, Puncture
from icage.cells.regions import FingerRegion, caging_regions


def figure_regions(cage: Cage) -> tuple[FingerRegion, ...]:
    """The regions a figure shows: at sigma_max (or all of it), and at sigma_first where lower."""
    if cage.status == "not_a_cage":
        return ()
    regions = caging_regions(cage)
    if cage.sigma_first is not None and cage.sigma_first != cage.sigma_max:
        regions += caging_regions(cage, cage.sigma_first)
    return regions


def draw_plan(
    cage: Cage, regions: Sequence[FingerRegion], name: str, unit: str, path: Path
) -> None:
    """Draw a plan into an SVG or PNG file (by suffix), whole or not at all.

    Where a region is given both from inside and from outside, the inner one is drawn: every point
    shown belongs to it, but for slits finer than a line.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png.
    """
    check_suffix(path)
    with settings():
        write(plan_sheet(cage, regions, name, unit).figure, path)


def plan_sheet(cage: Cage, regions: Sequence[FingerRegion], name: str, unit: str) -> Sheet:
    """The figure itself, before it is written."""
    shown = _shown(regions)
    lines = caption_lines(cage, unit)
    escape = next((p for p in cage.punctures if p.kind == "escape"), None)
    near = _bounds(cage, shown, escape)
    x_0, y_0, x_1, y_1 = shapely.union_all([shapely.box(*near), cage.outline.polygon]).bounds
    sheet = lay_out((x_0, y_0, x_1, y_1), near, strip_height(lines))
    FigureCanvasAgg(sheet.figure)
    draw_plan_view(sheet.axes, sheet.main, cage, shown, escape)
    if sheet.overview is not None:
        draw_plan_view(sheet.axes, sheet.overview, cage, shown, None, numbers=False)
        frame_of(sheet.axes, sheet.main.window)
        corners = (np.reshape(sheet.main.window, (2, 2)) - sheet.main.origin) / sheet.main.zoom
        place = sheet.overview.point(corners + sheet.main.corner)
        frame_of(sheet.axes, (*place[0], *place[1]))
    draw_caption(sheet, cage, lines, name, unit)
    return sheet


def _shown(regions: Sequence[FingerRegion]) -> list[FingerRegion]:
    """One region a finger and level: the inner one where there is a choice; lower levels on top."""
    chosen: dict[tuple[str, int], FingerRegion] = {}
    for region in regions:
        key = (region.level_name, region.finger)
        if key not in chosen or region.bound == "inner":
            chosen[key] = region
    return sorted(chosen.values(), key=lambda r: (r.level_name == "sigma_first", r.finger))


def _bounds(cage: Cage, regions: Sequence[FingerRegion], escape: Puncture | None) -> Bounds:
    """Hands and regions, in the object's frame."""
    hands = [cage.contacts] + ([] if escape is None else [escape.contacts])
    points = shapely.MultiPoint(np.concatenate(hands))
    parts = [points, points.buffer(cage.finger_radius)]
    parts += [region.geometry for region in regions if not region.geometry.is_empty]
    x_0, y_0, x_1, y_1 = shapely.total_bounds(np.array(parts, dtype=object))
    return float(x_0), float(y_0), float(x_1), float(y_1)
