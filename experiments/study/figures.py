"""What a study found, drawn. Here: the rate of the target over every input.

Where the hand may stand is drawn by ``experiments.study.map``, which input matters most by
``experiments.study.indices_figure``.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator, MultipleLocator

from experiments.drawing.palette import FINGERS, PAPER, QUIET_INK, tint
from experiments.study.indices_figure import draw_indices
from experiments.study.map import draw_map
from experiments.study.pictures import (
    MARGIN,
    ROW,
    WIDE,
    Page,
    check_suffix,
    plain,
    settings,
    write,
)
from experiments.study.shown import WORDS, display, merged, percent
from experiments.study.variables import VARIABLES
from icage.errors import InputError

__all__ = ["draw_indices", "draw_map", "draw_rates"]

_COLUMNS: Final = 4
_MOST_BINS: Final = 50
"""Of a panel; a finer grid is drawn in groups."""

_TALL: Final = 84.0
"""[pt] Height of a panel; more if there are few."""

_LEFT, _GAP, _BELOW, _LINE, _ABOVE = 44.0, 14.0, 34.0, 9.0, 16.0
"""[pt] Left of the first panel (rates); between panels; below one (the values, a line of words);
for every line more; above one."""

_STEPS: Final = {
    0.0: 0.25, 0.5: 0.1, 0.75: 0.05, 0.8: 0.05, 0.9: 0.02, 0.95: 0.01, 0.99: 2e-3, 0.999: 2e-4
}  # fmt: skip
"""Where the axis of the rate may start, and the steps of its numbers then."""

_RATE: Final = FINGERS[0]


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
    lines = _rates_caption(document["found"], shown, floor)
    strip = MARGIN + ROW * (len(lines) + 1)
    wide = (WIDE - _LEFT - MARGIN - (_COLUMNS - 1) * _GAP) / _COLUMNS
    wide = min(wide * _COLUMNS / columns, 2.0 * wide)
    tall = _TALL if columns > 2 else 1.4 * _TALL
    labels = [_label(name, document["unit"], wide) for name in shown]
    below = _BELOW + _LINE * (max(map(len, labels)) - 1)
    page = Page(WIDE, strip + rows * (tall + below + _ABOVE))
    for k, (name, bins) in enumerate(shown.items()):
        row, column = divmod(k, columns)
        x = _LEFT + column * (wide + _GAP)
        y = page.height - (row + 1) * (tall + _ABOVE) - row * below
        axes = page.axes(x, y, wide, tall)
        _rate_panel(axes, bins, name, document["unit"], document["found"]["target_rate"], floor)
        page.text(x, y + tall + 4.0, _sizes(bins, document, name), 6.5, color=QUIET_INK)
        if column:
            axes.tick_params(labelleft=False)
        else:
            page.text(
                _LEFT - 30.0, y + 0.5 * tall, "rate of the target", 7.5, rotation=90, va="center",
                ha="center",
            )  # fmt: skip
        for line, words in enumerate(labels[k]):
            page.text(x + 0.5 * wide, y - 24.0 - _LINE * line, words, 7.5, ha="center")
    page.caption(MARGIN + ROW * len(lines), str(document["name"]), lines)
    return page


def _label(name: str, unit: str, wide: float) -> list[str]:
    """Lines for below a panel: the input in words, and its unit."""
    shown = display(VARIABLES[name], unit)[1]
    text = f"{WORDS[name]} [{shown}]" if shown else WORDS[name]
    return textwrap.wrap(text, max(20, int(wide / 4.2)))


def _rates_caption(
    found: Mapping[str, Any], shown: Mapping[str, Sequence[Mapping[str, Any]]], floor: float
) -> list[str]:
    rate, (low, high) = found["target_rate"], found["target_rate_95"]
    lines = [
        f"{found['trials']:,} trials, {found['outcomes']['target']:,} ended in the target: "
        f"{percent(rate)} (95 %: {percent(low)} to {percent(high)}), the dashed line.",
    ]
    spread = [any(_is_wide(one, bins) for one in bins) for bins in shown.values()]
    if any(spread):
        lines.append("Line: rate over the values of a bin. Box: its 95 % interval (Wilson).")
    if not all(spread):
        lines.append("Dot: rate at one value. Upright line: its 95 % interval (Wilson).")
    if floor > 0.0:
        lines.append(f"The axes of the rate start at {floor:g}, not at 0.")
    return lines


def _is_wide(one: Mapping[str, Any], bins: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a bin is drawn as a box, not as a dot."""
    span = bins[-1]["high"] - bins[0]["low"]
    return bool(one["high"] - one["low"] > 0.005 * span)


def _rate_panel(
    axes: Axes, bins: Sequence[Mapping[str, Any]], name: str, unit: str, overall: float,
    floor: float,
) -> None:  # fmt: skip
    factor, _ = display(VARIABLES[name], unit)
    lows, highs = ([one[key] * factor for one in bins] for key in ("low", "high"))
    span = max(highs) - min(lows) or 1.0
    axes.axhline(overall, color=QUIET_INK, lw=0.7, ls=(0, (4.0, 3.0)), zorder=1)
    for one, a, b in zip(bins, lows, highs, strict=True):
        rate, mean = one["target"] / one["trials"], one["mean"] * factor
        least, most = one["rate_95"]
        if _is_wide(one, bins):
            axes.add_patch(
                Rectangle(
                    (a, least), b - a, most - least, fc=tint(_RATE, 0.3), ec=PAPER, lw=0.4, zorder=2
                )
            )
            axes.plot([a, b], [rate, rate], color=_RATE, lw=1.2, solid_capstyle="butt", zorder=4)
        else:
            axes.plot([mean, mean], [least, most], color=_RATE, lw=1.0, zorder=2)
            axes.plot([mean], [rate], "o", color=_RATE, ms=3.0, mew=0.0, zorder=3)
    axes.set_xlim(min(lows) - 0.04 * span, max(highs) + 0.04 * span)
    axes.set_ylim(floor, 1.0 + 0.02 * (1.0 - floor))
    plain(axes)
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
    axes.yaxis.set_major_locator(MultipleLocator(_STEPS[floor], offset=floor))


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
    return max(floor for floor in _STEPS if floor <= min(one["rate_95"][0] for one in bins))
