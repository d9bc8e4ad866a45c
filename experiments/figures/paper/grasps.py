"""All immobilizing grasps of one hand, side by side. [Bunis2018, Fig. 2]"""

from __future__ import annotations

import math

import numpy as np
import shapely
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Polygon, Rectangle

from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    ORANGE,
    PAPER,
)
from experiments.figures.drawing.shapes import as_path
from experiments.figures.paper.page import WIDTH, bounds_of, new_sheet
from experiments.figures.paper.study import Study
from icage.geometry.statics import free_fingers

_MOST = 120
"""Grasps shown; those beyond, with the largest sigma, are counted only."""

_TALLEST = 9.0
"""[inch]"""

_AROUND = 0.12
"""[diameter] Pictures end so far from the object: a free finger may be beyond."""

_TITLE = 10.0
"""[pt] Room above each picture."""


def draw(study: Study) -> tuple[Figure, str | None]:
    """A grid of pictures by sigma; the target framed, fingers that touch nothing hollow."""
    hands = study.grasps[:_MOST]
    near = shapely.box(*study.polygon.polygon.bounds).buffer(_AROUND * study.polygon.diameter)
    shown = [shapely.intersection(shapely.MultiPoint(contacts), near) for contacts in hands]
    x_0, y_0, x_1, y_1 = bounds_of(study.polygon.polygon, *shown)
    wide, tall = (
        x_1 - x_0 + 0.08 * (x_1 - x_0 + y_1 - y_0),
        y_1 - y_0 + 0.08 * (x_1 - x_0 + y_1 - y_0),
    )
    columns, zoom = _layout(len(hands), wide, tall)
    rows = math.ceil(len(hands) / columns)
    cell = np.array([72.0 * WIDTH / columns, zoom * tall + _TITLE])
    height = rows * cell[1] + 16.0
    figure = new_sheet(height / 72.0)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0.0, 72.0 * WIDTH)
    axes.set_ylim(0.0, height)
    axes.set_axis_off()
    small = min(4.5, 0.055 * float(cell.min()))
    middle = 0.5 * np.array([x_0 + x_1, y_0 + y_1])
    for number, contacts in enumerate(hands):
        row, column = divmod(number, columns)
        corner = np.array([column * cell[0], height - 14.0 - (row + 1) * cell[1]])
        centre = corner + 0.5 * (cell - [0.0, _TITLE])

        def at(points: np.ndarray, centre: np.ndarray = centre) -> np.ndarray:
            return centre + zoom * (points - middle)

        path = as_path(study.polygon.polygon)
        axes.add_patch(
            PathPatch(path.__class__(at(np.asarray(path.vertices)), path.codes), fc=OBJECT_FILL,
                      ec=OBJECT_EDGE, lw=0.4)
        )  # fmt: skip
        corners = at(contacts)
        room = Rectangle(
            (centre[0] - 0.49 * cell[0], corner[1]), 0.98 * cell[0], cell[1] - _TITLE,
            transform=axes.transData,
        )  # fmt: skip
        triangle = Polygon(corners, closed=True, fc="none", ec=INK, lw=0.7, joinstyle="round")
        axes.add_patch(triangle)
        triangle.set_clip_path(room)
        free = free_fingers(study.polygon, contacts)
        for k, point in enumerate(corners):
            face = PAPER if k + 1 in free else FINGERS[k]
            (dot,) = axes.plot(*point, "o", ms=small, mfc=face, mec=FINGERS[k], mew=0.6)
            dot.set_clip_path(room)
        framed = float(np.abs(contacts - study.target).max()) <= 1e-5 * study.polygon.diameter
        sigma = study.sigma_0 if framed else float(np.hypot(*(contacts[1] - contacts[0])))
        axes.text(
            centre[0], corner[1] + cell[1] - _TITLE + 0.5, rf"$\sigma$ = {sigma:.4g}",
            ha="center", va="bottom", fontsize=6.0,
        )  # fmt: skip
        if framed:
            axes.add_patch(
                Rectangle((corner[0] + 1.0, corner[1] + 0.5), cell[0] - 2.0, cell[1] - 1.0,
                          fc="none", ec=ORANGE, lw=1.2)
            )  # fmt: skip
    phi_1, phi_2 = study.hand.phi_deg
    more = f" (the first {_MOST} shown)" if len(study.grasps) > _MOST else ""
    note = f"{len(study.grasps)} immobilizing grasps of this hand{more}"
    words = (
        rf"{note}, $\varphi$ = ({phi_1:.1f}°, {phi_2:.1f}°), $\sigma$ in {study.case.unit}; "
        "hollow: a finger that touches nothing; framed: the target"
    )
    axes.text(6.0, height - 11.0, words, fontsize=7.0, va="baseline")
    return figure, note


def _layout(count: int, wide: float, tall: float) -> tuple[int, float]:
    """Columns, and points per unit: the largest pictures that fit on a page."""
    best = (1, 0.0)
    for columns in range(1, max(2, count + 1)):
        rows = math.ceil(max(1, count) / columns)
        across = 72.0 * WIDTH / columns / wide
        zoom = min(across, ((72.0 * _TALLEST - 16.0) / rows - _TITLE) / tall, 150.0 / tall)
        if zoom > best[1] * 1.0001:
            best = columns, zoom
    return best
