"""The page of a scene: the layout of a replay's film, with plots and sentences of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.palette import INK, QUIET_INK
from experiments.figures.drawing.plots import Curve, Plot
from experiments.replay.film_page import BOTTOM, LEFT, draw_caption, draw_title
from experiments.video.subject import Subject
from icage.arrays import FloatArray

_LINE = 25.0
"""[pixel] Between two lines of text."""


def draw_still(
    canvas: Canvas, subject: Subject, about: str, plots: Sequence[Plot], caption: str
) -> None:
    """A fresh page with all that does not change."""
    draw_title(canvas, subject.name, about)
    for plot in plots:
        plot.draw_frame(canvas)
    draw_caption(canvas, subject.cage, caption)


def draw_table(canvas: Canvas, title: str, rows: Sequence[tuple[str, str]]) -> None:
    """Names and values at the bottom of the right column."""
    canvas.text(LEFT, BOTTOM[1] - 9.0, title, 15.0, INK)
    for k, (name, value) in enumerate(rows):
        y = BOTTOM[1] + 22.0 + _LINE * k
        canvas.text(LEFT, y, name, 16.0, QUIET_INK, math="$" in name)
        canvas.text(LEFT + 160.0, y, value, 16.0, INK, math="$" in value)


def level_rows(subject: Subject) -> list[tuple[str, str]]:
    """The levels of the cage with their unit."""
    cage = subject.cage
    levels = (
        (r"$\sigma_0$", cage.sigma_0),
        (r"$\sigma_{\mathrm{first}}$", cage.sigma_first),
        (r"$\sigma_{\mathrm{max}}$", cage.sigma_max),
    )
    return [
        (name, "never" if level is None else f"{level:.5g} {subject.unit}")
        for name, level in levels
    ]


def still_ends(frames: int, before: float = 0.08, after: float = 0.16) -> FloatArray:
    """(frames,) shares of a motion from 0 to 1 that rests a while before it and after it."""
    wait, hold = round(before * frames), round(after * frames)
    moving = np.linspace(0.0, 1.0, max(frames - wait - hold, 1))
    return np.concatenate([np.zeros(wait), moving, np.ones(frames - wait - len(moving))])


def draw_curve(canvas: Canvas, plot: Plot, time: FloatArray, values: FloatArray, k: int) -> None:
    """A plot's only curve up to frame ``k``; the time before and after a motion is not drawn."""
    plot.draw_curve(canvas, Curve(time, values, INK), float(time[k]))
