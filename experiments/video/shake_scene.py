"""The shake: the fingers are locked where they closed to, and the object is pushed about."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.palette import BAD, INK, PURPLE, SKY
from experiments.figures.drawing.plots import Curve, Level, Plot
from experiments.replay.film_page import LEFT, LOWER, UPPER, draw_badge, draw_headline
from experiments.shake.run import ShakeError, Shaken, shake_case
from experiments.video.engine_view import engine_view
from experiments.video.nothing_to_film import NothingToFilmError
from experiments.video.scene_page import draw_still, draw_table
from experiments.video.subject import Subject
from icage.arrays import FloatArray
from sim.camera.stage import View
from sim.grip.shake import HELD_SHIFT, HELD_TURN, PUSH
from sim.grip.shake_recording import ShakeRecording, record_shake

CAPTION = "purple: the push on the object;   orange: the target grasp"

_LONGEST = 130.0
"""[pixel] Of an arrow, for the largest push."""

_NONE = 1e-9
"""[1] A push smaller than this has no arrow."""


def shake_scene(subject: Subject, canvas: Canvas) -> Iterator[None]:
    """A frame of the film on the canvas at every step.

    Raises
    ------
    NothingToFilmError:
        The hand did not close into the target.
    """
    done = _shaken(subject)
    rng = np.random.default_rng([subject.seed, 9])
    recorded = record_shake(done.scene, done.qpos, rng, subject.frames)
    time = np.linspace(0.0, 1.0, subject.frames)
    off = np.hypot(*(recorded.qpos[:, 3:5] - done.qpos[3:5]).T) / HELD_SHIFT
    most = float(np.abs(recorded.wrenches[:, :2]).max())
    pushed = Plot(UPPER, "push, in closing forces", 1.0, (-1.25 * most, 1.25 * most))
    moved = Plot(
        LOWER, "object moved, over what counts as held", 1.0, (0.0, max(1.2, 1.1 * off.max())),
        [Level(1.0, "held")],
    )  # fmt: skip
    about = f"fingers locked, pushes of {PUSH:g} of the closing force"
    draw_still(canvas, subject, about, [pushed, moved], CAPTION)
    pushed.draw_baseline(canvas)
    canvas.text(LEFT + 200.0, UPPER[1] - 9.0, "x", 15.0, SKY, bold=True)
    canvas.text(LEFT + 222.0, UPPER[1] - 9.0, "y", 15.0, PURPLE, bold=True)
    still = canvas.pixels.copy()
    with engine_view(subject, recorded.qpos, canvas.scale) as (paint, window):
        for k in range(subject.frames):
            canvas.pixels[:] = still
            paint(canvas, k)
            _draw_push(canvas, window, recorded, k, most)
            now = float(time[k])
            for row, colour in ((0, SKY), (1, PURPLE)):
                curve = Curve(time, recorded.wrenches[:, row], colour)
                pushed.draw_curve(canvas, curve, now, 1.8)
            moved.draw_curve(canvas, Curve(time, off, INK), now)
            _draw_numbers(canvas, subject, recorded, done.qpos, k)
            held = done.held
            if k == subject.frames - 1 or now > 0.94:
                words = "the closed hand holds the object" if held else "the object is NOT held"
                draw_headline(canvas, words, INK if held else BAD)
                draw_badge(canvas, "held" if held else "not held", held)
            else:
                draw_headline(canvas, _sentence(recorded, k))
            yield


def _shaken(subject: Subject) -> Shaken:
    try:
        done = shake_case(subject.physical, subject.seed)
    except ShakeError as error:
        raise NothingToFilmError(str(error)) from error
    if done.outcome != "target":
        ended = done.outcome.replace("_", " ")
        raise NothingToFilmError(f"{subject.name}: the closing ended as {ended}, not in the target")
    return done


def _sentence(recorded: ShakeRecording, k: int) -> str:
    if k >= recorded.random_from:
        return "shaken: random forces and torques, one after another"
    return "turned both ways" if recorded.wrenches[k, 2] else "pushed from every side"


def _draw_push(canvas: Canvas, window: View, recorded: ShakeRecording, k: int, most: float) -> None:
    """An arrow at the object's centroid, or an arc for a torque alone."""
    x, y = window.pixels(recorded.qpos[k, 3:5]).tolist()
    push = recorded.wrenches[k]
    size = float(np.hypot(push[0], push[1]))
    if size > _NONE:
        along = np.array([push[0], -push[1]]) / size
        tip = np.array([x, y]) + _LONGEST * size / most * along
        _arrow(canvas, np.array([[x, y], tip]), along)
    elif abs(push[2]) > _NONE:
        turn = np.linspace(0.0, 1.5 * np.pi, 40) * (-1.0 if push[2] > 0.0 else 1.0)
        arc = np.array([x, y]) + 45.0 * np.column_stack([np.cos(turn), np.sin(turn)])
        along = (arc[-1] - arc[-2]) / np.hypot(*(arc[-1] - arc[-2]))
        _arrow(canvas, arc, along)


def _arrow(canvas: Canvas, line: FloatArray, along: FloatArray) -> None:
    across = np.array([-along[1], along[0]])
    tip = line[-1]
    canvas.line(line, PURPLE, 5.0)
    head = np.array([tip - 16.0 * along + 9.0 * across, tip, tip - 16.0 * along - 9.0 * across])
    canvas.line(head, PURPLE, 5.0)


def _draw_numbers(
    canvas: Canvas, subject: Subject, recorded: ShakeRecording, rest: FloatArray, k: int
) -> None:
    """The largest displacement so far, with its limit."""
    size, so_far = subject.cage.outline.diameter, recorded.qpos[: k + 1, 3:] - rest[3:]
    far = float(np.hypot(so_far[:, 0], so_far[:, 1]).max()) * size
    turn = float(np.abs(so_far[:, 2]).max())
    rows = [
        ("moved", f"{far:.2g} {subject.unit}"),
        ("held up to", f"{HELD_SHIFT * size:.3g} {subject.unit}"),
        ("turned", f"{turn:.2g} rad"),
        ("held up to", f"{HELD_TURN:g} rad"),
    ]
    draw_table(canvas, "most so far", rows)
