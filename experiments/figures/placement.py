"""The figure of a placement: the open hand with the room round its fingers, and the turns and
shifts that it bears.

matplotlib's Figure without pyplot: the same bytes for the same placement.
"""

from __future__ import annotations

from math import degrees
from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.patheffects import withStroke

from experiments.figures.drawing.palette import (
    FINGERS,
    INK,
    OBJECT_EDGE,
    OBJECT_FILL,
    PAPER,
    QUIET_INK,
    RULE,
    tint,
)
from experiments.figures.drawing.shapes import as_path, scale_bar_length, tidied
from experiments.figures.drawing.written import check_suffix, settings, write
from experiments.io.one_line import in_figure
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.regions import caging_regions
from icage.placing.best import BestPlacement

_SIZE = (7.0, 3.3)
"""[inch] Two columns of a journal."""

_HAND = (0.01, 0.03, 0.56, 0.83)
_CURVE = (0.665, 0.16, 0.315, 0.68)
"""Left, bottom, width and height of the two parts, in shares of the figure."""

_REGION = 0.30
"""[1] Strength of a region's colour."""

_DETAIL = 1.5e-3
"""[shares of the view] Nothing smaller is drawn of a region."""

_DOT = 0.009
"""[shares of the view] Radius of a point finger's dot."""

_NUMBER_FITS = 0.022
"""[shares of the view] A disc this large carries its number inside."""

_BARELY = 1.0015
"""[sigma_0] A hand opened to less is opened by so much: four digits would not show it."""

_POINTS = 257


def draw_placement(cage: Cage, best: BestPlacement, name: str, unit: str, path: Path) -> None:
    """Draw a placement into an SVG or PNG file (by suffix), whole or not at all.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png.
    """
    check_suffix(path)
    with settings(font_size=8.0):
        write(placement_figure(cage, best, name, unit), path)


def placement_figure(cage: Cage, best: BestPlacement, name: str, unit: str) -> Figure:
    """The figure itself, before it is written."""
    figure = Figure(figsize=_SIZE, facecolor="white")
    FigureCanvasAgg(figure)
    _draw_hand(figure.add_axes(_HAND), cage, best, unit)
    _draw_curve(figure.add_axes(_CURVE), best, unit)
    figure.text(
        0.02, 0.945, in_figure(name), fontsize=9.5, fontweight="bold", color=INK, va="center",
        parse_math=False,
    )  # fmt: skip
    figure.text(0.02, 0.89, _words(cage, best, unit), fontsize=8.0, color=INK, va="center")
    return figure


def _words(cage: Cage, best: BestPlacement, unit: str) -> str:
    """What is promised, in one line."""
    errs = ", opening included" if best.opening_error else ""
    friction = f", friction up to {best.mu:g}" if best.mu else ""
    size = best.placement.sigma / cage.sigma_0
    opened = f"to {size:.4g}" if size >= _BARELY else f"by {size - 1.0:.3g}"
    return (
        f"each finger may be off by $r$ = {best.tolerance:.4g} {unit}{errs}; opened {opened} "
        f"$\\sigma_0${friction}"
    )


def _draw_hand(axes: Axes, cage: Cage, best: BestPlacement, unit: str) -> None:
    """Object, regions, target, the open hand and the room round its fingers."""
    regions = [r for r in caging_regions(cage, best.level) if r.bound == "inner"]
    room = cage.finger_radius + best.tolerance
    view = _view(cage, best, [r.geometry for r in regions], room)
    side = view[2] - view[0]
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    axes.set_aspect("equal")
    axes.set_axis_off()
    for region in regions:
        colour = FINGERS[region.finger - 1]
        path = as_path(tidied(region.geometry, _DETAIL * side))
        axes.add_patch(
            PathPatch(path, fc=tint(colour, _REGION), ec=colour, lw=0.4, alpha=0.85, zorder=1)
        )
    outline = as_path(cage.outline.polygon)
    axes.add_patch(PathPatch(outline, fc=OBJECT_FILL, ec=OBJECT_EDGE, lw=0.9, zorder=2))
    axes.add_patch(
        Polygon(cage.contacts, fc="none", ec=QUIET_INK, lw=0.7, ls=(0, (3, 2)), zorder=3)
    )
    axes.add_patch(Polygon(best.fingers, fc="none", ec=INK, lw=1.1, joinstyle="round", zorder=4))
    disc = cage.finger_radius if cage.finger_radius > 0.0 else _DOT * side
    for k, (x, y) in enumerate(best.fingers.tolist()):
        colour = FINGERS[k]
        axes.add_patch(Circle((x, y), room, fc="none", ec=PAPER, lw=2.0, alpha=0.8, zorder=5))
        axes.add_patch(Circle((x, y), room, fc="none", ec=colour, lw=1.1, zorder=6))
        axes.add_patch(Circle((x, y), disc, fc=colour, ec=PAPER, lw=0.5, zorder=7))
        inside = disc >= _NUMBER_FITS * side
        away = np.array([x, y]) - best.fingers.mean(axis=0)
        off = away / np.hypot(*away) * (0.0 if inside else disc + 0.022 * side)
        axes.text(
            x + off[0], y + off[1], str(k + 1), fontsize=7.0, fontweight="bold",
            color=PAPER if inside else colour, ha="center", va="center_baseline", zorder=9,
            path_effects=[] if inside else [withStroke(linewidth=1.5, foreground=PAPER)],
        )  # fmt: skip
    _scale_bar(axes, view, unit, shapely.MultiPoint(best.fingers).buffer(room))


def _view(
    cage: Cage, best: BestPlacement, regions: list[shapely.MultiPolygon], room: float
) -> tuple[float, float, float, float]:
    """Hand, rooms and regions with a border; the whole object where it is not much more."""
    hands = shapely.MultiPoint(np.concatenate([best.fingers, cage.contacts])).buffer(1.1 * room)
    near = shapely.total_bounds(np.array([hands, *regions], dtype=object))
    whole = shapely.total_bounds(np.array([hands, cage.outline.polygon, *regions], dtype=object))
    aspect = _SIZE[0] * _HAND[2] / (_SIZE[1] * _HAND[3])
    if _framed(whole, aspect)[1] <= 1.6 * _framed(near, aspect)[1]:
        near = whole
    middle, wide = _framed(near, aspect)
    tall = wide / aspect
    x, y = middle.tolist()
    return x - 0.5 * wide, y - 0.5 * tall, x + 0.5 * wide, y + 0.5 * tall


def _framed(bounds: FloatArray, aspect: float) -> tuple[FloatArray, float]:
    """Middle and width of the window of that aspect that holds some bounds, with a border."""
    size = bounds[2:] - bounds[:2]
    return 0.5 * (bounds[:2] + bounds[2:]), 1.06 * float(max(size[0], aspect * size[1]))


def _scale_bar(
    axes: Axes,
    view: tuple[float, float, float, float],
    unit: str,
    keep_off: shapely.Polygon | shapely.MultiPolygon,
) -> None:
    """A length to compare with, in the lower left corner or in one with more room."""
    side = view[2] - view[0]
    length = scale_bar_length(0.2 * side)
    tall = 0.06 * side
    corners = [
        (x, y)
        for y in (view[1] + 0.03 * side, view[3] - tall)
        for x in (view[0] + 0.03 * side, view[2] - 0.03 * side - length)
    ]
    x, y = min(
        corners,
        key=lambda at: (
            keep_off.intersection(
                shapely.box(at[0], at[1] - 0.01 * side, at[0] + length, at[1] + tall)
            ).area
        ),
    )
    white = [withStroke(linewidth=3.0, foreground=PAPER)]
    axes.plot([x, x + length], [y, y], color=INK, lw=1.4, zorder=10, path_effects=white)
    axes.text(
        x + 0.5 * length, y + 0.012 * side, f"{length:g} {unit}".strip(), fontsize=7.0, ha="center",
        va="bottom", color=INK, zorder=10, path_effects=white,
    )  # fmt: skip


def _draw_curve(axes: Axes, best: BestPlacement, unit: str) -> None:
    """Turn and shift that are borne together, and what the fingers' tolerance says of them."""
    bears = best.turn_and_shift
    curve = bears.curve(_POINTS)
    turns, shifts = np.degrees(curve[:, 0]), curve[:, 1]
    axes.fill_between(turns, 0.0, shifts, color=tint(FINGERS[0], 0.18), lw=0.0, zorder=1)
    axes.plot(
        turns, shifts, color=FINGERS[0], lw=1.4, zorder=3, clip_on=False,
        label="borne by the rigid hand",
    )  # fmt: skip
    promised = np.array([bears.within_tolerance(best.tolerance, t) for t in curve[:, 0].tolist()])
    shown = promised > 0.0
    last = int(shown.sum())
    axes.plot(
        turns[: last + 1], promised[: last + 1], color=INK, lw=0.9, ls=(0, (4, 2)), zorder=4,
        label="any errors of the fingers up to $r$",
    )  # fmt: skip
    axes.set_xlim(0.0, 1.04 * degrees(bears.turn))
    axes.set_ylim(0.0, 1.42 * bears.shift)
    axes.set_xlabel("turn either way [deg]", color=INK)
    axes.set_ylabel("shift in any direction" + (f" [{unit}]" if unit else ""), color=INK)
    axes.ticklabel_format(useOffset=False)
    axes.tick_params(colors=INK, width=0.6, length=3.0)
    for name, spine in axes.spines.items():
        spine.set_color(QUIET_INK)
        spine.set_linewidth(0.6)
        spine.set_visible(name in ("left", "bottom"))
    axes.grid(color=RULE, lw=0.4, zorder=0)
    axes.set_axisbelow(True)
    axes.legend(
        loc="upper right", frameon=False, fontsize=7.5, labelcolor=INK, handlelength=1.8,
        borderaxespad=0.0,
    )  # fmt: skip
