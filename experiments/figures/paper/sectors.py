"""The sectors of the target's contacts and where their normals meet. [Bunis2018, Sec. VII-A]"""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from shapely.geometry.base import BaseGeometry

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, QUIET_INK, tint
from experiments.figures.paper.page import bounds_of, draw_hand, fill, new_sheet, object_panel
from experiments.figures.paper.study import Study
from icage.arrays import FloatArray
from icage.contact_space.sectors import Sector, common_area, concurrency_point, sector_at

_REACH = 6.0
"""[diameter] Where the half-infinite sectors are cut off: outside every window."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """Three sectors over the object, their common area, the point of concurrency."""
    found = [sector_at(study.boundary, p, _REACH * study.polygon.diameter) for p in study.target]
    held = [s for s in found if s is not None]
    point = concurrency_point(held) if len(held) == 3 else None
    figure = new_sheet(5.2, 5.2)
    axes = figure.subplots()
    window = bounds_of(study.polygon.polygon, study.target)
    diameter = study.polygon.diameter
    near = shapely.box(*window).buffer(0.6 * diameter)
    if point is not None and shapely.contains_xy(near, *point):
        window = bounds_of(study.polygon.polygon, study.target, point[None])
    object_panel(axes, study, window, margin=0.1)
    (x_0, x_1), (y_0, y_1) = axes.get_xlim(), axes.get_ylim()
    frame = shapely.box(x_0, y_0, x_1, y_1)
    for k, sector in enumerate(found):
        if sector is not None:
            shape = shapely.intersection(sector.forward, frame)
            fill(axes, shape, FINGERS[k], alpha=0.15, zorder=4)
            rim = shapely.intersection(sector.forward.boundary, frame)
            for line in shapely.get_parts(rim):
                axes.plot(*shapely.get_coordinates(line).T, color=FINGERS[k], lw=0.9, zorder=4)
    common = common_area(held) if len(held) == 3 else shapely.Point()
    area = shapely.intersection(common, frame)
    fill(axes, area, tint(ORANGE, 0.8), edge=INK, width=0.8, zorder=5, alpha=0.8)
    if point is not None:
        for k, contact in enumerate(study.target):
            line = np.array([contact, point])
            axes.plot(*line.T, color=FINGERS[k], lw=1.1, ls=(0, (4, 2)), zorder=6,
                      scalex=False, scaley=False)  # fmt: skip
        axes.plot(*point, "X", ms=6.5, color=INK, mec="white", mew=0.8, zorder=9)
    draw_hand(axes, study.target, width=1.0)
    keys = [
        Patch(fc=tint(QUIET_INK, 0.3), ec=QUIET_INK, label="sector of a contact (finger's colour)"),
        Patch(fc=tint(ORANGE, 0.8), ec=INK, label="common area"),
        Line2D([], [], ls="", marker="X", ms=6.0, color=INK, label="the lines of force meet"),
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=3)
    words = _words(found, held, area, point)
    axes.set_title(words, fontsize=8.0)
    return figure, words


def _words(
    found: list[Sector | None], held: list[Sector], area: BaseGeometry, point: FloatArray | None
) -> str:
    if len(held) < 3:
        bare = [str(k + 1) for k, s in enumerate(found) if s is None]
        return f"finger {', '.join(bare)} touches nothing: it has no sector"
    what = ", ".join(
        f"{k + 1} on {'a vertex' if s.vertex else 'an edge'}" for k, s in enumerate(held)
    )
    if not area.is_empty and area.area > 0.0:
        return f"fingers {what}; the three sectors share an area"
    if point is not None:
        return f"fingers {what}; no common area: the lines of force meet behind an edge"
    return f"fingers {what}; no common area: two forces balance alone"
