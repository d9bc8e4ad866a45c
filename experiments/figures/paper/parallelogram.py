"""A parallelogram over the pieces of the plane, its rectangle, its nodes. [Bunis2018, Fig. 6]"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, QUIET_INK, SKY, Colour, tint
from experiments.figures.paper.obstacles import OBSTACLE
from experiments.figures.paper.page import (
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
from icage.contact_space.formation_scale import ScaleForm
from icage.contact_space.free_regions import exterior_rings, regions_of_rectangle
from icage.contact_space.nodes import Node, nodes_of_region
from icage.contact_space.third_finger import Parallelogram

VERTEX, EXTREMUM, MINIMUM, SADDLE = FINGERS[1], FINGERS[2], FINGERS[0], ORANGE
Rectangle = tuple[int, int, int]
"""Pair, edges j and k."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) the plane; (b) regions and nodes of R_jk; (c) the edges of the caging graph."""
    pair, j, k = _rectangle(study)
    boundary = study.boundary
    regions = [r for _, r in regions_of_rectangle(study.plane, boundary, pair, j, k)]
    nodes = [nodes_of_region(boundary, study.hand, pair, j, k, r) for r in regions]
    figure = new_sheet(2.85)
    figure.set_layout_engine("none")
    plane, space, graph = (
        figure.add_axes((left / 7.0, 0.72 / 2.85, 1.8 / 7.0, 1.8 / 2.85))
        for left in (0.1, 2.5, 5.0)
    )
    _plane(plane, study, pair, j, k)
    heading(plane, "a", "parallelogram and pieces")
    for axes in (space, graph):
        _rectangle_panel(axes, study, pair, j, k, regions)
    _contours(space, study, pair, j, k)
    heading(space, "b", f"regions, nodes in {space_name(pair)}")
    lines = [[a.s, b.s] for group in nodes for a, b in combinations(group, 2)]
    graph.add_collection(LineCollection(lines, colors=[tint(INK, 0.7)], linewidths=0.35, zorder=4))
    heading(graph, "c", "edges of the graph")
    for axes in (space, graph):
        _nodes(axes, [node for group in nodes for node in group])
        _critical(axes, study, pair, j, k)
    keys = [
        _key("o", VERTEX, "vertex of a region", 3.5),
        _key("^", EXTREMUM, r"extremum of $\sigma$ on an edge", 4.0),
        _key("o", MINIMUM, "local minimum", 6.5),
        _key("s", SADDLE, "puncture (saddle)", 6.0),
    ]
    figure.legend(handles=keys, loc="lower center", ncols=4)
    count = len({(round(n.s[0], 9), round(n.s[1], 9)) for group in nodes for n in group})
    return figure, f"edges {j} and {k}: {len(regions)} convex regions, {count} nodes"


def _key(marker: str, colour: Colour, label: str, size: float) -> Line2D:
    return Line2D([], [], ls="", marker=marker, ms=size, mfc=colour, mec="white", label=label)


def _hands(study: Study) -> list[tuple[FloatArray, bool]]:
    """Critical hands of this case and whether they are minima."""
    minima = [study.target, *(g.contacts for g in study.cage.grasps)]
    return [(c, True) for c in minima] + [(p.contacts, False) for p in study.cage.punctures]


def _in_rectangle(study: Study, contacts: FloatArray, at: Rectangle) -> FloatArray | None:
    """(s_i, s_{i+1}) of a hand whose fingers i, i + 1 are on edges j, k, or None."""
    pair, j, k = at
    s: list[float] = []
    for finger, edge in ((pair, j), ((pair + 1) % 3, k)):
        off = contacts[finger] - study.boundary.start[edge]
        along = float(off @ study.boundary.tangent[edge])
        inside = float(np.clip(along, 0.0, study.boundary.length[edge]))
        if np.hypot(*(off - inside * study.boundary.tangent[edge])) > study.near:
            return None
        s.append(float(study.boundary.s_0[edge]) + inside)
    return np.array(s)


def _rectangle(study: Study) -> Rectangle:
    """An explored rectangle with the target or a puncture in it, obstacles and several regions."""
    explored = {(int(i), int(j), int(k)) for i, j, k in study.found.regions[:, :3] if j != k}
    best, found = -1.0, min(explored)
    for at in sorted(explored):
        marks = {kind for c, kind in _hands(study) if _in_rectangle(study, c, at) is not None}
        if not marks:
            continue
        boundary = study.boundary
        regions = regions_of_rectangle(study.plane, boundary, *at)
        size = boundary.length[[at[1], at[2]]]
        free = sum(shapely.Polygon(r).area for _, r in regions) / float(size.prod())
        shape = float(size.min() / size.max())
        nodes = [n for _, r in regions for n in nodes_of_region(boundary, study.hand, *at, r)]
        extrema = sum(n.kind == "extremum" for n in nodes)
        score = 3.0 * len(marks) + min(len(regions), 6) + 2.0 * (0.1 < free < 0.97)
        score += 3.0 * shape + min(extrema, 4)
        if score > best:
            best, found = score, at
    return found


def _plane(axes: Axes, study: Study, pair: int, j: int, k: int) -> None:
    boundary = study.boundary
    finger = Parallelogram.over(boundary, study.hand, pair, j, k)
    ends = [boundary.start[[e, (e + 1) % len(boundary)]] for e in (j, k)]
    object_panel(axes, study, bounds_of(finger.corners, *ends, study.target), margin=0.1)
    frame = shapely.box(
        axes.get_xlim()[0], axes.get_ylim()[0], axes.get_xlim()[1], axes.get_ylim()[1]
    )
    shape = shapely.Polygon(finger.corners)
    number = 0
    for ring in exterior_rings(study.plane):
        piece = shapely.intersection(shapely.Polygon(ring), frame)
        fill(axes, piece, (1.0, 1.0, 1.0), edge=tint(QUIET_INK, 0.6), width=0.5, zorder=1)
        part = shapely.intersection(shapely.Polygon(ring), shape)
        if part.area > 1e-6 * shape.area:
            fill(axes, part, tint(SKY, (0.22, 0.42)[number % 2]), edge=QUIET_INK, zorder=2)
            number += 1
    corners = finger.corners
    axes.plot(*np.vstack([corners, corners[:1]]).T, color=INK, lw=1.3, zorder=5)
    for line, which in zip(ends, (pair, (pair + 1) % 3), strict=True):
        axes.plot(*line.T, color=FINGERS[which], lw=2.6, zorder=5, solid_capstyle="round")
    mark = next(c for c, _ in _hands(study) if _in_rectangle(study, c, (pair, j, k)) is not None)
    draw_hand(axes, mark, width=0.8)


def _rectangle_panel(
    axes: Axes, study: Study, pair: int, j: int, k: int, regions: list[FloatArray]
) -> None:
    corners = study.boundary.rectangle(j, k)
    fill(axes, shapely.Polygon(corners), OBSTACLE, zorder=1)
    for number, region in enumerate(regions):
        colour = tint(SKY, (0.22, 0.42)[number % 2])
        fill(axes, shapely.Polygon(region), colour, edge=QUIET_INK, zorder=2)
    side = 0.04 * (corners[2] - corners[0])
    axes.set_xlim(corners[0, 0] - side[0], corners[2, 0] + side[0])
    axes.set_ylim(corners[0, 1] - side[1], corners[2, 1] + side[1])
    axes.set_box_aspect(1.0)
    unit = study.case.unit
    axes.set_xlabel(rf"$s_{pair + 1}$ [{unit}]", labelpad=1.0)
    axes.set_ylabel(rf"$s_{(pair + 1) % 3 + 1}$ [{unit}]", labelpad=1.0)
    axes.locator_params(nbins=4)
    axes.tick_params(length=2.0, pad=1.5)


def _contours(axes: Axes, study: Study, pair: int, j: int, k: int) -> None:
    form = ScaleForm.of(study.boundary, study.hand, pair, j, k)
    corners = study.boundary.rectangle(j, k)
    s = np.linspace(corners[0, 0], corners[2, 0], 80)
    u = np.linspace(corners[0, 1], corners[2, 1], 80)
    sigma = form(np.stack(np.meshgrid(s, u), axis=-1))
    axes.contour(s, u, sigma, 10, colors=[tint(INK, 0.6)], linewidths=0.4, zorder=3)


def _nodes(axes: Axes, nodes: list[Node]) -> None:
    for kind, marker, colour, size in (
        ("vertex", "o", VERTEX, 3.2), ("escape", "o", VERTEX, 3.2),
        ("extremum", "^", EXTREMUM, 4.0),
    ):  # fmt: skip
        rows = np.array([n.s for n in nodes if n.kind == kind]).reshape(-1, 2)
        axes.plot(
            *rows.T,
            marker,
            ms=size,
            mfc=colour,
            mec="white",
            mew=0.4,
            zorder=6,
            ls="",
            clip_on=False,
        )


def _critical(axes: Axes, study: Study, pair: int, j: int, k: int) -> None:
    for contacts, minimum in _hands(study):
        s = _in_rectangle(study, contacts, (pair, j, k))
        if s is not None:
            marker, colour = ("o", MINIMUM) if minimum else ("s", SADDLE)
            axes.plot(*s, marker, ms=6.5, mfc=colour, mec="white", mew=0.8, zorder=7, clip_on=False)
