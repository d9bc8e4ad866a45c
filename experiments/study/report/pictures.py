"""Pages in points (1/72 inch) for a study's pictures: axes, text, and the file, the same bytes."""

from __future__ import annotations

from typing import Any, Final, Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from experiments.figures.drawing.palette import INK, QUIET_INK, RULE
from experiments.io.one_line import in_figure

WIDE: Final = 504.0
"""[pt] A page as wide as both columns of a journal."""

MARGIN: Final = 14.0
"""[pt]"""

ROW: Final = 13.0
"""[pt] From one line of text to the next."""


class Page:
    """A figure of so many points, y up; drawn on with axes and text placed in points."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self.figure = Figure(figsize=(width / 72.0, height / 72.0), facecolor="white")
        FigureCanvasAgg(self.figure)

    def axes(self, x: float, y: float, width: float, height: float, **given: Any) -> Axes:
        """Axes whose lower left corner is (x, y)."""
        box = (x / self.width, y / self.height, width / self.width, height / self.height)
        return self.figure.add_axes(box, **given)

    def text(self, x: float, y: float, words: str, size: float = 8.5, **given: Any) -> float:
        """A line of text on the baseline y, starting at x; its width, [pt]."""
        style: dict[str, Any] = {"color": INK, "va": "baseline", **given}
        text = self.figure.text(x / self.width, y / self.height, words, fontsize=size, **style)
        return float(text.get_window_extent().width * 72.0 / self.figure.dpi)

    def caption(self, y: float, title: str, lines: list[str]) -> None:
        """A bold title on the baseline y, which may be any name; quiet lines below it."""
        self.text(MARGIN, y, in_figure(title), 10.0, fontweight="bold")
        for k, line in enumerate(lines, 1):
            self.text(MARGIN, y - ROW * k, line, 8.5, color=QUIET_INK)


def plain(axes: Axes, values: Literal["x", "y", "both"] = "y") -> None:
    """Thin lines, small numbers, no box, a grid along the axis of the values."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set(color=INK, linewidth=0.6)
    axes.tick_params(width=0.6, length=2.5, labelsize=7, colors=INK)
    axes.grid(axis=values, color=RULE, lw=0.4)
    axes.set_axisbelow(True)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(_tick))


def _tick(value: float, place: int | None) -> str:
    """A number below an axis, never "-0"."""
    return f"{value + 0.0:.6g}"
