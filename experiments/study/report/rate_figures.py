"""What a study found, drawn. Here: which share of closings ends in the target, over every input.

Where the hand may stand is drawn by ``experiments.study.report.map``, which input matters most by
``experiments.study.report.indices_figure``.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator, MultipleLocator

from experiments.figures.drawing.palette import FINGERS, PAPER, QUIET_INK, tint
from experiments.figures.drawing.written import check_suffix, settings, write
from experiments.io.outcome_words import NOT_CLOSED
from experiments.study.inputs.variables import VARIABLES, label
from experiments.study.report.indices_figure import draw_indices
from experiments.study.report.map import draw_map
from experiments.study.report.names import display, merged, percent
from experiments.study.report.pictures import MARGIN, ROW, WIDE, Page, plain
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

_KEY_ROW: Final = 23.0
"""[pt] The line of keys."""

_STEPS: Final = {
    0.0: 0.25, 0.5: 0.1, 0.75: 0.05, 0.8: 0.05, 0.9: 0.02, 0.95: 0.01, 0.99: 2e-3, 0.999: 2e-4
}  # fmt: skip
"""Where the axis of the rate may start, and the steps of its numbers then."""

_RATE, _SHUT = FINGERS[0], tint(QUIET_INK, 0.16)
"""Colours of the closings that reached the target, and of the trials that were closed at all."""


def draw_rates(document: Mapping[str, Any], path: Path) -> None:
    """Draw which share of the closings reached the target over each varying input, a panel each,
    into an SVG or PNG file.

    Every bin is drawn from its least to its largest value, with its Wilson 95 % interval; the
    rate stands over the mean value. Where trials were not closed, their share is drawn behind:
    a start with a finger inside the object is no failure of the grasp.

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
    keys = _rates_keys(shown, document["found"])
    strip = MARGIN + ROW * (len(lines) + 1)
    wide = (WIDE - _LEFT - MARGIN - (columns - 1) * _GAP) / columns
    tall = _TALL if columns > 2 else 1.4 * _TALL
    labels = [_label(name, document["unit"], wide) for name in shown]
    below = _BELOW + _LINE * (max(map(len, labels)) - 1)
    page = Page(WIDE, strip + _KEY_ROW + rows * (tall + below + _ABOVE))
    for k, (name, bins) in enumerate(shown.items()):
        row, column = divmod(k, columns)
        x = _LEFT + column * (wide + _GAP)
        y = page.height - (row + 1) * (tall + _ABOVE) - row * below
        axes = page.axes(x, y, wide, tall)
        _rate_panel(axes, bins, name, document, floor)
        page.text(x, y + tall + 4.0, _sizes(bins, document, name), 6.5, color=QUIET_INK)
        if column:
            axes.tick_params(labelleft=False)
        else:
            page.text(
                _LEFT - 30.0, y + 0.5 * tall, "share", 7.5, rotation=90, va="center", ha="center"
            )
        for line, words in enumerate(labels[k]):
            page.text(x + 0.5 * wide, y - 24.0 - _LINE * line, words, 7.5, ha="center")
    _draw_keys(page, strip + 8.0, keys)
    page.caption(MARGIN + ROW * len(lines), str(document["name"]), lines)
    return page


def _label(name: str, unit: str, wide: float) -> list[str]:
    """Lines for below a panel: the input in words, and its unit."""
    shown = display(VARIABLES[name], unit)[1]
    text = f"{label(name)} [{shown}]" if shown else label(name)
    return textwrap.wrap(text, max(20, int(wide / 4.2)))


def _rates_caption(
    found: Mapping[str, Any], shown: Mapping[str, Sequence[Mapping[str, Any]]], floor: float
) -> list[str]:
    one = found["independent"]
    kind = "independent trials" if one["trials"] < found["trials"] else "trials"
    if not one["closed"]:
        return [f"None of {one['trials']:,} {kind} was closed: there is no rate to show."]
    low, high = found["target_rate_of_closed_95"]
    lines = [
        f"{one['target']:,} of {one['closed']:,} closings ended in the target: "
        f"{percent(one['target'] / one['closed'])} (95 %: {percent(low)} to {percent(high)}), "
        "the dashed line.",
    ]
    if one["closed"] < one["trials"]:
        left = one["trials"] - one["closed"]
        why = " or ".join(words for name, words in NOT_CLOSED.items() if found["outcomes"][name])
        text = (
            f"{left:,} of {one['trials']:,} {kind} were not closed ({why}) and say nothing of the "
            "grasp: they count in the grey alone."
        )
        lines += textwrap.wrap(text, 102)
    elif kind != "trials":
        lines.append(f"Of {found['trials']:,} trials the {one['trials']:,} independent ones count.")
    if floor > 0.0:
        lines.append(f"The axes start at {floor:g}, not at 0.")
    return lines


def _rates_keys(
    shown: Mapping[str, Sequence[Mapping[str, Any]]], found: Mapping[str, Any]
) -> list[tuple[str, str]]:
    """What is drawn, and what it means."""
    keys: list[tuple[str, str]] = []
    wide = {_is_wide(one, bins) for bins in shown.values() for one in bins if one["closed"]}
    what = "share of the closings that end in the target, 95 % interval (Wilson)"
    keys += [(key, what) for key, is_wide in (("box", True), ("dot", False)) if is_wide in wide]
    if len(keys) == 2:
        keys = [("box dot", what)]
    if any(one["closed"] < one["trials"] for bins in shown.values() for one in bins):
        keys.append(("shut", "share of the trials that were closed"))
    return keys


def _draw_keys(page: Page, y: float, keys: Sequence[tuple[str, str]]) -> None:
    """One line of keys on the baseline y."""
    axes = page.axes(0.0, 0.0, page.width, page.height, facecolor="none", zorder=-1)
    axes.set_axis_off()
    axes.set_xlim(0.0, page.width)
    axes.set_ylim(0.0, page.height)
    x = _LEFT
    for key, text in keys:
        for kind in key.split():
            if kind == "box":
                axes.add_patch(Rectangle((x, y - 1.5), 16.0, 8.0, fc=tint(_RATE, 0.3), lw=0.0))
                axes.plot([x, x + 16.0], [y + 2.5] * 2, color=_RATE, lw=1.2)
            elif kind == "dot":
                axes.plot([x + 4.0] * 2, [y - 1.5, y + 6.5], color=_RATE, lw=1.0)
                axes.plot([x + 4.0], [y + 2.5], "o", color=_RATE, ms=3.0, mew=0.0)
            else:
                axes.add_patch(Rectangle((x, y - 1.5), 16.0, 8.0, fc=_SHUT, lw=0.0))
            x += 12.0 if kind == "dot" else 21.0
        x += 1.04 * page.text(x, y, text, 7.5) + 14.0


def _is_wide(one: Mapping[str, Any], bins: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a bin is drawn as a box, not as a dot."""
    span = bins[-1]["high"] - bins[0]["low"]
    return bool(one["high"] - one["low"] > 0.005 * span)


def _rate_panel(
    axes: Axes, bins: Sequence[Mapping[str, Any]], name: str, document: Mapping[str, Any],
    floor: float,
) -> None:  # fmt: skip
    factor, _ = display(VARIABLES[name], document["unit"])
    lows, highs = ([one[key] * factor for one in bins] for key in ("low", "high"))
    span = max(highs) - min(lows) or 1.0
    overall = document["found"]["independent"]
    if overall["closed"]:
        rate = overall["target"] / overall["closed"]
        axes.axhline(rate, color=QUIET_INK, lw=0.7, ls=(0, (4.0, 3.0)), zorder=1)
    grey = any(one["closed"] < one["trials"] for one in bins)
    for one, a, b in zip(bins, lows, highs, strict=True):
        mean, box = one["mean"] * factor, _is_wide(one, bins)
        if grey:
            c, d = (a, b) if box else (mean - 0.012 * span, mean + 0.012 * span)
            high = one["closed"] / one["trials"]
            axes.add_patch(Rectangle((c, 0.0), d - c, high, fc=_SHUT, ec=PAPER, lw=0.4, zorder=0.5))
        if not one["closed"]:
            continue
        rate, (least, most) = one["target"] / one["closed"], one["rate_95"]
        if box:
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
    """Where the axis starts: 0, or higher if all shares are above 0.9."""
    closed = [one for one in bins if one["closed"]]
    shares = [one["target"] / one["closed"] for one in closed]
    shares += [one["closed"] / one["trials"] for one in bins]
    if min(shares) <= 0.9:
        return 0.0
    least = min(*shares, *(one["rate_95"][0] for one in closed))
    return max(floor for floor in _STEPS if floor <= least)
