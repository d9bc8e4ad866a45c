"""Values with intervals as rows of text and drawing, legible at any width.

Each row has a drawing of its own whose places are percentages: it stretches with the page, and the
text beside it keeps its size. What the drawing shows is there as text, too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from experiments.report.content import Bar, Chart

_TICKS: Final = 5
_MIDDLE: Final = 12.0
"""[px] Half the height of a row's drawing."""


def chart_html(chart: Chart, shown: Callable[[str], str]) -> str:
    """A figure; ``shown`` makes HTML of a text. Nothing if there is no row."""
    if not chart.bars:
        return ""
    low, high = chart.ends or _ends(chart)
    rows = "".join(_row(bar, chart, low, high, shown) for bar in chart.bars)
    left = f" {chart.left_off} more are in the table." if chart.left_off else ""
    return (
        f'<figure class="chart"><figcaption><b>{shown(chart.title)}.</b> Dot: measured; bar: 95 % '
        f"interval, or where it lies.{left}</figcaption>{rows}{_axis(chart, low, high, shown)}"
        "</figure>"
    )


def _ends(chart: Chart) -> tuple[float, float]:
    """A little more than there is to see."""
    values = [bar.low for bar in chart.bars] + [line.at for line in chart.lines]
    values += [v for bar in chart.bars for v in (bar.value, bar.high) if v is not None]
    low, high = min(values), max(values)
    room = 0.08 * (high - low) or 0.05 * abs(high) or 1.0
    return low - room, high + room


def _at(value: float, low: float, high: float) -> str:
    share = (value - low) / (high - low)
    return f"{100.0 * min(max(share, 0.0), 1.0):.3f}%"


def _row(bar: Bar, chart: Chart, low: float, high: float, shown: Callable[[str], str]) -> str:
    end = high if bar.high is None else bar.high
    left, right = _at(bar.low, low, high), _at(end, low, high)
    marks = "".join(
        f'<line class="level" x1="{(x := _at(line.at, low, high))}" x2="{x}" y1="0" y2="24"/>'
        for line in chart.lines
    )
    drawn = f'<line class="span" x1="{left}" x2="{right}" y1="{_MIDDLE}" y2="{_MIDDLE}"/>'
    for end in (left, right):
        drawn += f'<line class="end" x1="{end}" x2="{end}" y1="7" y2="17"/>'
    if bar.value is not None:
        drawn += f'<circle class="dot" cx="{_at(bar.value, low, high)}" cy="{_MIDDLE}" r="5"/>'
    return (
        f'<div class="bar"><span class="name"><bdi>{shown(bar.name)}</bdi></span>'
        f'<svg height="24" aria-hidden="true"><line class="base" x1="0" x2="100%" y1="{_MIDDLE}" '
        f'y2="{_MIDDLE}"/>{marks}{drawn}</svg><span class="value">{shown(bar.words)}</span></div>'
    )


def _axis(chart: Chart, low: float, high: float, shown: Callable[[str], str]) -> str:
    """Numbers below the rows, and the names of the lines below these."""
    texts: list[str] = []
    for k in range(_TICKS):
        value = low + (high - low) * k / (_TICKS - 1)
        place = ("start", "middle", "end")[(k > 0) + (k == _TICKS - 1)]
        texts.append(_text(_at(value, low, high), 14, place, f"{value:.4g}", shown))
    for line in chart.lines:
        share = (line.at - low) / (high - low)
        place = "start" if share < 0.25 else "end" if share > 0.75 else "middle"
        texts.append(_text(_at(line.at, low, high), 32, place, line.name, shown))
    tall = 38 if chart.lines else 20
    return (
        f'<div class="bar axis"><span class="name"></span>'
        f'<svg height="{tall}" aria-hidden="true">{"".join(texts)}</svg>'
        f'<span class="value">{shown(chart.unit)}</span></div>'
    )


def _text(x: str, y: int, place: str, words: str, shown: Callable[[str], str]) -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{place}">{shown(words)}</text>'
