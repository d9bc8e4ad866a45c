"""Close the hand on the free object, one trial at a time: the plain loop.

``sim.closing.batch`` does the same for many trials on several threads, bit for bit.
"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.hand import Placement
from sim.closing.approach import approached
from sim.closing.outcome import ClosingOutcome, ClosingOutcomes
from sim.closing.push import push
from sim.closing.step_check import DIVERGED, StepCheck
from sim.world.contact_forces import finger_forces
from sim.world.engine import MjData, mj, no_log
from sim.world.scene import Scene


def close(scene: Scene, start: Placement) -> ClosingOutcome:
    """Close from one placement until the hand is still, has shut, or time is up."""
    placements = start.as_array()[None, :]
    qpos = scene.start_positions(placements)
    check = StepCheck.over(scene, qpos)
    pushed = push(scene, approached(scene, qpos), check)
    data = data_at(scene, pushed.positions[0])
    data.qvel[:], data.qacc_warmstart[:] = pushed.velocities[0], pushed.accelerations[0]
    only = np.zeros(1, dtype=np.int64)
    with no_log():
        while len(check.running):
            mj.mj_step(scene.model, data)
            check.observe(only, data.qpos[None, :], data.qvel[None, :])
            if data.warning.number.any():
                check.diverged(only)
    return outcomes(scene, placements, check, integration_state(scene, data)[None, :])[0]


def data_at(scene: Scene, qpos: FloatArray) -> MjData:
    """An MjData at rest at qpos (6,), the motor pulling."""
    data = mj.MjData(scene.model)
    data.qpos[:] = qpos
    data.ctrl[:] = scene.closing_force
    return data


def integration_state(scene: Scene, data: MjData) -> FloatArray:
    """Everything the next step depends on, as one row."""
    signature = int(mj.mjtState.mjSTATE_INTEGRATION)
    state = np.zeros(mj.mj_stateSize(scene.model, signature))
    mj.mj_getState(scene.model, data, state, signature)
    return state


def outcomes(
    scene: Scene, start: FloatArray, check: StepCheck, states: FloatArray
) -> ClosingOutcomes:
    """Read off the end of N closings from their integration states (N, nstate)."""
    forces, contacts = _press(scene, check.ending, states)
    positions = np.array(states[:, 1:7])  # after the time
    return ClosingOutcomes.seen(check, start, scene.placements(positions), forces, contacts)


def _press(scene: Scene, ending: IntArray, states: FloatArray) -> tuple[FloatArray, IntArray]:
    """Forces (N, 3), [drive_force], and contacts (N,) of the final states."""
    forces = np.zeros((len(states), 3))
    contacts = np.zeros(len(states), dtype=np.int64)
    data = mj.MjData(scene.model)
    signature = int(mj.mjtState.mjSTATE_INTEGRATION)
    for i in np.flatnonzero(ending != DIVERGED).tolist():
        mj.mj_setState(scene.model, data, states[i], signature)
        mj.mj_forward(scene.model, data)
        vectors, contacts[i] = finger_forces(scene.model, data)
        forces[i] = np.hypot(vectors[:, 0], vectors[:, 1]) / scene.config.drive_force
    return forces, contacts
