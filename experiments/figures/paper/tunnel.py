"""One tunnel edge, drawn in the plane. [Bunis2018, Fig. 7]"""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from shapely.geometry.base import BaseGeometry

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, PURPLE, QUIET_INK, SKY, tint
from experiments.figures.drawing.shapes import as_pair
from experiments.figures.paper.page import (
    HALO,
    bounds_of,
    draw_hand,
    fill,
    heading,
    new_sheet,
    object_panel,
    space_name,
)
from experiments.figures.paper.study import Study
from icage.arrays import FloatArray
from icage.contact_space.kernels.explore import PINCH, SEAM
from icage.geometry.statics import free_fingers

NONE = "no tunnel edge in this search: every minimum it met is one of free space too"


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) the non-feasible minimum; (b) the hand shrinks; (c) where it lands."""
    edge = _tunnel(study)
    if edge is None:
        return _nothing(study)
    found, plane = study.found, study.plane
    origin, to, keep, kind = (int(v) for v in found.edges[edge])
    kept = (int(found.regions[origin, 0]) + keep) % 3
    before = plane.contacts(found.hands[edge, 1:5])
    pinched = kind == PINCH
    after = np.tile(before[kept], (3, 1)) if pinched else plane.contacts(found.hands[edge, 5:9])
    figure = new_sheet(2.9)
    panels = figure.subplots(
        1, 2 if pinched else 3, width_ratios=(1, 1) if pinched else (1, 1, 0.95)
    )
    window = bounds_of(before, after, _surroundings(study, before))
    object_panel(panels[0], study, window)
    free = tuple(k - 1 for k in free_fingers(study.polygon, before))
    draw_hand(panels[0], before, free=free)
    sigma = float(found.hands[edge, 0])
    heading(panels[0], "a", rf"minimum of $\mathcal{{U}}$ only, $\sigma$ = {sigma:.4g}")
    object_panel(panels[1], study, window)
    _shrinking(panels[1], study, before, after, kept, pinched)
    words = "a pinch: escaped" if pinched else f"finger {kept + 1} stays, the hand shrinks"
    heading(panels[1], "b", words)
    if not pinched:
        low = float(found.nodes[to, 0])
        _landing(panels[2], study, to, after)
        heading(panels[2], "c", rf"lands at $u$; $\sigma(v_2)$ = {low:.4g}")
    where = "pinches" if pinched else f"lands at sigma {np.hypot(*(after[1] - after[0])):.6g}"
    return figure, f"tunnel edge at sigma {sigma:.6g}: finger {kept + 1} stays, the hand {where}"


def _tunnel(study: Study) -> int | None:
    """The tunnel edge to show: on the way out if there is one, else the one that shrinks most."""
    edges = study.found.edges
    tunnels = [int(e) for e in np.flatnonzero(edges[:, 3] != SEAM)]
    landing = [e for e in tunnels if edges[e, 3] != PINCH]
    way = [e for e in study.found.way_out() if e in tunnels]
    for some in ([e for e in way if e in landing], landing, way, tunnels):
        if some:
            size = np.hypot(*study.found.hands[some, 7:9].T) / study.found.hands[some, 0]
            return some[int(np.argmin(size))]
    return None


def _nothing(study: Study) -> tuple[Figure, str]:
    figure = new_sheet(3.0, 4.0)
    axes = figure.subplots()
    object_panel(axes, study, bounds_of(study.polygon.polygon, study.target))
    draw_hand(axes, study.target)
    figure.supxlabel(NONE, fontsize=7.0)
    return figure, NONE


def _surroundings(study: Study, contacts: FloatArray) -> BaseGeometry:
    """The object, or its part near the hand if the hand is small on it."""
    size = float(np.ptp(contacts, axis=0).max())
    near = shapely.MultiPoint(contacts).envelope.buffer(0.6 * size, join_style="mitre")
    return shapely.intersection(study.polygon.polygon, near).envelope


def _shrinking(
    axes: Axes, study: Study, before: FloatArray, after: FloatArray, kept: int, pinched: bool
) -> None:
    draw_hand(axes, before, solid=False, numbers=False, size=3.5, colour=QUIET_INK, width=0.9)
    for k in range(3):
        if k != kept:
            axes.annotate(
                "", after[k], before[k], zorder=8, annotation_clip=False,
                arrowprops={"arrowstyle": "-|>", "color": FINGERS[k], "lw": 1.4, "shrinkB": 2.0},
            )  # fmt: skip
    if not pinched:
        draw_hand(axes, after, free=tuple(k - 1 for k in free_fingers(study.polygon, after)))
    axes.plot(*before[kept], "o", ms=5.0, color=FINGERS[kept], zorder=8)
    axes.plot(*before[kept], "o", ms=9.0, mfc="none", mec=ORANGE, mew=1.4, zorder=8)


def _landing(axes: Axes, study: Study, to: int, after: FloatArray) -> None:
    """The convex region that holds u, and its least node v_2."""
    found, boundary = study.found, study.boundary
    region = found.regions[to]
    pair, j, k = (int(v) for v in region[:3])
    corner = boundary.s_0[[j, k]]
    polygon = corner + study.plane.corners(region)
    rectangle = boundary.rectangle(j, k)
    fill(axes, shapely.Polygon(rectangle), tint(INK, 0.08), edge=QUIET_INK, zorder=1)
    fill(axes, shapely.MultiPoint(polygon).convex_hull, tint(SKY, 0.4), edge=QUIET_INK, zorder=2)
    fingers = after[[pair, (pair + 1) % 3]]
    u = corner + ((fingers - boundary.start[[j, k]]) * boundary.tangent[[j, k]]).sum(axis=1)
    low = corner + found.nodes[to, 1:3]
    axes.plot(*np.array([u, low]).T, color=PURPLE, lw=1.2, zorder=4)
    for point, name, colour in ((u, "$u$", ORANGE), (low, "$v_2$", PURPLE)):
        axes.plot(*point, "o", ms=5.5, mfc=colour, mec="white", mew=0.8, zorder=6, clip_on=False)
        inward = np.sign(rectangle.mean(axis=0) - point)
        axes.annotate(
            name, as_pair(point), as_pair(8.0 * inward), textcoords="offset points",
            ha="center", va="center", fontsize=9.0, zorder=7, path_effects=HALO,
        )  # fmt: skip
    side = 0.05 * (rectangle[2] - rectangle[0])
    axes.set_xlim(rectangle[0, 0] - side[0], rectangle[2, 0] + side[0])
    axes.set_ylim(rectangle[0, 1] - side[1], rectangle[2, 1] + side[1])
    axes.set_box_aspect(1.0)
    axes.set_xlabel(rf"$s_{pair + 1}$ [{study.case.unit}],  {space_name(pair)}", labelpad=1.0)
    axes.set_ylabel(rf"$s_{(pair + 1) % 3 + 1}$ [{study.case.unit}]", labelpad=1.0)
    axes.locator_params(nbins=4)
    axes.tick_params(length=2.0, pad=1.5)
