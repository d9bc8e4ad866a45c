"""The boundary by arclength, and U_12 with the contours of sigma. [Bunis2018, Fig. 3]"""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from experiments.figures.drawing.palette import FINGERS, INK, ORANGE, PURPLE, QUIET_INK
from experiments.figures.paper.page import (
    bounds_of,
    draw_hand,
    heading,
    level,
    new_sheet,
    object_panel,
    space_name,
    space_panel,
)
from experiments.figures.paper.study import Study
from icage.contact_space.formation_scale import formation_scale

_STEPS = 240
"""Points a side between which contours are drawn, besides the vertices."""

_LEVELS = 12


def draw(study: Study) -> tuple[Figure, str | None]:
    """(a) s round the object, the target; (b) U_12."""
    figure = new_sheet(3.7)
    plane, space = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    _arclength(plane, study)
    heading(plane, "a", r"the boundary by arclength $s$")
    space_panel(space, study, 0)
    heading(space, "b", space_name(0) + r" with contours of $\sigma(s_1, s_2)$")
    boundary = study.boundary
    s = np.unique(np.concatenate([np.linspace(0.0, boundary.perimeter, _STEPS), boundary.s_0]))
    sigma = formation_scale(boundary, study.hand, 0, *np.meshgrid(s, s))
    levels = MaxNLocator(_LEVELS).tick_values(0.0, float(sigma.max()))[1:-1]
    colours = ListedColormap(colormaps["cividis"](np.linspace(0.0, 0.88, 256)))
    drawn = space.contour(s, s, sigma, levels, cmap=colours, linewidths=0.7, zorder=2)
    figure.colorbar(drawn, ax=space, shrink=0.85, label=rf"$\sigma$ [{study.case.unit}]", pad=0.02)
    keys = []
    for value, colour, name in (
        (study.sigma_0, ORANGE, r"$\sigma_0$"),
        (study.answer.sigma_max, PURPLE, r"$\sigma_{\mathrm{max}}$"),
    ):
        if value is not None and value < sigma.max():
            space.contour(s, s, sigma, [value], colors=[colour], linewidths=1.3, zorder=3)
            keys.append(
                Line2D([], [], color=colour, lw=1.3, label=f"{name} = {level(study, value)}")
            )
    for point in study.places(study.target, 0):
        space.plot(*point, "o", ms=5.0, mfc=INK, mec="white", mew=0.8, zorder=6, clip_on=False)
    keys.append(Line2D([], [], ls="", marker="o", ms=4.5, color=INK, label="target grasp"))
    keys.append(
        Line2D([], [], color=QUIET_INK, ls=(0, (4, 2)), lw=0.8, label=r"$\Delta_{12}$: pinched")
    )
    figure.legend(handles=keys, loc="outside lower center", ncols=4)
    return figure, None


def _arclength(axes: Axes, study: Study) -> None:
    """Numbers of the edges (few) or arclengths now and then, and an arrow at s = 0."""
    boundary = study.boundary
    object_panel(axes, study, bounds_of(study.polygon.polygon, study.target), margin=0.12)
    draw_hand(axes, study.target)
    out = np.column_stack([boundary.tangent[:, 1], -boundary.tangent[:, 0]])
    if len(boundary) <= 16:
        at = boundary.s_0[:-1]
        normal = out + np.roll(out, 1, axis=0)
    else:
        at = np.linspace(0.0, boundary.perimeter, 11)[:-1]
        normal = out[boundary.edge_at(at)]
    normal = normal / np.maximum(np.hypot(*normal.T), 1e-9)[:, None]
    taken = np.empty((0, 2))
    for value, point, way in zip(at, boundary.at(at), normal, strict=True):
        near = np.hypot(*(study.target - point).T).min() / study.polygon.diameter
        others = np.hypot(*(taken - point).T) / study.polygon.diameter
        if len(boundary) > 16 and min(near, *others, 1.0) < 0.1:
            continue
        taken = np.vstack([taken, point])
        if near < 0.03:
            way = -way  # the finger's number is outside
        axes.plot(*point, "o", ms=2.0, color=QUIET_INK, zorder=5)
        axes.annotate(
            f"{value:.3g}", point, 8.0 * way, textcoords="offset points", fontsize=6.0,
            color=INK, zorder=9, ha="center", va="center", annotation_clip=False,
        )  # fmt: skip
    length = 0.12 * study.polygon.diameter
    start = boundary.start[0] + 0.03 * study.polygon.diameter * out[0]
    axes.annotate(
        "", start + length * boundary.tangent[0], start, annotation_clip=False,
        arrowprops={"arrowstyle": "->", "color": FINGERS[1], "lw": 1.2},
    )  # fmt: skip
    axes.annotate(
        "$s$", start + length * boundary.tangent[0], 6.0 * boundary.tangent[0], color=FINGERS[1],
        textcoords="offset points", ha="center", va="center", annotation_clip=False,
    )  # fmt: skip
