"""The page of a film round its main view: title, plots, the object's view, caption."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.caption import level_digits
from experiments.figures.drawing.numbers import significant
from experiments.figures.drawing.object_view import ObjectView
from experiments.figures.drawing.palette import (
    BAD,
    FINGERS,
    GOOD,
    INK,
    PAPER,
    QUIET_INK,
    RULE,
    Colour,
)
from experiments.figures.drawing.plots import Box, Curve, Level, Plot
from experiments.io.one_line import printable
from experiments.replay.what_is_filmed import Filmed
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.regions import FingerRegion

if TYPE_CHECKING:
    from experiments.replay.clips import Clip

WIDTH, HEIGHT = 1280, 720

MAIN: Final = (840, 632)
"""Width and height of the main view, in the top left corner."""

LEFT, RIGHT = 880.0, 1262.0
"""Edges of the right column."""

UPPER: Final[Box] = (LEFT, 134.0, 1196.0, 258.0)
LOWER: Final[Box] = (LEFT, 306.0, 1196.0, 402.0)
BOTTOM: Final[Box] = (LEFT, 450.0, RIGHT, 628.0)
"""Places of its two plots, and of what is below them."""

SHADES: Final = "shaded: where each finger's centre may be in the cage;   orange: the target grasp"

_LONGEST_NAME = 40
"""Characters of a name in the title."""

_TITLE_WIDTH = 560.0
"""[pixel] of font size times characters: what fits the right column."""


_ABOUT_WIDTH = 660.0
"""[pixel] The same of the line below it, which is not bold."""


class Page:
    """The page for the clips of one run."""

    def __init__(self, name: str, clips: Sequence[Clip], regions: Sequence[FingerRegion]) -> None:
        self._name, self._clips = name, clips
        cage = clips[0].filmed.cage
        self._object = ObjectView(
            cage, regions, np.array([clip.placements[0] for clip in clips]), BOTTOM
        )
        self._plots = [_sigma_plot(cage, clip) for clip in clips]
        self._forces = [_force_plot(clip) for clip in clips]

    def draw_still(self, canvas: Canvas, number: int) -> None:
        """What does not change during clip ``number``: everything, on a fresh page."""
        clip = self._clips[number]
        draw_title(canvas, clip.filmed.grasp, clip.filmed.about)
        self._plots[number].draw_frame(canvas)
        self._forces[number].draw_frame(canvas)
        canvas.text(LEFT, BOTTOM[1] - 9.0, "seen from the object", 15.0, INK)
        self._object.draw_still(canvas)
        for earlier in self._clips[:number]:
            self._object.draw_ways(canvas, earlier.placements, 0.45)
        draw_caption(canvas, clip.filmed.cage, SHADES)

    def draw_now(self, canvas: Canvas, number: int, frame: int) -> None:
        """What has happened up to a frame."""
        clip = self._clips[number]
        now = float(clip.time[frame])
        self._plots[number].draw_curve(canvas, Curve(clip.time, clip.placements[:, 3], INK), now)
        for k, colour in enumerate(FINGERS):
            curve = Curve(clip.time, clip.forces[:, k], colour)
            self._forces[number].draw_curve(canvas, curve, now, 1.8)
        self._object.draw_ways(canvas, clip.placements[: frame + 1], 1.0)
        self._object.draw_fingers(canvas, clip.placements[frame])
        over = now >= 1.0
        _draw_outcome(canvas, clip.filmed, over)
        if over:
            _draw_badge(canvas, clip.filmed)


def draw_title(canvas: Canvas, name: str, about: str) -> None:
    """A fresh page with the name of what is filmed, and a quiet line below it."""
    canvas.pixels[:] = 255
    canvas.line([[MAIN[0] + 1, 20], [MAIN[0] + 1, MAIN[1] - 12]], RULE, 1.2)
    title = _short(printable(name))
    canvas.text(LEFT, 42.0, title, min(24.0, _TITLE_WIDTH / len(title)), INK, bold=True)
    canvas.text(LEFT, 70.0, about, min(17.0, _ABOUT_WIDTH / len(about)), QUIET_INK)


def _sigma_plot(cage: Cage, clip: Clip) -> Plot:
    return sigma_plot(cage, clip.placements[:, 3])


def sigma_plot(cage: Cage, sigma: FloatArray) -> Plot:
    """A plot of openings (F,) with the cage's levels."""
    levels = [Level(cage.sigma_0, r"$\sigma_0$", QUIET_INK)]
    if cage.sigma_first is not None:
        same = cage.sigma_first == cage.sigma_max
        name = r"$\sigma_{\mathrm{first}},\sigma_{\mathrm{max}}$" if same else None
        levels.append(Level(cage.sigma_first, name or r"$\sigma_{\mathrm{first}}$"))
    if cage.sigma_max is not None and cage.sigma_max != cage.sigma_first:
        levels.append(Level(cage.sigma_max, r"$\sigma_{\mathrm{max}}$"))
    values = [*sigma, *(level.value for level in levels)]
    low, high = min(values), max(values)
    room = 0.08 * (high - low) or 0.01 * high
    return Plot(UPPER, r"opening $\sigma$ over time", 1.0, (low - room, high + room), levels)


def _force_plot(clip: Clip) -> Plot:
    """Impacts may leave the plot; what counts is how the hand presses in the end."""
    high = 1.25 * max(float(np.quantile(clip.forces, 0.97)), float(clip.forces[-1].max()), 1e-9)
    return Plot(LOWER, "finger forces over time", 1.0, (0.0, high))


def _draw_badge(canvas: Canvas, filmed: Filmed) -> None:
    """Where this closing ended, in the corner of the main view."""
    words = {"target": "target grasp", "other_grasp": "another grasp"}.get(
        filmed.outcome, filmed.outcome.replace("_", " ")
    )
    draw_badge(canvas, words, filmed.good)


def draw_badge(canvas: Canvas, words: str, good: bool) -> None:
    """A word in the corner of the main view, with a sign and a colour."""
    place, text = (32.0, 46.0), f"{'✓' if good else '✗'} {words}"
    wide = canvas.text(*place, text, 19.0, PAPER, bold=True)  # how wide it is
    canvas.box((20.0, 20.0, 44.0 + wide, 58.0), GOOD if good else BAD)
    canvas.text(*place, text, 19.0, PAPER, bold=True)


def _draw_outcome(canvas: Canvas, filmed: Filmed, over: bool) -> None:
    """How it ended only when it has ended."""
    told = filmed.before == filmed.after or over
    text = filmed.after if over else filmed.before
    draw_headline(canvas, text, BAD if told and not filmed.after_good else INK)


def draw_headline(canvas: Canvas, text: str, ink: Colour = INK) -> None:
    """The sentence below the pictures."""
    canvas.text(24.0, 674.0, text, 21.0, ink, bold=True)


def draw_caption(canvas: Canvas, cage: Cage, words: str) -> None:
    """The levels of the cage, and what the colours mean."""
    canvas.line([[20, MAIN[1] + 6], [WIDTH - 20, MAIN[1] + 6]], RULE, 1.2)
    levels = [
        rf"{name} = {significant(level / cage.sigma_0, level_digits(cage))} $\sigma_0$"
        for name, level in (
            (r"$\sigma_{\mathrm{first}}$", cage.sigma_first),
            (r"$\sigma_{\mathrm{max}}$", cage.sigma_max),
        )
        if level is not None
    ]
    canvas.text(24.0, 704.0, ",   ".join([*levels, words]), 16.0, QUIET_INK, math=True)


def _short(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else name[: _LONGEST_NAME - 1] + "…"
