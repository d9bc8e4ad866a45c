"""The hand closes in MuJoCo from where it stands: the only file of the page that knows an engine.

It runs in a process of its own. What is told is the closing that ``icage replay`` makes of the same
placement; what is shown moves through free space step by step, too.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, Final

import numpy as np

from experiments.explore.live.thing import Thing
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.hand import Placement
from icage.planner import plan
from sim.closing.batch import close_many
from sim.closing.judge import OUTCOMES, judge
from sim.closing.outcome import ClosingOutcomes
from sim.closing.recording import Recording, record
from sim.world.config import SimConfig
from sim.world.scene import Scene

FRAMES: Final = 400
"""Frames of a film at most."""

FARTHEST: Final = 20.0
"""[diameter] No finger stands further from the object: to close from there shows nothing more."""


class Closing:
    """Answers ``close``."""

    def __init__(self, thing: Thing) -> None:
        self.thing = thing
        self._planned: tuple[str, Cage] | None = None

    def answer(self, kind: str, question: dict[str, Any], _stopped: object) -> str:
        """The document of an answer."""
        if kind == "warm":
            return "{}"
        cage = self._cage(question)
        start = _start(cage, question["placement"])
        config = SimConfig(friction=question["friction"])
        scene = Scene(cage.outline, cage.hand, cage.finger_radius, config)
        closings = close_many(scene, start.as_array()[None, :], threads=1)
        film = record(scene, start, max_frames=_frames_of(config))
        return json_text(closing_document(cage, config, closings, film))

    def _cage(self, question: dict[str, Any]) -> Cage:
        key = repr((question["radius"], question["contacts"]))
        if self._planned is None or self._planned[0] != key:
            self._planned = key, plan(self.thing.case_asked(question))
        cage = self._planned[1]
        if cage.status == "not_a_cage":
            raise InputError(
                f"these contacts are no cage ({cage.why}): there is nothing to close on"
            )
        return cage


def _start(cage: Cage, row: list[float]) -> Placement:
    """Where the closing begins, with every finger clear of the object and near it."""
    start = Placement(*row)
    fingers = cage.hand.fingers(start.as_array())
    size = cage.outline.diameter
    far = float(np.hypot(*(fingers - cage.outline.centroid).T).max())
    if far > FARTHEST * size:
        raise InputError(
            f"a finger is {far / size:.3g} diameters from the object; closings from up to "
            f"{FARTHEST:g} are shown"
        )
    answer = cage.query(start)
    if answer.verdict == "collision":
        raise InputError("a finger stands inside the object: move the hand before it closes")
    return start


def _frames_of(config: SimConfig) -> int:
    """As many as the longest closing has, a hundred a second."""
    return int(100 * config.max_time) + 2


def closing_document(
    cage: Cage, config: SimConfig, closings: ClosingOutcomes, film: Recording
) -> dict[str, Any]:
    """The document ``icage-closing/1``; lengths in the object's unit, angles in degrees."""
    friction = config.friction > 0.0
    verdicts = judge(closings, cage.grasps, cage.outline, friction=friction)
    one, size = closings[0], cage.outline.diameter
    outcome = OUTCOMES[int(verdicts.outcome[0])]
    lost = outcome == "diverged"
    rows, time = _thinned(film)
    return {
        "format": "icage-closing/1",
        "outcome": outcome,
        "grasp_id": int(verdicts.grasp_id[0]),
        "end": None if lost else one.end.as_array(),
        "position_error": None if lost else float(verdicts.position_error[0]) * size,
        "angle_error_deg": None if lost else float(np.degrees(verdicts.angle_error[0])),
        "penetration_max": None if lost else one.penetration_max * size,
        "penetration_rest": None if lost else one.penetration_rest * size,
        "friction": config.friction,
        "time_step": config.time_step,
        "simulated": float(film.time[-1]),
        "engine": f"MuJoCo {version('mujoco')}",
        "time": time,
        "placements": rows,
    }


def _thinned(film: Recording) -> tuple[FloatArray, FloatArray]:
    """Up to ``FRAMES`` frames, the first and the last among them; (f, 4) placements, (f,) [s]."""
    good = np.isfinite(film.placements).all(axis=1)
    kept = np.flatnonzero(good)
    picked = kept[np.unique(np.linspace(0, len(kept) - 1, min(FRAMES, len(kept))).astype(int))]
    rows = np.array(film.placements[picked])
    rows[:, 3] = np.maximum(rows[:, 3], 0.0)  # the last step of a shut hand may go past zero
    return rows, film.time[picked]


def worker(thing: Thing) -> Closing:
    """For ``Lane``."""
    return Closing(thing)
