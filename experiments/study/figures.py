"""What a study found, drawn: the rate over every input, and which input matters.

``draw_map``, where the hand may stand, is in ``experiments.study.map``.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, MaxNLocator

from experiments.drawing.palette import FINGERS, INK, QUIET_INK, RULE, tint
from experiments.study.map import draw_map
from experiments.study.pictures import MARGIN, ROW, WIDE, Page, check_suffix, settings, write
from experiments.study.shown import WORDS, display, merged, percent, variable
from icage.errors import InputError

__all__ = ["draw_indices", "draw_map", "draw_rates"]

_COLUMNS: Final = 4
_MOST_BINS: Final = 50
"""Of a panel; a finer grid is drawn in groups."""

_PANEL: Final = (100.0, 84.0)
"""[pt] Inside its axes."""

_LEFT, _GAP, _BELOW, _ABOVE = 44.0, 14.0, 44.0, 16.0
"""[pt] Left of the first panel (rates); between panels; below one (name, unit); above one."""

_RATE, _TOTAL = FINGERS[0], FINGERS[1]


def draw_rates(document: Mapping[str, Any], path: Path) -> None:
    """Draw the rate of the target over each varying input, a panel each, into an SVG or PNG file.

    Every bin is drawn from its least to its largest value, with its Wilson 95 % interval; the
    rate stands over the mean value.

    Raises
    ------
    InputError:
        The suffix is neither .svg nor .png, or nothing varies.
    """
    check_suffix(path)
    found = document["found"]
    if not found["variables"]:
        raise InputError("no input varies in this study: there is nothing to draw rates over")
    shown = {name: merged(one["bins"], _MOST_BINS) for name, one in found["variables"].items()}
    floor = _floor([one for bins in shown.values() for one in bins])
    with settings():
        write(_rates_page(document, shown, floor).figure, path)


def _rates_page(
    document: Mapping[str, Any], shown: Mapping[str, Sequence[Mapping[str, Any]]], floor: float
) -> Page:
    columns = min(_COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    lines = _rates_caption(document["found"], floor)
    strip = MARGIN + ROW * (len(lines) + 1) + 4.0
    wide = (WIDE - _LEFT - MARGIN - (_COLUMNS - 1) * _GAP) / _COLUMNS
    wide = min(wide * _COLUMNS / columns, 2.0 * wide)
    tall = _PANEL[1] if columns > 2 else 1.4 * _PANEL[1]
    page = Page(WIDE, strip + rows * (tall + _BELOW + _ABOVE))
    for k, (name, bins) in enumerate(shown.items()):
        row, column = divmod(k, columns)
        x = _LEFT + column * (wide + _GAP)
        y = page.height - (row + 1) * (tall + _ABOVE) - row * _BELOW
        axes = page.axes(x, y, wide, tall)
        _rate_panel(axes, bins, name, document["unit"], document["found"]["target_rate"], floor)
        page.text(x, y + tall + 4.0, _sizes(bins, document, name), 6.5, color=QUIET_INK)
        if column:
            axes.tick_params(labelleft=False)
        else:
            axes.set_ylabel("rate of the target", fontsize=8, color=INK)
        label = textwrap.wrap(_label(name, document["unit"]), max(20, int(wide / 4.2)))
        for line, words in enumerate(label[:2]):
            page.text(x + 0.5 * wide, y - 24.0 - 9.0 * line, words, 7.5, ha="center")
    page.caption(MARGIN + ROW * len(lines), str(document["name"]), lines)
    return page


def _rates_caption(found: Mapping[str, Any], floor: float) -> list[str]:
    rate, (low, high) = found["target_rate"], found["target_rate_95"]
    lines = [
        f"{found['trials']:,} trials, {found['outcomes']['target']:,} ended in the target: "
        f"{percent(rate)} (95 %: {percent(low)} to {percent(high)}), the dashed line.",
        "Each box: the values in a bin, and the Wilson 95 % interval of its rate (the bar or dot).",
    ]
    if floor > 0.0:
        lines.append(f"The axes of the rate do not start at 0, but at {floor:g}.")
    return lines


def _rate_panel(
    axes: Axes, bins: Sequence[Mapping[str, Any]], name: str, unit: str, overall: float,
    floor: float,
) -> None:  # fmt: skip
    factor, _ = display(variable(name), unit)
    lows, highs = ([one[key] * factor for one in bins] for key in ("low", "high"))
    span = max(highs) - min(lows) or 1.0
    axes.axhline(overall, color=QUIET_INK, lw=0.7, ls=(0, (4.0, 3.0)), zorder=1)
    for one, a, b in zip(bins, lows, highs, strict=True):
        rate, mean = one["target"] / one["trials"], one["mean"] * factor
        least, most = one["rate_95"]
        if b - a > 0.01 * span:
            axes.add_patch(
                Rectangle((a, least), b - a, most - least, fc=tint(_RATE, 0.3), lw=0.0, zorder=2)
            )
            axes.plot([a, b], [rate, rate], color=_RATE, lw=1.2, solid_capstyle="butt", zorder=3)
        else:
            axes.plot([mean, mean], [least, most], color=_RATE, lw=1.0, zorder=2)
            axes.plot([mean], [rate], "o", color=_RATE, ms=3.0, mew=0.0, zorder=3)
    axes.set_xlim(min(lows) - 0.04 * span, max(highs) + 0.04 * span)
    axes.set_ylim(floor, 1.0 + 0.02 * (1.0 - floor))
    plain(axes)
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))


def plain(axes: Axes) -> None:
    """Thin lines, small numbers, no box."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set(color=INK, linewidth=0.6)
    axes.tick_params(width=0.6, length=2.5, labelsize=7, colors=INK)
    axes.grid(axis="y", color=RULE, lw=0.4)
    axes.set_axisbelow(True)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value + 0.0:.6g}"))


def _label(name: str, unit: str) -> str:
    shown = display(variable(name), unit)[1]
    return f"{WORDS[name]} [{shown}]" if shown else WORDS[name]


def _sizes(bins: Sequence[Mapping[str, Any]], document: Mapping[str, Any], name: str) -> str:
    """How many bins of how many trials."""
    counts = sorted({one["trials"] for one in bins})
    size = f"{counts[0]:,}" if len(counts) == 1 else f"{counts[0]:,} to {counts[-1]:,}"
    exact = len(bins) == len(document["found"]["variables"][name]["bins"])
    grid = exact and document["config"]["vary"][name]["kind"] == "grid"
    return f"{len(bins)} {'values' if grid else 'bins'}, {size} trials each"


def _floor(bins: Sequence[Mapping[str, Any]]) -> float:
    """Where the axis of the rate starts: 0, or higher if all rates are above 0.9."""
    if min(one["target"] / one["trials"] for one in bins) <= 0.9:
        return 0.0
    return max(0.0, math.floor(20.0 * min(one["rate_95"][0] for one in bins) - 0.2) / 20.0)


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
    left, strip = 150.0, MARGIN + ROW * (len(lines) + 1) + 30.0
    tall = 24.0 * len(groups) + 6.0
    page = Page(WIDE, strip + tall + 26.0)
    axes = page.axes(left, strip, WIDE - left - 2.0 * MARGIN, tall)
    for at, group in enumerate(groups):
        _index_bar(axes, at + 0.18, group, "total", _TOTAL)
        _index_bar(axes, at - 0.18, group, "first", _RATE)
    least = min(0.0, *(min(g["first_low"], g["total_low"]) for g in groups))
    most = max(1.0, *(max(g["first_high"], g["total_high"]) for g in groups))
    axes.axvline(0.0, color=INK, lw=0.6)
    axes.set_xlim(least - 0.01, most + 0.01)
    axes.set_ylim(-0.6, len(groups) - 0.4)
    plain(axes)
    axes.grid(False)
    axes.grid(axis="x", color=RULE, lw=0.4)
    axes.set_yticks(range(len(groups)), [WORDS.get(g["name"], g["name"]) for g in groups])
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0, labelsize=8)
    handles = [Rectangle((0, 0), 1, 1, fc=tint(c, 0.55), lw=0) for c in (_TOTAL, _RATE)]
    page.figure.legend(
        handles, ["total index", "first-order index"], loc="upper left", ncols=2, frameon=False,
        fontsize=8, bbox_to_anchor=(left / page.width, 1.0), borderaxespad=0.3, handlelength=1.4,
    )  # fmt: skip
    page.caption(MARGIN + ROW * len(lines), str(document["name"]), lines)
    return page


def _index_bar(axes: Axes, at: float, group: Mapping[str, Any], kind: str, colour: Any) -> None:
    axes.barh(at, group[kind], height=0.34, color=tint(colour, 0.55), lw=0.0, zorder=2)
    ends = (group[f"{kind}_low"], group[f"{kind}_high"])
    axes.add_line(Line2D(ends, (at, at), color=colour, lw=1.2, zorder=3))
