"""Sheets, panels and marks that the paper's figures have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import PathPatch, Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from experiments.figures.drawing.numbers import significant
from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
    RULE,
    Colour,
    tint,
)
from experiments.figures.drawing.shapes import as_pair, as_path, is_blank
from experiments.figures.paper.study import Study
from icage.formats.whole_files import whole_file
from icage.outline import Outline

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

FORMATS = ("svg", "pdf", "png")
WIDTH = 7.0
"""[inch] Both columns of a journal."""

SETTINGS: dict[RcKeyType, Any] = {
    "svg.hashsalt": "icage",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": QUIET_INK,
    "xtick.color": QUIET_INK,
    "ytick.color": QUIET_INK,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "text.color": INK,
    "axes.labelcolor": INK,
    "path.simplify": True,
}
HALO = [withStroke(linewidth=2.0, foreground="white")]

Points = NDArray[np.float64]


def new_sheet(height: float, width: float = WIDTH) -> Figure:
    """An empty figure, [inch], whose panels keep clear of each other."""
    clear = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.05)
    figure = Figure(figsize=(width, height), facecolor="white", layout=clear)
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: FilePath) -> None:
    """Write a figure whole or not at all, the same bytes for the same figure."""
    kind = path.suffix[1:]
    every: dict[str, dict[str, str | None]] = {
        "svg": {"Date": None}, "pdf": {"CreationDate": None, "Producer": "icage"},
        "png": {"Software": "icage"},
    }  # fmt: skip
    with matplotlib.rc_context(SETTINGS), whole_file(path) as part:
        figure.savefig(part, format=kind, dpi=300 if kind != "png" else 200, metadata=every[kind])


def heading(axes: Axes, letter: str, words: str) -> None:
    """``(a) words`` above a panel."""
    axes.set_title(f"({letter}) {words}", loc="left", fontsize=8.5, pad=5.0)


def bounds_of(*things: Points | BaseGeometry) -> tuple[float, float, float, float]:
    """Common bounds of points and shapes."""
    shapes = [t if isinstance(t, BaseGeometry) else shapely.MultiPoint(t) for t in things]
    x_0, y_0, x_1, y_1 = shapely.total_bounds(np.array(shapes, dtype=object))
    return float(x_0), float(y_0), float(x_1), float(y_1)


def object_panel(
    axes: Axes, study: Study, window: tuple[float, float, float, float], margin: float = 0.05,
    polygon: Outline | None = None,
) -> None:  # fmt: skip
    """The polygon in a window of the object's frame; with discs, the object itself inside it.

    ``polygon``: another one than that of the search.
    """
    axes.set_axis_off()
    axes.set_aspect("equal", anchor="W")
    side = margin * max(window[2] - window[0], window[3] - window[1])
    axes.set_xlim(window[0] - side, window[2] + side)
    axes.set_ylim(window[1] - side, window[3] + side)
    path = as_path((polygon or study.polygon).polygon)
    axes.add_patch(PathPatch(path, fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=0.8, zorder=3))
    if study.segments:
        inner = as_path(study.case.outline.polygon)
        axes.add_patch(PathPatch(inner, fc=tint(OBJECT_EDGE, 0.25), ec="none", zorder=3))


def draw_hand(
    axes: Axes, contacts: Points, *, solid: bool = True, free: Sequence[int] = (),
    size: float = 5.0, numbers: bool = True, colour: Colour = INK, width: float = 1.2,
    beside: Mapping[int, Points] | None = None,
) -> None:  # fmt: skip
    """Triangle and fingers of a hand (3, 2); ``free`` fingers (0..2) are hollow.

    ``beside`` holds arrows that the numbers keep off: their directions, by finger.
    """
    style = "-" if solid else (0, (3.5, 2.2))
    triangle = Polygon(contacts, closed=True, fc="none", ec=colour, lw=width, ls=style, zorder=6)
    axes.add_patch(triangle)
    middle = contacts.mean(axis=0)
    for k, point in enumerate(contacts):
        face = PAPER if k in free or not solid else FINGERS[k]
        axes.plot(
            *point, "o", ms=size, mfc=face, mec=FINGERS[k], mew=1.1, zorder=7, clip_on=False
        )  # fmt: skip
        if numbers:
            way = point - middle
            if beside is not None and k in beside:
                across = np.array([-beside[k][1], beside[k][0]])
                way = across if across @ way >= 0.0 else -across
            way = way / max(float(np.hypot(*way)), 1e-300)
            axes.annotate(
                str(k + 1), as_pair(point), as_pair(way * (4.5 + size)),
                textcoords="offset points", ha="center", va="center", fontsize=7.5,
                color=FINGERS[k], fontweight="bold", zorder=8, path_effects=HALO,
                annotation_clip=False,
            )  # fmt: skip


def space_panel(axes: Axes, study: Study, pair: int, *, grid: bool = True) -> None:
    """U_{i,i+1}: the square [0, L]^2 with its rectangles and its diagonal."""
    total = study.boundary.perimeter
    axes.set_xlim(0.0, total)
    axes.set_ylim(0.0, total)
    axes.set_aspect("equal")
    if grid:
        lines = study.boundary.s_0[1:-1]
        width = 0.4 if len(lines) < 30 else 0.15
        axes.vlines(lines, 0.0, total, color=RULE, lw=width, zorder=1)
        axes.hlines(lines, 0.0, total, color=RULE, lw=width, zorder=1)
    axes.plot([0.0, total], [0.0, total], color=QUIET_INK, lw=0.8, ls=(0, (4.0, 2.0)), zorder=4)
    one, two = pair + 1, (pair + 1) % 3 + 1
    unit = study.case.unit
    axes.set_xlabel(rf"$s_{one}$ [{unit}]", labelpad=1.0)
    axes.set_ylabel(rf"$s_{two}$ [{unit}]", labelpad=1.0)
    axes.locator_params(nbins=5)
    axes.tick_params(length=2.0, pad=1.5)


def space_name(pair: int) -> str:
    """``U_12`` as mathematics."""
    return rf"$\mathcal{{U}}_{{{pair + 1}{(pair + 1) % 3 + 1}}}$"


def fill(
    axes: Axes, shape: BaseGeometry, colour: Colour | str, *, edge: Colour | None = None,
    zorder: float = 2, width: float = 0.5, alpha: float = 1.0, hatch: str | None = None,
) -> None:  # fmt: skip
    """A filled shape in the panel's own coordinates."""
    path = as_path(shape)
    if not is_blank(path):
        line = 0.0 if edge is None else width
        patch = PathPatch(
            path, fc=colour, ec=edge or "none", lw=line, alpha=alpha, hatch=hatch, zorder=zorder
        )
        axes.add_patch(patch)


def level(study: Study, sigma: float) -> str:
    """``1.234 mm`` and the ratio to sigma_0."""
    value = f"{significant(sigma)} {study.case.unit}"
    if sigma == study.sigma_0:
        return value
    return rf"{value} = {significant(sigma / study.sigma_0)}$\,\sigma_0$"
