"""An attack: the hand is held a little above sigma_max, and the object is led out of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from experiments.escape.run import at
from experiments.escape.setup import AttackSetup
from experiments.figures.drawing.canvas import Canvas
from experiments.figures.drawing.object_view import ObjectView
from experiments.figures.drawing.palette import BAD, INK
from experiments.figures.drawing.plots import Curve, Plot
from experiments.replay.film_page import (
    BOTTOM,
    LEFT,
    LOWER,
    SHADES,
    draw_badge,
    draw_headline,
    sigma_plot,
)
from experiments.video.engine_view import engine_view
from experiments.video.nothing_to_film import NothingToFilmError
from experiments.video.scene_page import draw_curve, draw_still, still_ends
from experiments.video.subject import Subject
from icage.arrays import FloatArray, IntArray
from icage.errors import InputError
from sim.attack.guided import GuidedDriver
from sim.attack.held import ESCAPED, attack

TRIES = 8
"""Attacks of which the first that escapes is filmed."""

WIDER = (1.0, 5.0, 20.0)
"""[1] How far above sigma_max the hand is held, over what ``icage escape`` takes: the next where
none of the attacks escapes."""

_EVERY = 10
"""[step] Between two positions that are kept."""


@dataclass(frozen=True, slots=True, eq=False)
class _Recording:
    """A driver that keeps the positions that it is shown, an array (N, 6) every few steps."""

    driver: GuidedDriver
    kept: list[FloatArray] = field(default_factory=list[FloatArray])

    @property
    def max_steps(self) -> int:
        return self.driver.max_steps

    def drive(
        self, ids: IntArray, step: int, qpos: FloatArray, wrench: FloatArray, motor: FloatArray
    ) -> IntArray:
        if step % _EVERY == 0:
            self.kept.append(np.array(qpos))
        return self.driver.drive(ids, step, qpos, wrench, motor)


def attack_scene(subject: Subject, canvas: Canvas) -> Iterator[None]:
    """A frame of the film on the canvas at every step.

    Raises
    ------
    InputError:
        The object never escapes from this hand.
    NothingToFilmError:
        None of the attacks got it out.
    """
    cage, scene = subject.cage, subject.scene
    if cage.sigma_max is None:
        raise InputError(f"{subject.name} never escapes from this hand: no attack can succeed")
    recorded, opening = escaped(subject)
    share = still_ends(subject.frames)
    row = share * (len(recorded) - 1)
    qpos = np.column_stack([np.interp(row, np.arange(len(recorded)), c) for c in recorded.T])
    placements = scene.placements(qpos)
    plot = sigma_plot(cage, placements[:, 3])
    target = scene.start_positions(cage.target_placement.as_array())[0]
    away = np.hypot(*(qpos[:, 3:5] - target[3:5]).T)
    far = Plot(LOWER, "object from its target, in diameters", 1.0, (0.0, 1.15 * away.max()))
    small = ObjectView(cage, subject.regions, placements[::10], BOTTOM)
    over = opening / cage.sigma_max
    about = f"hand held at {over:.4f} sigma_max, {subject.about_fingers}"
    draw_still(canvas, subject, about, [plot, far], SHADES)
    canvas.text(LEFT, BOTTOM[1] - 9.0, "seen from the object", 15.0, INK)
    small.draw_still(canvas)
    still = canvas.pixels.copy()
    with engine_view(subject, qpos, canvas.scale) as (paint, _):
        for k in range(len(qpos)):
            canvas.pixels[:] = still
            paint(canvas, k)
            draw_curve(canvas, plot, share, placements[:, 3], k)
            far.draw_curve(canvas, Curve(share, away, INK), float(share[k]))
            small.draw_ways(canvas, placements[: k + 1], 1.0)
            small.draw_fingers(canvas, placements[k])
            out = share[k] >= 1.0
            if out:
                draw_headline(canvas, "above sigma_max the object escapes, as planned", BAD)
                draw_badge(canvas, "escaped", False)
            else:
                draw_headline(canvas, "the object is led along the plan's way out")
            yield


def escaped(subject: Subject) -> tuple[FloatArray, float]:
    """Positions (n, 6) of an attack that escaped, evenly spaced in time, and the opening, [unit].

    Raises
    ------
    NothingToFilmError:
        None did.
    """
    cage, scene, size = subject.cage, subject.scene, subject.cage.outline.diameter
    assert cage.sigma_max is not None
    upper = cage.sigma_max_upper or cage.sigma_max
    setup = AttackSetup.of(subject.physical, at(cage.sigma_max, cage.sigma_0, -1), 0)
    assert setup.path is not None
    streams = np.random.default_rng([subject.seed, 4]).spawn(len(WIDER))
    for factor, rng in zip(WIDER, streams, strict=True):
        opening = upper + factor * (at(upper, cage.sigma_0, 1) - upper)
        openings = np.full(TRIES, opening / size)
        driver = _Recording(GuidedDriver(scene, openings, setup.path, rng))
        starts = np.repeat(setup.target[None, :], TRIES, axis=0)
        done = attack(scene, setup.model, starts, openings, driver)
        out = np.flatnonzero(done.ending == ESCAPED)
        if len(out):
            first = int(out[0])
            kept = np.array([rows[first] for rows in driver.kept])
            kept = kept[: int(done.steps[first]) // _EVERY + 1]
            return np.vstack([kept, done.end[first]]), opening
    raise NothingToFilmError(
        f"none of {TRIES * len(WIDER)} attacks on {subject.name} above sigma_max escaped (seed "
        f"{subject.seed})"
    )
