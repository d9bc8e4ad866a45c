"""The second engine (Chipmunk2D) beside MuJoCo: same starts, where do closings and attacks end?

    python3 -m benchmarks.second_engine [CLOSINGS [ATTACKS]]

prints one line per grasp; the table of docs/decisions/0006-second-engine.md. Closings start in the
guaranteed set, seed 0; attacks on the pliers start on the way out, at 0.99 sigma_max.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from icage.planner import plan
from icage.sampling import draw_starts
from sim.attack.held import attack
from sim.attack.random import RandomDriver, RandomPull
from sim.chipmunk.attack import random_attack_second
from sim.chipmunk.closing import close_many_second
from sim.closing.batch import close_many
from sim.closing.judge import judge
from sim.world.held_hand import held_model
from tests.sim.chipmunk.test_chipmunk import on_the_way_out
from tests.sim.grasps import GRASPS, KnownGrasp

NAMES = ("T", "L", "triangle", "pliers", "saw")
OPENINGS = (0.998, 1.02, 1.05, 1.1)
PULL = RandomPull(duration=8.0)


def closing_line(name: str, grasp: KnownGrasp, count: int) -> str:
    """Closings of one grasp in both engines."""
    cage = plan(grasp.outline, grasp.contacts, grasp.radius)
    starts = draw_starts(cage, "guaranteed", count, np.random.default_rng(0)).placements
    scene = grasp.scene()
    first = close_many(scene, starts, threads=1)
    began = time.process_time()
    ours = close_many_second(scene, starts)
    rate = count / (time.process_time() - began)
    found, theirs = (judge(one, [grasp], grasp.outline) for one in (ours, first))
    unit = [grasp.outline.diameter, grasp.outline.diameter, 1.0, grasp.outline.diameter]
    apart = np.abs((ours.end - first.end) / unit).max()
    return (
        f"{name}: target {found.counts()['target']} and {theirs.counts()['target']} of {count}, "
        f"off by {found.position_error.max():.1e} and {found.angle_error.max():.1e} rad, "
        f"ends apart {apart:.1e}, deepest {ours.penetration_max.max():.1e}, "
        f"at rest {ours.penetration_rest.max():.1e}, shape {ours.shape_error_max.max():.1e}, "
        f"steps {ours.steps.mean():.0f} and {first.steps.mean():.0f}, {rate:.0f} / s"
    )


def attack_line(grasp: KnownGrasp, factor: float, count: int) -> str:
    """Random attacks in both engines: one start, the same wrenches."""
    scene, top, start = on_the_way_out(grasp)
    starts, openings = np.repeat(start[None], count, axis=0), np.full(count, factor * top)
    ours = random_attack_second(scene, starts, openings, np.random.default_rng(0), PULL)
    driver = RandomDriver(scene, openings, np.random.default_rng(0), PULL)
    theirs = attack(scene, held_model(scene), starts, openings, driver, 1)
    return (
        f"pliers held at {factor} sigma_max: out {ours.escapes} and {theirs.escapes} of {count}, "
        f"deepest {ours.penetration_max.max():.1e} and {theirs.penetration_max.max():.1e}, "
        f"stop {ours.rise_max.max():.5f} and {theirs.rise_max.max():.5f}"
    )


def main() -> None:
    """Print all lines."""
    closings, attacks = (int(word) for word in [*sys.argv[1:], "60", "12"][:2])
    print("second engine and MuJoCo; lengths in diameters", flush=True)
    for name in NAMES:
        print(closing_line(name, GRASPS[name](), closings), flush=True)
    for factor in OPENINGS:
        print(attack_line(GRASPS["pliers"](), factor, attacks), flush=True)


if __name__ == "__main__":
    main()
