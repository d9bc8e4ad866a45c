"""The shake test as a film needs it: positions and pushes at a frame rate.

The same pushes as ``sim.grip.shake``; those of the random shake are of its own random numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, read_only
from sim.grip.shake import PUSH_TIME, SHAKE_TIME, SHAKES, pushes, random_wrenches
from sim.world.engine import mj, no_log
from sim.world.rigid_hand import rigid_data, rigid_model
from sim.world.scene import Scene


@dataclass(frozen=True, slots=True)
class ShakeRecording:
    """F frames of a shake.

    Attributes
    ----------
    qpos:
        (F, 6), engine positions; the fingers are locked.
    wrenches:
        (F, 3), force and torque on the object, [drive_force, ... diameter].
    random_from:
        The frame with which the random shake begins.
    """

    qpos: FloatArray
    wrenches: FloatArray
    random_from: int


def record_shake(
    scene: Scene, qpos: FloatArray, rng: np.random.Generator, frames: int
) -> ShakeRecording:
    """Lock the hand at qpos (6,), push in every direction, shake; half of the frames each.

    Every push begins at rest in the grasp; the random shake goes on from where it is.
    """
    sigma = float(scene.sigma(qpos[None, :])[0])
    model = rigid_model(scene, sigma)
    gyration = math.sqrt(scene.object.gyration_squared)
    each = pushes(gyration)
    random = random_wrenches(rng, SHAKES, gyration)
    half = frames // 2
    poses: list[FloatArray] = []
    wrenches: list[FloatArray] = []
    with no_log():
        for k, wrench in enumerate(each):
            count = half * (k + 1) // len(each) - half * k // len(each)
            _run(scene, model, qpos, wrench[None, :], PUSH_TIME, count, poses, wrenches)
        _run(scene, model, qpos, random, SHAKE_TIME, frames - half, poses, wrenches)
    slides = np.repeat(np.asarray(qpos)[None, :3], frames, axis=0)
    return ShakeRecording(
        read_only(np.column_stack([slides, np.array(poses)])), read_only(np.array(wrenches)), half
    )


def _run(
    scene: Scene, model: object, qpos: FloatArray, wrenches: FloatArray, time: float, count: int,
    poses: list[FloatArray], kept: list[FloatArray],
) -> None:  # fmt: skip
    """``count`` frames, evenly over wrenches (n, 3) that last ``time`` [s] each."""
    data = rigid_data(model, np.array(qpos[3:]))
    steps = math.ceil(time / scene.config.time_step)
    total, step = steps * len(wrenches), 0
    for frame in range(count):
        until = total * (frame + 1) // count
        while step < until:
            data.qfrc_applied[:] = scene.config.drive_force * wrenches[step // steps]
            mj.mj_step(model, data)
            step += 1
        poses.append(np.array(data.qpos))
        kept.append(wrenches[max(step - 1, 0) // steps])
