"""Closings per second per core, and how that compares with bare engine steps.

    python -m benchmarks.closing            all targets, one thread
    python -m benchmarks.closing --trials 300 --threads 2

Starts are drawn near the target, clear of the object; every one must end in it, or the figure means
nothing. Early stop is included; free travel before the first touch is computed, not simulated.
Seconds are processor seconds of all threads, so a busy machine blurs the figures less.
"""

from __future__ import annotations

import argparse
import time

import mujoco
import numpy as np

from sim.batch import close_many
from sim.closing import data_at
from sim.judge import judge
from sim.scene import Scene
from tests.sim.grasps import KnownGrasp, l_shape, shipped, starts_near, t_shape, triangle

TARGETS = {
    "T, three corners": (t_shape, 1.5),
    "L, one corner": (l_shape, 1.5),
    "pliers, corners": (lambda: shipped("pliers"), 1.6),
    "saw, corners": (lambda: shipped("saw"), 1.1),
    "triangle, three edges (no corner: shown apart)": (triangle, 1.1),
}


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.add_argument("--trials", type=int, default=300)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    print(f"{options.trials} closings each, {options.threads} thread(s)")
    print("per second  steps each  us/step  bare us/step  reached   target")
    for name, (make, opening) in TARGETS.items():
        grasp = make()
        _report(name, grasp, opening, options.trials, options.threads)


def _report(name: str, grasp: KnownGrasp, opening: float, trials: int, threads: int) -> None:
    scene = grasp.scene()
    starts = starts_near(grasp, trials, seed=1, opening=opening)
    close_many(scene, starts[:2], threads)  # compile and warm up
    begin = time.process_time()
    closings = close_many(scene, starts, threads)
    seconds = time.process_time() - begin
    reached = judge(closings, [grasp], grasp.outline).counts()["target"]
    per_step = 1e6 * seconds / closings.steps.sum()
    print(
        f"{trials / seconds:10.0f}  {closings.steps.mean():10.0f}  {per_step:7.1f}"
        f"  {bare_step(scene, starts):12.1f}  {reached}/{trials}   {name}"
    )


def bare_step(scene: Scene, starts: np.ndarray) -> float:
    """[us] One ``mj_step`` in the C loop, over the same motion."""
    spent, steps = 0.0, 300
    for row in scene.start_positions(starts[:5]):
        data = data_at(scene, row)
        begin = time.process_time()
        mujoco.mj_step(scene.model, data, steps)
        spent += time.process_time() - begin
    return 1e6 * spent / (5 * steps)


if __name__ == "__main__":
    main()
