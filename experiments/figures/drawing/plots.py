"""A plot that grows with a film: a frame drawn once, then curves up to the present moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.palette import INK, QUIET_INK, RULE, Colour

Box = tuple[float, float, float, float]
"""left, top, right, bottom, [pixel]."""


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line with its name at the right end."""

    value: float
    name: str
    colour: Colour = INK
    dash: tuple[float, ...] | None = (5.0, 3.0)


@dataclass(frozen=True, slots=True)
class Curve:
    """y over x in one colour."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    colour: Colour


@dataclass(frozen=True, slots=True)
class Plot:
    """A titled plot in a box of pixels; x from 0 to ``x_end``, y between two values."""

    box: Box
    title: str
    x_end: float
    y_range: tuple[float, float]
    levels: Sequence[Level] = ()

    def at(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels (n, 2)."""
        left, top, right, bottom = self.box
        low, high = self.y_range
        across = left + (right - left) * np.asarray(x) / self.x_end
        up = bottom - (bottom - top) * (np.asarray(y) - low) / (high - low)
        return np.column_stack([across, np.clip(up, top, bottom)])

    def draw_frame(self, canvas: Canvas) -> None:
        """Title, axes and levels; names of levels that would overlap are pushed apart."""
        left, top, right, bottom = self.box
        canvas.text(left, top - 9.0, self.title, 15.0, INK, math="$" in self.title)
        canvas.line([[left, top], [left, bottom], [right, bottom]], QUIET_INK, 1.2)
        values = np.array([level.value for level in self.levels])
        heights = self.at(np.zeros(len(values)), values)[:, 1].tolist()
        for level, y, at in zip(self.levels, heights, _apart(heights, 17.0), strict=True):
            canvas.line([[left, y], [right, y]], level.colour, 1.0, level.dash, alpha=0.75)
            canvas.text(right + 6.0, at + 4.5, level.name, 14.0, level.colour, math=True)

    def draw_curve(self, canvas: Canvas, curve: Curve, now: float, width: float = 2.2) -> None:
        """The curve up to x = now, a dot at its end."""
        seen = int(np.searchsorted(curve.x, now, "right"))
        x = np.append(curve.x[:seen], now)
        y = np.append(curve.y[:seen], np.interp(now, curve.x, curve.y))
        points = self.at(x, y)
        canvas.line(points, curve.colour, width)
        canvas.disc(points[-1], 1.6 * width, curve.colour, (1.0, 1.0, 1.0), 1.0)

    def draw_baseline(self, canvas: Canvas) -> None:
        """A thin line at y = 0 where it is inside the plot."""
        if self.y_range[0] < 0.0 < self.y_range[1]:
            ends = self.at(np.array([0.0, self.x_end]), np.zeros(2))
            canvas.line(ends, RULE, 1.0)


def _apart(heights: Sequence[float], gap: float) -> list[float]:
    """Heights moved as little as it takes to be ``gap`` from each other, order kept."""
    order = np.argsort(heights, kind="stable")
    moved = np.array(heights, dtype=np.float64)[order]
    for _ in range(len(moved)):
        for k in range(len(moved) - 1):
            short = gap - (moved[k + 1] - moved[k])
            if short > 0.0:
                moved[k] -= 0.5 * short
                moved[k + 1] += 0.5 * short
    result = np.empty_like(moved)
    result[order] = moved
    return result.tolist()
