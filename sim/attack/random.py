"""Random wrenches and impulses on the object, the hand pushed open against its stop or wandering.

Gentle on purpose: the object moves at force / damping, and a finger sinks in by about speed times
the time step when it hits. Faster attacks measure their own penetration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.world.scene import Scene

PUSH = 1.003
"""[1] A hand held open wants this much more than its stop allows: enough force, little speed."""


@dataclass(frozen=True, slots=True)
class RandomPull:
    """How a random attack pulls: as speeds, which the dampers of ``SimConfig`` turn into forces."""

    speed: float = 0.5
    """[diameter / s] The free object's, under the largest force."""

    turn: float = 0.15
    """[diameter] Largest torque over the largest force: the rim about as fast as the middle."""

    piece: float = 0.3
    """[s] A wrench is constant this long: a way of up to 0.15 diameters."""

    duration: float = 15.0
    """[s] Of one attack."""

    kick_share: float = 0.3
    """[1] Share of the pieces that begin with an impulse."""

    kick: float = 1.5
    """[1] The wrench is this many times stronger during an impulse."""

    kick_time: float = 0.01
    """[s] Length of an impulse: as long as the object remembers its speed."""

    wander_share: float = 0.3
    """[1] Share of the pieces in which the hand moves to some smaller opening."""

    wander_least: float = 0.7
    """[1] Smallest opening it then moves to, over the largest."""

    rate: float = 8.0
    """[1 / s] Of the hand on the way to it."""

    grip: float = 0.1
    """[diameter / s] Its speed at most, root sum square of the fingers."""


@dataclass(frozen=True, slots=True, eq=False)
class RandomDriver:
    """N attacks, each with its own random numbers, whoever its neighbours are."""

    scene: Scene
    openings: FloatArray
    rng: np.random.Generator
    pull: RandomPull = RandomPull()
    _wrench: FloatArray = field(init=False, repr=False)
    _kicked: FloatArray = field(init=False, repr=False)
    _target: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        pull, count = self.pull, len(self.openings)
        force = pull.speed * self.scene.config.object_damping
        pieces = math.ceil(pull.duration / pull.piece)
        wrench = np.empty((count, pieces, 3))
        kicked = np.empty((count, pieces))
        target = np.empty((count, pieces))
        for i, own in enumerate(self.rng.spawn(count)):
            way = own.uniform(0.0, 2.0 * np.pi, pieces)
            size = force * np.sqrt(own.uniform(0.0, 1.0, pieces))
            wrench[i, :, 0], wrench[i, :, 1] = size * np.cos(way), size * np.sin(way)
            wrench[i, :, 2] = force * pull.turn * own.uniform(-1.0, 1.0, pieces)
            kicked[i] = np.where(own.random(pieces) < pull.kick_share, pull.kick, 1.0)
            smaller = own.uniform(pull.wander_least, 1.0, pieces)
            target[i] = np.where(own.random(pieces) < pull.wander_share, smaller, PUSH)
        object.__setattr__(self, "_wrench", wrench)
        object.__setattr__(self, "_kicked", kicked)
        object.__setattr__(self, "_target", target * self.openings[:, None])

    @property
    def max_steps(self) -> int:
        """[step] Length of an attack."""
        return math.ceil(self.pull.duration / self.scene.config.time_step)

    def drive(
        self, ids: IntArray, step: int, qpos: FloatArray, wrench: FloatArray, motor: FloatArray
    ) -> IntArray:
        """The wrench of the piece; the motor towards the opening wanted, or against the stop."""
        time = step * self.scene.config.time_step
        piece = min(int(time / self.pull.piece), self._wrench.shape[1] - 1)
        begun = time - piece * self.pull.piece
        wrench[ids] = self._wrench[ids, piece]
        if begun < self.pull.kick_time:
            wrench[ids] *= self._kicked[ids, piece, None]
        motor[ids] = opening_force(
            self.scene, self._target[ids, piece], qpos[ids], self.pull.rate, self.pull.grip
        )
        return ids[:0]


def opening_force(
    scene: Scene, sigma: FloatArray, qpos: FloatArray, rate: float, speed: float
) -> FloatArray:
    """Motor control (N,) that brings the free hand to sigma (N,).

    ``rate`` [1 / s] of its approach, ``speed`` [diameter / s] at most, root sum square of fingers.
    """
    spread, damping = scene.kinematics.spread, scene.config.finger_damping
    limit = speed * damping * spread
    wanted = rate * damping * spread * spread * (sigma - scene.sigma(qpos))
    return np.minimum(np.maximum(wanted, -limit), limit)
