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
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple, Protocol

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.world.engine import MjModel, mj, no_log
from sim.world.hand_in_object import depths, fingers_seen, hull_of, separated
from sim.world.held_hand import held_batch
from sim.world.machine_loops import counting
from sim.world.scene import Scene


class AttackCode(IntEnum):
    """How an attack ended."""

    RUNNING = 0
    ESCAPED = 1
    HELD = 2
    DIVERGED = 3


RUNNING, ESCAPED, HELD, DIVERGED = AttackCode

ATTACK_ENDINGS = tuple(code.name.lower() for code in AttackCode)
"""The words for the codes, in their order: those of files and reports."""

_RUNNING = int(RUNNING)
"""Numpy looks for six special methods of an enum at every comparison, and of a number for none."""

_DEPTH_MAX, _RISE_MAX = range(2)
"""Columns of what is seen."""


class _Shape(NamedTuple):
    """The object's outline (n, 2), its hull (h, 2) and the fingers, all in diameters."""

    vertices: FloatArray
    hull: FloatArray
    radius: float
    directions: FloatArray
    coefficients: FloatArray


class _Record(NamedTuple):
    """What is updated, a row each for N attacks; ``openings`` (N,) is read only."""

    openings: FloatArray
    seen: FloatArray
    steps: IntArray
    ending: IntArray


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


@dataclass(frozen=True, slots=True)
class AttackMonitor:
    """The running record of N attacks on one scene, a row each; updated in place.

    Attributes
    ----------
    openings:
        (N,) [diameter] where the stop is.
    steps, ending:
        (N,) integers; ``ending`` is a code into ``ATTACK_ENDINGS``.
    """

    scene: Scene
    openings: FloatArray
    steps: IntArray
    ending: IntArray
    _hull: FloatArray
    _seen: FloatArray
    _told: tuple[_Shape, _Record, float] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # what the compiled loop reads and updates is the same at every look: gathered once
        scene, kinematics = self.scene, self.scene.kinematics
        shape = _Shape(
            scene.object.vertices,
            self._hull,
            scene.finger_radius / scene.object.diameter,
            kinematics.directions,
            kinematics.tendon_coefficients,
        )
        record = _Record(self.openings, self._seen, self.steps, self.ending)
        object.__setattr__(self, "_told", (shape, record, SHUT / kinematics.longest_side))

    @classmethod
    def over(cls, scene: Scene, openings: FloatArray) -> AttackMonitor:
        """Start watching attacks at openings (N,) [diameter]."""
        count = len(openings)
        return cls(
            scene,
            np.array(openings),
            steps=np.zeros(count, dtype=np.int64),
            ending=np.full(count, RUNNING, dtype=np.int64),
            _hull=hull_of(scene.object.vertices),
            _seen=np.zeros((count, 2)),
        )

    def look(self, ids: IntArray, step: int, qpos: FloatArray, qvel: FloatArray) -> None:
        """Look at the attacks ``ids`` after step number ``step``; qpos and qvel are (N, 6)."""
        look: Callable[..., None] = _look
        look(ids, qpos, qvel, *self._told, step % LOOK_EVERY == 0)

    @property
    def running(self) -> IntArray:
        """Ids of the attacks that have not ended."""
        return np.flatnonzero(self.ending == _RUNNING)

    def attacks(self, end: FloatArray) -> Attacks:
        """What became of them, at ``end`` (N, 6); those still running are held."""
        self.ending[self.running] = HELD
        return Attacks(
            self.openings,
            self.ending,
            self.steps,
            penetration_max=self._seen[:, _DEPTH_MAX],
            rise_max=self._seen[:, _RISE_MAX],
            end=end,
        )


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
    lookout = AttackMonitor.over(scene, openings)
    ending = lookout.ending
    batch = held_batch(model, starts, openings, threads)
    positions, velocities = batch.bind("qpos"), batch.bind("qvel")
    applied, control = batch.bind("qfrc_applied"), batch.bind("ctrl")
    wrench, motor = np.zeros((count, 3)), np.zeros(count)
    running = lookout.running
    with no_log():
        for step in range(driver.max_steps):
            given_up = driver.drive(running, step, positions, wrench, motor)
            applied[:, 3:6] = wrench
            control[:, 0] = motor
            try:
                batch.step(None if len(running) == count else running.astype(np.int32))
            except mj.batch.SimulationError as error:
                ending[error.ids] = DIVERGED
            lookout.look(running, step, positions, velocities)
            if step % LOOK_EVERY == 0:
                warned = batch.warning[running, :, 1].any(axis=1)
                ending[running[warned]] = DIVERGED
            if len(given_up):
                ending[given_up[ending[given_up] == _RUNNING]] = HELD
            running = lookout.running
            if not len(running):
                break
    return lookout.attacks(np.array(positions, copy=True))


@counting
def _look(
    ids: IntArray,
    qpos: FloatArray,
    qvel: FloatArray,
    shape: _Shape,
    record: _Record,
    shut_sigma: float,
    thorough: bool,
) -> None:  # pragma: no cover - compiled
    seen, ending = record.seen, record.ending
    fingers, depth = np.empty((3, 2)), np.empty(3)
    for i in ids:
        record.steps[i] += 1
        fingers_seen(shape.directions, qpos[i], fingers)
        sigma, total = 0.0, 0.0
        for k in range(3):
            sigma += shape.coefficients[k] * qpos[i, k]
        for k in range(6):
            total += abs(qvel[i, k]) + abs(qpos[i, k])
        if not math.isfinite(total):
            ending[i] = DIVERGED
            continue
        depths(shape.vertices, fingers, shape.radius, depth)
        seen[i, _DEPTH_MAX] = max(seen[i, _DEPTH_MAX], depth[0], depth[1], depth[2])
        seen[i, _RISE_MAX] = max(seen[i, _RISE_MAX], sigma / record.openings[i])
        if sigma < shut_sigma or (thorough and separated(shape.hull, fingers, shape.radius)):
            ending[i] = ESCAPED
