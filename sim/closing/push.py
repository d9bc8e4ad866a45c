"""While the object is pushed about: the engine's own step, for discs on convex pieces, no more.

Three contacts at most push a polygon over a viscous table. The engine spends 5 to 8 us on
each of these steps, most of it on finding what is near what and on a solver for any number of
anything. Here the same step is written down for this one scene and costs a quarter: the same
contacts (disc against the compiled pieces), the same regularization, the same metric, the same
order of updates. It is the engine's map, not one of our own: positions agree to 1e-9 after hundreds
of steps (``tests/sim/closing/test_push.py``), every step is counted and looked at like any other,
and the engine goes on from where it ends. The engine's are all states that might be a grasp: more
than three contacts, and whatever is touched and slow. ``SimConfig.computed_contacts`` = 0 leaves
everything to it.

``sim.closing.computed_step`` has the equations, ``sim.closing.plant`` their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray
from sim.closing.computed_step import STIFFEST, empty_room
from sim.closing.plant import plant_of
from sim.closing.push_loop import close_on
from sim.closing.step_check import RUNNING, StepCheck
from sim.world.scene import Scene


@dataclass(frozen=True, slots=True)
class Pushed:
    """Where the engine takes over, N closings.

    Attributes
    ----------
    positions, velocities, accelerations:
        (N, 6) of the last step computed.
    peak_force:
        (N,) [mass diameter / s^2] largest normal force on a finger at any look.
    """

    positions: FloatArray
    velocities: FloatArray
    accelerations: FloatArray
    peak_force: FloatArray


def push(
    scene: Scene, positions: FloatArray, check: StepCheck, rows: BoolArray | None = None
) -> Pushed:
    """Close from rest at positions (N, 6) while the object is pushed about.

    Steps are counted and looked at in ``check``, every ``check.stride``; what cannot be computed
    here (friction, a linkage that yields, trials outside ``rows``) is left to the engine as it is.
    """
    count = len(positions)
    state, peak = np.zeros((count, 3, 6)), np.zeros(count)
    state[:, 0] = positions
    if _known(scene) and count:
        _push(scene, state, peak, check, np.ones(count, dtype=np.bool_) if rows is None else rows)
    velocities, accelerations = state[:, 1], state[:, 2]
    return Pushed(state[:, 0].copy(), velocities.copy(), accelerations.copy(), peak)


def compile_steps(scene: Scene) -> None:
    """Have the loops compiled, or loaded, before there is anything to close."""
    nobody, state = np.zeros(0, dtype=np.int64), np.zeros((2, 3, 6))
    check = StepCheck.over(scene, state[:, 0])
    most = scene.config.computed_contacts
    close_on(nobody, plant_of(scene), empty_room(), most, state, np.zeros(2), *check.told)
    check.observe(nobody, state[:, 0], state[:, 1])


def _known(scene: Scene) -> bool:
    """Whether the step is the one written down here."""
    config = scene.config
    rigid = config.linkage_compliance == 0.0 and config.friction == 0.0
    return config.computed_contacts > 0 and rigid and min(config.solimp[:2]) >= STIFFEST


def _push(
    scene: Scene, state: FloatArray, peak: FloatArray, check: StepCheck, rows: BoolArray
) -> None:
    """Update state (N, 3, 6) and peak force (N,) of the closings ``rows``, as far as they go."""
    plant, room, most = plant_of(scene), empty_room(), scene.config.computed_contacts
    running = np.flatnonzero(rows & np.isfinite(state[:, 0]).all(axis=1))
    running = running[check.ending[running] == RUNNING]
    close_on(running, plant, room, most, state, peak, *check.told)
