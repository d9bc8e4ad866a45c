"""What the engine did, seen in the hand's frame: by MuJoCo's camera, or drawn, in one place."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from typing import TypeAlias

from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.hand_view import HandView, window_on
from experiments.replay.film_page import MAIN
from experiments.replay.photographs import Photographs
from experiments.video.subject import Subject
from icage.arrays import FloatArray
from sim.camera.stage import View

Painter: TypeAlias = Callable[[Canvas, int], None]


@contextmanager
def engine_view(
    subject: Subject, qpos: FloatArray, scale: float
) -> Generator[tuple[Painter, View]]:
    """A painter of frame k of positions (F, 6), asked for in order, and its window.

    ``scale`` is the canvas's. Regions, numbers and the target are in the same places either way.
    """
    cage, scene = subject.cage, subject.scene
    window = window_on(scene, qpos, *MAIN, whole=True)
    hand = HandView(scene, window, subject.regions, cage.target_placement)
    with ExitStack() as stack:
        taken = None
        if subject.camera:
            begun = Photographs.begun(scene, qpos, window, subject.regions, cage, stack, scale)
            taken = begun if begun.taken() else None

        def paint(canvas: Canvas, k: int) -> None:
            if taken is None:
                hand.draw(canvas, qpos[k], qpos[0])
            else:
                canvas.paste(taken.at(k), 0, 0)
                hand.draw_goal(canvas)
                hand.draw_numbers(canvas, qpos[k])

        yield paint, window
