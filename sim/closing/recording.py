"""The trajectory of one closing at a frame rate: what a video or a plot needs.

Unlike ``sim.closing.one`` the free travel is simulated too, so that the film shows it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.errors import InputError
from icage.hand import Placement
from sim.closing.one import data_at
from sim.closing.step_check import ENDINGS, StepCheck
from sim.world.contact_forces import finger_forces
from sim.world.engine import mj, no_log
from sim.world.scene import Scene

_WHOLE = 1e-9
"""[step] Frame times this close to a whole number of steps are that number: rounding."""


@dataclass(frozen=True, slots=True)
class Recording:
    """F frames of one closing, evenly spaced, the first at rest before it, the last at its end.

    Attributes
    ----------
    time:
        (F,), [s] of the normalized world.
    qpos:
        (F, 6), engine positions, for ``sim.camera.renderer``.
    placements:
        (F, 4) = x, y, theta, sigma: the hand in the object's frame and unit.
    finger_forces:
        (F, 3), [drive_force], size of the contact force on each finger.
    ending:
        One of ``sim.closing.look.ENDINGS``; "running" if ``max_frames`` cut it off.
    """

    time: FloatArray
    qpos: FloatArray
    placements: FloatArray
    finger_forces: FloatArray
    ending: str

    @property
    def sigma(self) -> FloatArray:
        """(F,), in the object's unit."""
        return self.placements[:, 3]

    def __len__(self) -> int:
        return len(self.time)


def record(
    scene: Scene, start: Placement, frame_time: float = 0.01, max_frames: int = 2000
) -> Recording:
    """Close from one placement and keep a frame every ``frame_time``, [s] of simulated time."""
    if not frame_time > 0.0 or max_frames < 2:
        raise InputError(
            f"frame_time {frame_time} and max_frames {max_frames}: a positive time and "
            "two frames or more are needed"
        )
    every = max(1, math.ceil(frame_time / scene.config.time_step - _WHOLE))
    qpos = scene.start_positions(start.as_array())
    data = data_at(scene, qpos[0])
    check = StepCheck.over(scene, qpos)
    only = np.zeros(1, dtype=np.int64)
    frames: list[tuple[float, FloatArray, FloatArray]] = [(0.0, qpos[0], np.zeros(3))]
    with no_log():
        for step in range(1, scene.config.max_steps + 1):
            mj.mj_step(scene.model, data)
            check.observe(only, data.qpos[None, :], data.qvel[None, :])
            if data.warning.number.any():
                check.diverged(only)
            ended = not len(check.running)
            if ended or step % every == 0:
                vectors, _ = finger_forces(scene.model, data)
                forces = np.hypot(vectors[:, 0], vectors[:, 1]) / scene.config.drive_force
                frames.append((float(data.time), np.array(data.qpos), forces))
            if ended or len(frames) >= max_frames:
                break
    positions = np.array([frame[1] for frame in frames])
    return Recording(
        time=read_only(np.array([frame[0] for frame in frames])),
        qpos=read_only(positions),
        placements=read_only(scene.placements(positions)),
        finger_forces=read_only(np.array([frame[2] for frame in frames])),
        ending=ENDINGS[int(check.ending[0])],
    )
