"""A third-finger parallelogram and the contact space obstacles. [Bunis2018, Fig. 4]"""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiments.figures.drawing.palette import BAD, FINGERS, INK, ORANGE, Colour, tint
from experiments.figures.paper.page import (
    HALO,
    bounds_of,
    draw_hand,
    fill,
    heading,
    new_sheet,
    object_panel,
    space_name,
    space_panel,
)
from experiments.figures.paper.study import Study
from icage.contact_space.obstacles import obstacles
from icage.contact_space.third_finger import Parallelogram

_PAIR = 2
"""U_31, as in the paper."""

OBSTACLE = tint(INK, 0.62)


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) the parallelogram on the object; (b)-(d) all three contact spaces."""
    j, k = telling_rectangle(study, _PAIR)
    figure = new_sheet(7.0)
    panels = figure.subplots(2, 2)
    draw_parallelogram(panels[0, 0], study, _PAIR, j, k, infeasible=True)
    heading(panels[0, 0], "a", f"finger 2 for fingers 3, 1 on edges {j}, {k}")
    for axes, pair, letter in zip(
        (panels[0, 1], panels[1, 0], panels[1, 1]), (2, 0, 1), "bcd", strict=True
    ):
        space_panel(axes, study, pair)
        draw_obstacles(axes, study, pair)
        third = (pair + 2) % 3 + 1
        heading(axes, letter, f"{space_name(pair)}: obstacles of finger {third}")
        for point in study.places(study.target, pair):
            axes.plot(
                *point, "o", ms=5.0, mfc=FINGERS[0], mec="white", mew=0.8, zorder=6, clip_on=False
            )
        if pair == _PAIR:
            corners = study.boundary.rectangle(j, k)
            fill(axes, shapely.Polygon(corners), ORANGE, alpha=0.25, zorder=4)
            axes.plot(*np.vstack([corners, corners[:1]]).T, color=ORANGE, lw=1.4, zorder=5)
    keys = [
        Patch(fc=tint(BAD, 0.55), ec=BAD, label="infeasible third finger"),
        Patch(fc=OBSTACLE, label="contact space obstacle"),
        Patch(fc=tint(ORANGE, 0.25), ec=ORANGE, label=r"the rectangle of (a)"),
        Line2D([], [], ls="", marker="o", ms=4.5, color=FINGERS[0], label="target grasp"),
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=4)
    return figure, None


def draw_obstacles(axes: Axes, study: Study, pair: int, colour: Colour = OBSTACLE) -> None:
    """The obstacles of a contact space, with fewer corners where nobody could see them."""
    shape = obstacles(study.boundary, study.hand, pair)
    fill(axes, shape.simplify(2e-4 * study.boundary.perimeter), colour, zorder=2)


def draw_parallelogram(
    axes: Axes, study: Study, pair: int, j: int, k: int, *, infeasible: bool
) -> None:
    """Edges j and k, the parallelogram over them, its part inside the object, and u, v, w."""
    finger = Parallelogram.over(study.boundary, study.hand, pair, j, k)
    corners = finger.corners
    object_panel(axes, study, bounds_of(study.polygon.polygon, corners))
    if infeasible:
        inside = shapely.intersection(shapely.Polygon(corners), study.polygon.polygon)
        fill(axes, inside, tint(BAD, 0.55), edge=BAD, zorder=4)
    axes.plot(*np.vstack([corners, corners[:1]]).T, color=FINGERS[(pair + 2) % 3], lw=1.3, zorder=5)
    boundary = study.boundary
    for edge, which in ((j, pair), (k, (pair + 1) % 3)):
        ends = boundary.on_edge(edge, boundary.s_0[edge : edge + 2])
        if edge == len(boundary) - 1:
            ends = np.array([boundary.start[edge], boundary.start[0]])
        axes.plot(*ends.T, color=FINGERS[which], lw=2.6, zorder=5, solid_capstyle="round")
    middle = finger.s_0 + 0.5 * finger.size
    points = np.empty((3, 2))
    points[pair] = boundary.on_edge(j, middle[0])
    points[(pair + 1) % 3] = boundary.on_edge(k, middle[1])
    points[(pair + 2) % 3] = finger.at(middle)
    draw_hand(axes, points, width=0.8)
    _name_corner(axes, finger, corners)


def _name_corner(axes: Axes, finger: Parallelogram, corners: np.ndarray) -> None:
    away = corners[0] - corners.mean(axis=0)
    away = away / max(float(np.hypot(*away)), 1e-300)
    axes.plot(*corners[0], "s", ms=2.5, color=INK, zorder=6)
    axes.annotate(
        r"$\vec{u}$", corners[0], 8.0 * away, textcoords="offset points", ha="center", va="center",
        annotation_clip=False, zorder=8,
    )  # fmt: skip
    for vector, length, name in (
        (finger.v, finger.size[0], r"$L_i\vec{v}$"),
        (finger.w, finger.size[1], r"$L_{i+1}\vec{w}$"),
    ):
        tip = corners[0] + length * vector
        axes.annotate(
            "", tip, corners[0], arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 0.9},
            annotation_clip=False, zorder=7,
        )  # fmt: skip
        half = 0.5 * (tip + corners[0])
        side = half - corners.mean(axis=0)
        side = side / max(float(np.hypot(*side)), 1e-300)
        axes.annotate(
            name, half, 11.0 * side, textcoords="offset points", ha="center", va="center",
            annotation_clip=False, zorder=9, fontsize=7.5, path_effects=HALO,
        )  # fmt: skip


def telling_rectangle(study: Study, pair: int) -> tuple[int, int]:
    """The rectangle whose parallelogram has most area on both sides of the boundary."""
    n = len(study.boundary)
    rows = [(j, k) for j in range(n) for k in range(n) if j != k]
    corners = [Parallelogram.over(study.boundary, study.hand, pair, j, k).corners for j, k in rows]
    shapes = shapely.polygons(np.array(corners))
    covered = shapely.area(shapely.intersection(shapes, study.polygon.polygon))
    free = shapely.area(shapes) - covered
    # a large parallelogram makes the object small on the page
    spread = shapely.length(shapely.envelope(shapes)) / study.polygon.diameter
    return rows[int(np.argmax(np.minimum(covered, free) / np.maximum(4.0, spread)))]
