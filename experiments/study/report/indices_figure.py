"""Which input matters most: Sobol indices as bars."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from experiments.figures.drawing.palette import FINGERS, INK, Colour, tint
from experiments.figures.drawing.written import check_suffix, settings, write
from experiments.study.inputs.variables import label
from experiments.study.report.pictures import MARGIN, ROW, WIDE, Page, plain
from icage.errors import InputError

_FIRST, _TOTAL = FINGERS[0], FINGERS[1]

_LEFT: Final = 150.0
"""[pt] Room for the names."""

_GROUP: Final = 24.0
"""[pt] Height of two bars."""


def draw_indices(document: Mapping[str, Any], path: Path) -> None:
    """Draw first-order and total Sobol indices with their intervals, the largest total on top.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png, or the study has no indices.
    """
    check_suffix(path)
    found = document["found"].get("indices") or {}
    if not found.get("groups"):
        raise InputError(f"this study has no indices: {found.get('why') or 'another sampling'}")
    with settings():
        write(_indices_page(document, found).figure, path)


def _indices_page(document: Mapping[str, Any], found: Mapping[str, Any]) -> Page:
    groups = sorted(found["groups"], key=lambda g: g["total"])
    lines = [
        f'Share of the variance of "ended in the target"; {found["base"]:,} base points, '
        "lines: 95 % intervals.",
        "First order: what an input does alone. Total: together with the others as well.",
    ]
    strip = MARGIN + ROW * (len(lines) + 1) + 24.0
    tall = _GROUP * len(groups) + 6.0
    page = Page(WIDE, strip + tall + 26.0)
    axes = page.axes(_LEFT, strip, WIDE - _LEFT - 2.0 * MARGIN, tall)
    for at, group in enumerate(groups):
        _index_bar(axes, at + 0.18, group, "total", _TOTAL)
        _index_bar(axes, at - 0.18, group, "first", _FIRST)
    least = min(0.0, *(min(g["first_low"], g["total_low"]) for g in groups))
    most = max(1.0, *(max(g["first_high"], g["total_high"]) for g in groups))
    axes.axvline(0.0, color=INK, lw=0.6)
    axes.set_xlim(least - 0.01, most + 0.01)
    axes.set_ylim(-0.6, len(groups) - 0.4)
    plain(axes, "x")
    axes.set_yticks(range(len(groups)), [label(g["name"]) for g in groups])
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0, labelsize=8)
    handles = [Rectangle((0, 0), 1, 1, fc=tint(c, 0.55), lw=0) for c in (_TOTAL, _FIRST)]
    page.figure.legend(
        handles, ["total index", "first-order index"], loc="upper left", ncols=2, frameon=False,
        fontsize=8, bbox_to_anchor=(_LEFT / page.width, 1.0), borderaxespad=0.3, handlelength=1.4,
    )  # fmt: skip
    page.caption(MARGIN + ROW * len(lines), str(document["name"]), lines)
    return page


def _index_bar(axes: Axes, at: float, group: Mapping[str, Any], kind: str, colour: Colour) -> None:
    axes.barh(at, group[kind], height=0.34, color=tint(colour, 0.55), lw=0.0, zorder=2)
    ends = (group[f"{kind}_low"], group[f"{kind}_high"])
    axes.add_line(Line2D(ends, (at, at), color=colour, lw=1.2, zorder=3))
