"""Close many hands at once on all cores; every trial ends by itself.

One step of all running trials, then one look at them: so penetration is seen at every step, and a
trial that ended costs nothing more. Results do not depend on the number of threads, on the size of
the batch or on a trial's neighbours.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from icage.arrays import FloatArray
from sim.closing.approach import approached
from sim.closing.one import outcomes
from sim.closing.outcome import ClosingOutcomes
from sim.closing.push import push
from sim.closing.step_check import StepCheck
from sim.world.engine import Batch, mj, no_log
from sim.world.scene import Scene

BATCH = 1024
"""[trial] Closings stepped together: enough to hide Python's share of a step."""

Progress = Callable[[int], None]
"""Called with the number of trials that ended since the last call."""


def close_many(
    scene: Scene,
    starts: FloatArray,
    threads: int = 0,
    progress: Progress | None = None,
) -> ClosingOutcomes:
    """Close from every start (N, 4) = x, y, theta, sigma in the object's frame.

    ``threads`` is 0 for one per core; the results are the same for any number.
    """
    rows = np.asarray(starts, dtype=np.float64).reshape(-1, 4)
    with no_log():
        parts = [
            _close_batch(scene, rows[first : first + BATCH], threads, progress)
            for first in range(0, max(len(rows), 1), BATCH)
        ]
    return ClosingOutcomes.joined(parts)


def _close_batch(
    scene: Scene, starts: FloatArray, threads: int, progress: Progress | None
) -> ClosingOutcomes:
    qpos = scene.start_positions(starts)
    check = StepCheck.over(scene, qpos)
    if not len(starts):
        return outcomes(scene, starts, check, np.zeros((0, 7)))
    pushed = push(scene, approached(scene, qpos), check)
    batch = Batch(scene.model, nsim=len(starts), nthread=threads)
    batch.qpos, batch.qvel = pushed.positions, pushed.velocities
    batch.qacc_warmstart = pushed.accelerations
    batch.ctrl = scene.closing_force
    positions, velocities = batch.bind("qpos"), batch.bind("qvel")
    running = check.running
    if progress is not None and len(running) < len(starts):
        progress(len(starts) - len(running))
    while len(running):
        try:
            batch.step(running.astype(np.int32))
        except mj.batch.SimulationError as error:
            check.diverged(error.ids)
        check.observe(running, positions, velocities)
        warned = batch.warning[running, :, 1].any(axis=1)
        if warned.any():
            check.diverged(running[warned])
        before, running = len(running), check.running
        if progress is not None and len(running) < before:
            progress(before - len(running))
    return outcomes(scene, starts, check, batch.state)
