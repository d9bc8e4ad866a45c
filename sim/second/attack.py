"""Random attacks in the second engine: the same pulls, the same stop, the same way of being out."""

from __future__ import annotations

import math

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from sim.attack import DIVERGED, ESCAPED, HELD, LOOK_EVERY, SHUT, Attacks, hull_of, separated
from sim.random_attack import RandomDriver, RandomPull
from sim.scene import Scene
from sim.second.world import SecondConfig, World
from sim.watch import depths


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
    wrenches are those of ``sim.attack.attack`` with a ``RandomDriver``; the motor answers to where
    the hand is.

    Raises
    ------
    InputError:
        pymunk is not installed, the scene has friction or a linkage that yields, or an opening
        is not a positive number.
    """
    openings = np.array(openings, dtype=np.float64)
    if not (np.isfinite(openings).all() and (openings > 0.0).all()):
        raise InputError("an opening to hold the hand at must be a finite number above 0")
    count = len(starts)
    driver = RandomDriver(scene, openings, rng, pull or RandomPull())
    end = np.array(starts, dtype=np.float64)
    used = config or SecondConfig()
    runs = [_attack(scene, driver, i, end, float(openings[i]), used) for i in range(count)]
    ending = np.array([run[0] for run in runs], dtype=np.int64)
    steps = np.array([run[1] for run in runs], dtype=np.int64)
    deepest, rise = np.array([run[2:] for run in runs]).reshape(-1, 2).T.copy()
    return Attacks(openings, ending, steps, deepest, rise, end)


def _attack(
    scene: Scene,
    driver: RandomDriver,
    i: int,
    qpos: FloatArray,
    opening: float,
    config: SecondConfig,
) -> tuple[int, int, float, float]:
    """Ending, steps, deepest disc and largest sigma / opening of attack i; moves qpos[i]."""
    if not np.isfinite(qpos[i]).all():
        return DIVERGED, 0, 0.0, 0.0
    world = World(scene, qpos[i], config, opening)
    only = np.array([i])
    wrench, motor = np.zeros((len(qpos), 3)), np.zeros(len(qpos))
    hull, depth = hull_of(scene.thing.vertices), np.empty(3)
    radius = scene.finger_radius / scene.thing.unit
    shut = SHUT / scene.kinematics.longest_side
    deepest = rise = 0.0
    for step in range(driver.max_steps):
        driver.drive(only, step, qpos, wrench, motor)
        qpos[i] = world.step(float(motor[i]), tuple(wrench[i].tolist()))[:6]
        if not np.isfinite(qpos[i]).all():
            return DIVERGED, step + 1, deepest, rise
        fingers = _fingers_seen(scene, qpos[i])
        depths(scene.thing.vertices, fingers, radius, depth)
        sigma = float(scene.sigma(qpos[i : i + 1])[0])
        deepest, rise = max(deepest, float(depth.max())), max(rise, sigma / opening)
        if sigma < shut or (step % LOOK_EVERY == 0 and separated(hull, fingers, radius)):
            return ESCAPED, step + 1, deepest, rise
    return HELD, driver.max_steps, deepest, rise


def _fingers_seen(scene: Scene, qpos: FloatArray) -> FloatArray:
    """Finger centres (3, 2) in the object's axes, from its centroid."""
    off = scene.kinematics.directions * qpos[:3, None] - qpos[3:5]
    cos, sin = math.cos(qpos[5]), math.sin(qpos[5])
    return np.column_stack([cos * off[:, 0] + sin * off[:, 1], cos * off[:, 1] - sin * off[:, 0]])
