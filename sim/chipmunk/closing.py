"""Closings in the second engine, with the eyes and the judge of the first."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from sim.chipmunk.world import SecondConfig, World
from sim.closing.approach import approached
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import DIVERGED, StepCheck
from sim.world.scene import Scene


def close_many_second(
    scene: Scene, starts: FloatArray, config: SecondConfig | None = None
) -> ClosingOutcomes:
    """Close from every start (N, 4) = x, y, theta, sigma in the object's frame, one by one.

    The same start, motor, watch and end of a closing as ``sim.closing.batch.close_many``.

    Raises
    ------
    InputError:
        pymunk is not installed, or the scene has a linkage that yields.
    """
    rows = np.asarray(starts, dtype=np.float64).reshape(-1, 4)
    begin = scene.start_positions(rows)
    check = StepCheck.over(scene, begin, remains=np.zeros(len(begin)))
    states = np.zeros((len(rows), 12))
    states[:, :6] = approached(scene, begin)
    forces, contacts = np.zeros((len(rows), 3)), np.zeros(len(rows), dtype=np.int64)
    for i in range(len(rows)):
        only = np.array([i])
        if not np.isfinite(states[i]).all():
            check.diverged(only)
            continue
        world = World(scene, states[i, :6], config or SecondConfig())
        while not check.ending[i]:
            states[i] = world.step(scene.closing_force)
            check.observe(only, states[:, :6], states[:, 6:])
        if check.ending[i] != DIVERGED:
            forces[i], contacts[i] = world.press()
    return ClosingOutcomes.seen(check, rows, scene.placements(states[:, :6]), forces, contacts)
