"""The plan: the hand opens along the way out, past the levels, until nothing holds the object."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.object_view import ObjectView
from experiments.figures.drawing.palette import BAD, INK
from experiments.replay.film_page import (
    MAIN,
    SHADES,
    draw_badge,
    draw_headline,
    sigma_plot,
)
from experiments.video.scene_page import (
    draw_curve,
    draw_still,
    draw_table,
    level_rows,
    still_ends,
)
from experiments.video.subject import Subject
from icage.arrays import FloatArray
from sim.attack.guided import object_path

_AT_LEVEL = 1e-6
"""[1] A level counts as reached this near below it: the puncture is on it but for rounding."""


def plan_scene(subject: Subject, canvas: Canvas) -> Iterator[None]:
    """A frame of the film on the canvas at every step."""
    cage = subject.cage
    way = way_out(subject)
    share = still_ends(subject.frames)
    places = way[np.round(share * (len(way) - 1)).astype(np.int64)]
    view = ObjectView(cage, subject.regions, way[:: max(len(way) // 20, 1)], main_box())
    plot = sigma_plot(cage, way[:, 3])
    about = f"the plan's way out, {subject.about_fingers}"
    draw_still(canvas, subject, about, [plot], SHADES)
    draw_table(canvas, "levels of the opening", level_rows(subject))
    view.draw_still(canvas)
    view.draw_goal(canvas, cage.target_placement.as_array())
    still = canvas.pixels.copy()
    for k, place in enumerate(places):
        canvas.pixels[:] = still
        view.draw_ways(canvas, places[: k + 1], 0.6)
        view.draw_hand(canvas, place)
        draw_curve(canvas, plot, share, places[:, 3], k)
        free = share[k] >= 1.0 and cage.sigma_max is not None
        draw_headline(canvas, *_sentence(subject, float(places[: k + 1, 3].max()), free))
        if free:
            draw_badge(canvas, "nothing holds the object", False)
        yield


def main_box() -> tuple[float, float, float, float]:
    """The main view with a margin."""
    return (16.0, 16.0, MAIN[0] - 16.0, MAIN[1] - 10.0)


def way_out(subject: Subject) -> FloatArray:
    """Placements (n, 4) close together, from the target to where the object is free.

    Of an object that never escapes: the target alone.
    """
    cage, scene = subject.cage, subject.scene
    path, free = cage.escape_path, cage.escape_free_at
    if path is None or free is None:
        return np.repeat(cage.target_placement.as_array()[None], 2, axis=0)
    way = object_path(scene, path[: max(free, 1) + 1])
    qpos = np.column_stack([way[:, 3:4] * scene.kinematics.lengths, way[:, :3]])
    even = np.linspace(0.0, way[-1, 4], max(len(way), 2))
    placements = scene.placements(qpos)
    return np.column_stack([np.interp(even, way[:, 4], column) for column in placements.T])


def _sentence(
    subject: Subject, widest: float, free: bool
) -> tuple[str, tuple[float, float, float]]:
    """What the widest opening so far means."""
    cage = subject.cage
    if cage.sigma_max is None:
        return "the object cannot leave this hand at any opening", INK
    if free:
        return "past the puncture the object is free: it was opened to sigma_max", BAD
    if widest >= (1.0 - _AT_LEVEL) * cage.sigma_max:
        return "opened to sigma_max: the cage breaks, the way out is open", BAD
    if cage.wedge is not None and widest >= (1.0 - _AT_LEVEL) * cage.wedge.sigma:
        return "still caged, but closing ends in the target by an exact fit only", INK
    if cage.sigma_first is not None and widest >= (1.0 - _AT_LEVEL) * cage.sigma_first:
        return "above sigma_first: still caged, but closing may end in another grasp", INK
    return "below sigma_first: closing can end only in the target grasp", INK
