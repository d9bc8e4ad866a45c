"""One panel of the placement map: object, target grasp, caging regions, hexagons of rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, PathPatch, Rectangle
from shapely.geometry.base import BaseGeometry

from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
)
from experiments.figures.drawing.palette import Colour as Rgb
from experiments.figures.drawing.shapes import as_path, scale_bar_length, tidied
from experiments.figures.drawing.sheet import Bounds
from experiments.study.report.pictures import Page
from icage.arrays import BoolArray, FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion

_DOT: Final = 2.6
"""[pt] Least radius of a finger."""

PALE: Final = 0.35
"""[1] Share of its colour that a hexagon of few closings has; the rest is white."""

_HAIRLINE: Final = 0.4
"""[pt] Slits of the regions' inner bounds narrower than this are not drawn."""


def colours() -> Colormap:
    """Rates from 0 to 1: viridis, ever lighter, so that any kind of colour vision reads it."""
    return matplotlib.colormaps["viridis"]


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Hexagons (k) as they are drawn, the rate in each (k,) and whether it is of few closings."""

    shapes: Sequence[BaseGeometry]
    rates: FloatArray
    few: BoolArray


@dataclass(frozen=True, slots=True)
class Panel:
    """A window onto the object's frame, for one finger (0..2) or, at -1, for all.

    ``zoom`` in [pt] per unit of length.
    """

    finger: int
    window: Bounds
    zoom: float

    @property
    def title(self) -> str:
        """Which finger."""
        return "where the close-ups lie" if self.finger < 0 else f"finger {self.finger + 1}"

    @property
    def ink(self) -> Rgb:
        """Its colour."""
        return QUIET_INK if self.finger < 0 else FINGERS[self.finger]

    def frames(self, axes: Axes, windows: Sequence[Bounds]) -> None:
        """Draw the windows of the three fingers' panels."""
        for colour, (x_0, y_0, x_1, y_1) in zip(FINGERS, windows, strict=True):
            axes.add_patch(
                Rectangle((x_0, y_0), x_1 - x_0, y_1 - y_0, fc="none", ec=colour, lw=1.0, zorder=8)
            )


def draw_panel(
    axes: Axes,
    panel: Panel,
    cage: Cage,
    regions: Sequence[FingerRegion],
    cells: Cells | None,
    crosses: FloatArray,
    meant: FloatArray,
) -> None:
    """Draw everything inside the panel's window.

    ``crosses`` (n, 2) are starts of failed closings, ``meant`` (m, 2) where fingers should start.
    """
    x_0, y_0, x_1, y_1 = panel.window
    axes.set_xlim(x_0, x_1)
    axes.set_ylim(y_0, y_1)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set(color=QUIET_INK, linewidth=0.5)
    if cells is not None:
        _draw_cells(axes, cells)
    path = as_path(cage.outline.polygon)
    axes.add_patch(PathPatch(path, fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=0.8, zorder=2))
    for region in regions:
        _draw_region(axes, region, panel.zoom, is_solid(cage, region.level_name))
    _draw_target(axes, panel, cage)
    draw_crosses(axes, crosses)
    draw_meant(axes, meant)


def _draw_cells(axes: Axes, cells: Cells) -> None:
    faces = colours()(cells.rates)
    faces[cells.few] = PALE * faces[cells.few] + (1.0 - PALE)
    paths = [as_path(shape) for shape in cells.shapes]
    axes.add_collection(
        PathCollection(paths, facecolors=faces, edgecolors=faces, lw=0.3, zorder=1), autolim=False
    )


def draw_crosses(axes: Axes, places: FloatArray) -> None:
    """Small dark crosses, at (n, 2)."""
    if len(places):
        axes.plot(*places.T, ls="", marker="x", color=INK, ms=3.0, mew=0.9, zorder=6)


def draw_meant(axes: Axes, places: FloatArray) -> None:
    """Small white diamonds, at (n, 2)."""
    if len(places):
        axes.plot(*places.T, ls="", marker="D", mfc=PAPER, mec=INK, ms=4.0, mew=0.9, zorder=9)


def is_solid(cage: Cage, level_name: str) -> bool:
    """Whether a region at this level holds only starts whose closings end in the target."""
    return level_name == "sigma_first" or cage.sigma_first == cage.sigma_max


def region_style(solid: bool) -> tuple[float, Any]:
    """Width and dashes of a region's outline."""
    return (1.2, "-") if solid else (0.9, (0, (3.0, 2.0)))


def _draw_region(axes: Axes, region: FingerRegion, zoom: float, solid: bool) -> None:
    path = as_path(tidied(region.geometry, _HAIRLINE / zoom))
    width, dashes = region_style(solid)
    colour = FINGERS[region.finger - 1]
    if solid:
        axes.add_patch(PathPatch(path, fc="none", ec=PAPER, lw=width + 1.4, zorder=3))
    axes.add_patch(PathPatch(path, fc="none", ec=colour, lw=width, ls=dashes, zorder=4))


def _draw_target(axes: Axes, panel: Panel, cage: Cage) -> None:
    """The target's triangle and rings where its fingers stand, so that hexagons show through."""
    radius = max(cage.finger_radius, _DOT / panel.zoom)
    contacts = cage.contacts
    for start, end in zip(contacts, np.roll(contacts, -1, axis=0), strict=True):
        inset = radius * (end - start) / np.hypot(*(end - start))
        if np.hypot(*(end - start)) > 2.0 * radius:
            axes.add_line(
                Line2D(*np.array([start + inset, end - inset]).T, color=INK, lw=1.0, zorder=5)
            )
    for k, (corner, colour) in enumerate(zip(contacts, FINGERS, strict=True)):
        place = (float(corner[0]), float(corner[1]))
        width = 1.8 if panel.finger in (k, -1) else 1.0
        axes.add_patch(Circle(place, radius, fc="none", ec=PAPER, lw=width + 1.4, zorder=6))
        axes.add_patch(Circle(place, radius, fc="none", ec=colour, lw=width, zorder=7))


def draw_scale_bar(page: Page, x: float, y: float, zoom: float, unit: str) -> None:
    """A scale bar that starts at (x, y) of the page, its length written behind it."""
    length = scale_bar_length(70.0 / zoom)
    axes = page.axes(x, y - 2.5, length * zoom, 5.0)
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(-1.0, 1.0)
    for xs, ys in (((0, 1), (0, 0)), ((0, 0), (-1, 1)), ((1, 1), (-1, 1))):
        axes.add_line(Line2D(xs, ys, color=INK, lw=1.0, clip_on=False, solid_capstyle="butt"))
    page.text(x + length * zoom + 5.0, y - 2.7, f"{length:g} {unit}", 7.5)
