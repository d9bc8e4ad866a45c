"""Random attacks in the second engine: the same pulls, the same stop, the same way of being out."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from sim.attack.held import DIVERGED, RUNNING, AttackMonitor, Attacks
from sim.attack.random import RandomDriver, RandomPull
from sim.chipmunk.world import SecondConfig, World
from sim.world.scene import Scene


def random_attack_second(
    scene: Scene,
    starts: FloatArray,
    openings: FloatArray,
    rng: np.random.Generator,
    pull: RandomPull | None = None,
    config: SecondConfig | None = None,
) -> Attacks:
    """Pull at the object from positions ``starts`` (N, 6), the hand held at ``openings`` (N,).

    Openings are in [diameter]: the hand may close, but never open wider. Given the same ``rng`` the
    wrenches are those of ``sim.attack.held.attack`` with a ``RandomDriver``; the motor answers to
    where the hand is.

    Raises
    ------
    InputError:
        pymunk is not installed, the scene has a linkage that yields, or an opening
        is not a positive number.
    """
    openings = np.array(openings, dtype=np.float64)
    if not (np.isfinite(openings).all() and (openings > 0.0).all()):
        raise InputError("an opening to hold the hand at must be a finite number above 0")
    driver = RandomDriver(scene, openings, rng, pull or RandomPull())
    lookout = AttackMonitor.over(scene, openings)
    end = np.array(starts, dtype=np.float64)
    for i in range(len(end)):
        _attack(lookout, driver, i, end, config or SecondConfig())
    return lookout.attacks(end)


def _attack(
    lookout: AttackMonitor, driver: RandomDriver, i: int, qpos: FloatArray, config: SecondConfig
) -> None:
    """Run attack i from qpos[i], which moves; what is seen of it goes into row i of the lookout."""
    if not np.isfinite(qpos[i]).all():
        lookout.ending[i] = DIVERGED
        return
    world = World(lookout.scene, qpos[i], config, float(lookout.openings[i]))
    only, qvel = np.array([i]), np.zeros_like(qpos)
    wrench, motor = np.zeros((len(qpos), 3)), np.zeros(len(qpos))
    for step in range(driver.max_steps):
        driver.drive(only, step, qpos, wrench, motor)
        state = world.step(float(motor[i]), tuple(wrench[i].tolist()))
        qpos[i], qvel[i] = state[:6], state[6:]
        lookout.look(only, step, qpos, qvel)
        if int(lookout.ending[i]) != RUNNING:
            return
