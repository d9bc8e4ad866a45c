"""The shake test: is the object held by fingers locked at the size they closed to?

The hand is made rigid (``sim.world.rigid_hand``) and the object pushed: a force at its centroid in
8 directions, a torque both ways, each from rest in the grasp, then a random shake of many wrenches
one after another. The habit of grasp benchmarks, in the plane.

*Held* means: in no push and at no moment of the shake was the centroid further than
``HELD_SHIFT`` from its place in the closed hand, or the object turned by more than ``HELD_TURN``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from sim.world.engine import MjData, MjModel, mj, no_log
from sim.world.rigid_hand import disc_depths, rigid_data, rigid_model
from sim.world.scene import Scene

PUSH: Final = 0.1
"""[drive_force] Size of a force; a torque is this times the radius of gyration."""

PUSH_TIME: Final = 0.5
"""[s] A free object would go 0.15 diameters (PUSH drive_force / object_damping) in this time."""

SHAKES: Final = 60
"""Wrenches of the random shake, ``SHAKE_TIME`` each."""

SHAKE_TIME: Final = 0.1
"""[s]."""

_LOOK: Final = 5
"""[step] Depths are measured this often."""

HELD_SHIFT: Final = 1e-2
"""[diameter] A fifteenth of the way a free object would go. Held grasps give some 1e-6 on concave
corners; an edge-only grasp also shifts as it turns, by the distance of the centroid from the point
where the force lines meet."""

HELD_TURN: Final = 5e-2
"""[rad] Ten times what three-edge grasps give: they turn by the root of the contacts' softness,
sqrt(2 penetration / sigma_0), 4e-3 for 1e-5."""


@dataclass(frozen=True, slots=True)
class Push:
    """One constant wrench, in the hand's frame P.

    Attributes
    ----------
    force, torque:
        (2,) [drive_force] and [drive_force diameter].
    shift, turn:
        [diameter] and [rad]: the farthest the centroid was, and the most the object was turned.
    """

    force: tuple[float, float]
    torque: float
    shift: float
    turn: float


@dataclass(frozen=True, slots=True)
class Shake:
    """The answer: ten pushes, the random shake, the depth reached, whether the engine warned."""

    pushes: tuple[Push, ...]
    random_shift: float
    random_turn: float
    penetration: float
    """[diameter] Deepest disc, every few steps: it acts as a little more room."""
    diverged: bool

    @property
    def shift(self) -> float:
        """[diameter] The farthest the centroid was."""
        return max(self.random_shift, *(push.shift for push in self.pushes))

    @property
    def turn(self) -> float:
        """[rad] The most the object was turned."""
        return max(self.random_turn, *(push.turn for push in self.pushes))

    @property
    def held(self) -> bool:
        """Whether the object stayed within ``HELD_SHIFT`` and ``HELD_TURN``; not if it diverged."""
        return not self.diverged and self.shift <= HELD_SHIFT and self.turn <= HELD_TURN


def pushes(gyration: float) -> FloatArray:
    """(10, 3) wrenches [drive_force, ... diameter]: 8 directions, then torque both ways."""
    angles = 0.25 * math.pi * np.arange(8)
    forces = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(8)])
    return PUSH * np.vstack([forces, [[0.0, 0.0, gyration], [0.0, 0.0, -gyration]]])


def random_wrenches(rng: np.random.Generator, count: int, gyration: float) -> FloatArray:
    """(count, 3) forces uniform in the disc of radius ``PUSH``, torques uniform up to a push's."""
    size, angle = PUSH * np.sqrt(rng.random(count)), 2.0 * math.pi * rng.random(count)
    torque = PUSH * gyration * rng.uniform(-1.0, 1.0, count)
    return np.column_stack([size * np.cos(angle), size * np.sin(angle), torque])


def shake(scene: Scene, qpos: FloatArray, rng: np.random.Generator) -> Shake:
    """Lock the hand at qpos (6,), push the object and shake it."""
    sigma = float(scene.sigma(qpos[None, :])[0])
    model = rigid_model(scene, sigma)
    trial = _Trial(scene, sigma, model, np.array(qpos[3:]))
    gyration = math.sqrt(scene.object.gyration_squared)
    done: list[Push] = []
    with no_log():
        for wrench in pushes(gyration):
            shift, turn = trial.moved(wrench[None, :], PUSH_TIME)
            x, y, torque = wrench.tolist()
            done.append(Push((x, y), torque, shift, turn))
        shift, turn = trial.moved(random_wrenches(rng, SHAKES, gyration), SHAKE_TIME)
    return Shake(tuple(done), shift, turn, trial.deepest, trial.diverged)


class _Trial:
    """One object in one rigid hand."""

    def __init__(self, scene: Scene, sigma: float, model: MjModel, rest: FloatArray) -> None:
        self._scene, self._sigma, self._model, self._rest = scene, sigma, model, rest
        self.deepest, self.diverged = 0.0, False

    def moved(self, wrenches: FloatArray, time: float) -> tuple[float, float]:
        """Farthest shift and turn while each wrench (m, 3) acts for a time, from rest at first."""
        data: MjData = rigid_data(self._model, self._rest)
        shift = turn = 0.0
        for wrench in wrenches:
            data.qfrc_applied[:] = self._scene.config.drive_force * wrench
            for step in range(math.ceil(time / self._scene.config.time_step)):
                mj.mj_step(self._model, data)
                off = np.array(data.qpos) - self._rest
                if data.warning.number.any() or not np.isfinite(off).all():
                    self.diverged = True
                    return shift, turn
                shift = max(shift, math.hypot(off[0], off[1]))
                turn = max(turn, abs(float(off[2])))
                if step % _LOOK == 0:
                    depth = disc_depths(self._scene, self._sigma, np.array(data.qpos))
                    self.deepest = max(self.deepest, float(depth.max()))
        return shift, turn
