"""Placements of the guaranteed set, one after another: from each, closing ends in the target."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.object_view import ObjectView
from experiments.figures.drawing.palette import INK, QUIET_INK
from experiments.figures.drawing.plots import Plot
from experiments.replay.film_page import SHADES, UPPER, draw_headline, sigma_plot
from experiments.video.plan_scene import main_box
from experiments.video.scene_page import draw_still, draw_table, level_rows, still_ends
from experiments.video.subject import Subject
from icage.sampling import draw_starts

MOST = 300
"""Placements in the end; their number grows faster and faster."""

_DOT = 3.2
"""[pixel] Of a finger that has been there."""


def placements_scene(subject: Subject, canvas: Canvas) -> Iterator[None]:
    """A frame of the film on the canvas at every step.

    Raises
    ------
    SamplingError:
        The guaranteed set is too small to be drawn from.
    """
    cage = subject.cage
    rng = np.random.default_rng([subject.seed, 0, 0])  # those that a replay closes from first
    starts = draw_starts(cage, "guaranteed", MOST, rng).placements
    view = ObjectView(cage, subject.regions, starts, main_box())
    levels = sigma_plot(cage, starts[:, 3])
    plot = Plot(UPPER, r"opening $\sigma$ of each placement", 1.0, levels.y_range, levels.levels)
    about = f"random placements of the open hand, {subject.about_fingers}"
    draw_still(canvas, subject, about, [plot], SHADES)
    draw_table(canvas, "levels of the opening", level_rows(subject))
    view.draw_still(canvas)
    view.draw_goal(canvas, cage.target_placement.as_array())
    at = plot.at(np.linspace(0.0, 1.0, MOST), starts[:, 3])
    shown = 0
    share = still_ends(subject.frames, 0.02, 0.2)
    for part in share:
        count = 1 + round(float(part) ** 2 * (MOST - 1))
        view.draw_marks(canvas, starts[shown:count], _DOT)
        for point in at[shown:count]:
            canvas.disc(point, 2.0, INK)
        shown = count
        kept = canvas.pixels.copy()
        view.draw_hand(canvas, starts[count - 1])
        draw_headline(canvas, "from each of these, closing can end only in the target grasp")
        canvas.text(820.0, 46.0, f"{count} of {MOST}", 19.0, QUIET_INK, anchor="right")
        yield
        canvas.pixels[:] = kept
