"""Attack a cage: the hand is held at an opening, the object pulled about until it is out.

*Escape* is one of two, both certain whatever the planner says:

- a line separates the object from the three fingers: it can then be moved away along the line's
  normal without end, so to any distance beyond the hand's reach;
- the hand has shut on nothing: the three discs are one disc, and the plane without the object is
  connected for a disc (but for closed pockets, which no target may lie in), so it can be led away.

The penetration of every step is recorded: a finger that is d inside the object is a hand that is
open wider than its stop says, by an amount of the order of d.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numba import njit

from icage.arrays import FloatArray, IntArray
from sim.engine import MjModel, mj, no_log
from sim.held_hand import held_batch
from sim.scene import Scene
from sim.watch import depths

RUNNING, ESCAPED, HELD, DIVERGED = range(4)
ATTACK_ENDINGS = ("running", "escaped", "held", "diverged")

LOOK_EVERY = 10
"""[step] How often an escape is looked for; the depth is seen after every step."""

SHUT = 2e-3
"""[diameter] A hand whose longest side is shorter than this is one disc."""


class Driver(Protocol):
    """Who pulls: fills in the forces before every step."""

    @property
    def max_steps(self) -> int:
        """[step] Bound on one attack."""
        ...

    def drive(
        self, ids: IntArray, step: int, qpos: FloatArray, wrench: FloatArray, motor: FloatArray
    ) -> IntArray:
        """Write forces on the object, wrench (N, 3), and the motor's control (N,); rows ``ids``.

        Returns those that give up: the object is held.
        """
        ...


@dataclass(frozen=True, slots=True)
class Attacks:
    """What became of N attacks.

    Attributes
    ----------
    openings:
        (N,) [diameter] where the stop was.
    ending:
        (N,) codes into ``ATTACK_ENDINGS``.
    steps:
        (N,) length of each.
    penetration_max:
        (N,) [diameter] deepest disc over all steps.
    rise_max:
        (N,) [1] largest sigma / opening: above 1 the stop gave way.
    end:
        (N, 6) last positions.
    """

    openings: FloatArray
    ending: IntArray
    steps: IntArray
    penetration_max: FloatArray
    rise_max: FloatArray
    end: FloatArray

    def __len__(self) -> int:
        return len(self.ending)

    @property
    def escapes(self) -> int:
        """How many let the object out."""
        return int((self.ending == ESCAPED).sum())

    @property
    def diverged(self) -> int:
        """How many the engine gave up on."""
        return int((self.ending == DIVERGED).sum())


def attack(
    scene: Scene,
    model: MjModel,
    starts: FloatArray,
    openings: FloatArray,
    driver: Driver,
    threads: int = 0,
) -> Attacks:
    """Run N attacks at once from positions ``starts`` (N, 6), the hand held at ``openings`` (N,).

    ``model`` is ``held_model(scene)``, openings are in [diameter]. The result is the same for any
    number of threads (0: one per core).
    """
    count = len(starts)
    hull = hull_of(scene.thing.vertices)
    radius = scene.finger_radius / scene.thing.unit
    kinematics = scene.kinematics
    ending = np.full(count, RUNNING, dtype=np.int64)
    steps = np.zeros(count, dtype=np.int64)
    seen = np.zeros((count, 2))
    batch = held_batch(model, starts, openings, threads)
    positions, velocities = batch.bind("qpos"), batch.bind("qvel")
    applied, control = batch.bind("qfrc_applied"), batch.bind("ctrl")
    wrench, motor = np.zeros((count, 3)), np.zeros(count)
    running = np.arange(count)
    look: Callable[..., None] = _look
    with no_log():
        for step in range(driver.max_steps):
            given_up = driver.drive(running, step, positions, wrench, motor)
            applied[:, 3:6] = wrench
            control[:, 0] = motor
            try:
                batch.step(running.astype(np.int32))
            except mj.batch.SimulationError as error:
                ending[error.ids] = DIVERGED
            look(
                running,
                positions,
                velocities,
                openings,
                scene.thing.vertices,
                hull,
                radius,
                kinematics.directions,
                kinematics.tendon_coefficients,
                SHUT / kinematics.longest_side,
                step % LOOK_EVERY == 0,
                seen,
                steps,
                ending,
            )
            if step % LOOK_EVERY == 0:
                warned = batch.warning[running, :, 1].any(axis=1)
                ending[running[warned]] = DIVERGED
            ending[given_up[ending[given_up] == RUNNING]] = HELD
            running = np.flatnonzero(ending == RUNNING)
            if not len(running):
                break
    ending[running] = HELD
    return Attacks(
        np.array(openings), ending, steps, seen[:, 0], seen[:, 1], np.array(positions, copy=True)
    )


def hull_of(vertices: FloatArray) -> FloatArray:
    """Convex hull (h, 2) of a polygon (n, 2), counterclockwise."""
    hull = shapely.MultiPoint(vertices).convex_hull
    return np.array(shapely.get_coordinates(hull.normalize())[:-1][::-1])


@njit(cache=True)
def separated(
    hull: FloatArray, fingers: FloatArray, radius: float
) -> bool:  # pragma: no cover - compiled
    """Whether a line parallel to a side of either has the hull (h, 2) and all discs apart.

    Sides of the hull and of the triangle of fingers (3, 2); sufficient, not necessary, for discs.
    """
    count = hull.shape[0]
    for j in range(count + 3):
        if j < count:
            a, b = hull[j], hull[(j + 1) % count]
        else:
            a, b = fingers[j - count], fingers[(j - count + 1) % 3]
        nx, ny = b[1] - a[1], a[0] - b[0]
        length = math.hypot(nx, ny)
        if length < 1e-12:
            continue
        nx, ny = nx / length, ny / length
        low_h, high_h = math.inf, -math.inf
        for i in range(count):
            along = nx * hull[i, 0] + ny * hull[i, 1]
            low_h, high_h = min(low_h, along), max(high_h, along)
        low_f, high_f = math.inf, -math.inf
        for k in range(3):
            along = nx * fingers[k, 0] + ny * fingers[k, 1]
            low_f, high_f = min(low_f, along), max(high_f, along)
        if low_f - radius > high_h or low_h > high_f + radius:
            return True
    return False


@njit(cache=True)
def _look(
    ids: IntArray,
    qpos: FloatArray,
    qvel: FloatArray,
    openings: FloatArray,
    vertices: FloatArray,
    hull: FloatArray,
    radius: float,
    directions: FloatArray,
    coefficients: FloatArray,
    shut_sigma: float,
    thorough: bool,
    seen: FloatArray,
    steps: IntArray,
    ending: IntArray,
) -> None:  # pragma: no cover - compiled
    fingers, depth = np.empty((3, 2)), np.empty(3)
    for i in ids:
        steps[i] += 1
        cos, sin = math.cos(qpos[i, 5]), math.sin(qpos[i, 5])
        sigma, total = 0.0, 0.0
        for k in range(3):
            sigma += coefficients[k] * qpos[i, k]
            x = directions[k, 0] * qpos[i, k] - qpos[i, 3]
            y = directions[k, 1] * qpos[i, k] - qpos[i, 4]
            fingers[k, 0] = cos * x + sin * y
            fingers[k, 1] = cos * y - sin * x
        for k in range(6):
            total += abs(qvel[i, k]) + abs(qpos[i, k])
        if not math.isfinite(total):
            ending[i] = DIVERGED
            continue
        depths(vertices, fingers, radius, depth)
        seen[i, 0] = max(seen[i, 0], depth[0], depth[1], depth[2])
        seen[i, 1] = max(seen[i, 1], sigma / openings[i])
        if sigma < shut_sigma or (thorough and separated(hull, fingers, radius)):
            ending[i] = ESCAPED
