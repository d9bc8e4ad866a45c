"""What is seen after every step of every closing: depth, shape, size, stillness.

The penetration is measured here, from the poses and the true outline, and not taken from the
engine's contacts: a contact the engine missed would not be missed here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from icage.arrays import FloatArray, IntArray
from sim.world.hand_in_object import depths, fingers_seen
from sim.world.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable


class EndingCode(IntEnum):
    """How a closing ended, before anybody asks where. A pinched hand has shut on nothing."""

    RUNNING = 0
    SETTLED = 1
    PINCHED = 2
    TIMED_OUT = 3
    DIVERGED = 4


RUNNING, SETTLED, PINCHED, TIMED_OUT, DIVERGED = EndingCode

_RUNNING = int(RUNNING)
"""Numpy looks for six special methods of an enum at every comparison, and of a number for none."""

ENDINGS = tuple(code.name.lower() for code in EndingCode)
"""The words for the codes, in their order: those of files and reports."""

TOUCHING = 1e-6
"""[diameter] A finger this close to the outline touches it: ten times the resolution of the
engine's meshes, a thousandth of what a step moves."""

PART, PARTS = 0.5, 3
"""[1] A tail is exponential if this many parts in a row, in each of which the logarithm of the
speed falls by ``PART``, ..."""

AGREE = 0.01
"""[1] ... fall at rates that differ by less than this. A second motion hidden under the first (a
slower tail, a body that leaves an unstable balance) then has less than a thirtieth of the speed;
what swings, turns back or creeps falls faster and faster, or not at all."""

_SLOW = 1e-3
"""[diameter / s, rad / s] Faster than this nothing is called rest."""

_SLOWEST, _FASTEST = 5e-5, 0.05
"""[1 / step] Rates of tails that are foreseen. A faster one is a contact's own: it is waited for,
since it is over soon and the depth at rest is measured."""

(_DEPTH_MAX, _DEPTH, _SHAPE_MAX, _RISE_MAX, _SIGMA_START, _TOUCHES) = range(6)
_FIELDS = 6

(_SPEED, _PART_SPEED, _PART_STEP, _RATE, _GOOD) = range(5)
_TAIL_FIELDS = 5


class _Shape(NamedTuple):
    """The object's outline (n, 2) and the fingers of the hand, all in diameters."""

    vertices: FloatArray
    radius: float
    directions: FloatArray
    lengths: FloatArray
    coefficients: FloatArray


class _Bounds(NamedTuple):
    """When a closing has ended; ``stride`` [step] is the time between two looks, ``step``
    [s] one step.
    """

    pinched_sigma: float
    still_speed: float
    still_steps: int
    stride: int
    step: float


class _Record(NamedTuple):
    """What is updated, a row each for N closings; ``max_steps``, ``remains`` (N,) are read only.

    ``tail`` (N, 5) is the last speed; speed and step at which the present part of the tail began;
    the rate of the part before and how many in a row had it.
    """

    max_steps: IntArray
    remains: FloatArray
    tail: FloatArray
    seen: FloatArray
    still: IntArray
    steps: IntArray
    ending: IntArray


@njit(cache=True)
def _fades(
    i: int, speed: float, bounds: _Bounds, record: _Record
) -> bool:  # pragma: no cover - compiled
    """Whether the speed falls exponentially and what is left of the way is short enough."""
    tail, now = record.tail[i], record.steps[i]
    before = tail[_SPEED]
    tail[_SPEED] = speed
    if not 0.0 < speed < before or record.seen[i, _TOUCHES] < 3:
        tail[_PART_SPEED], tail[_PART_STEP], tail[_RATE], tail[_GOOD] = speed, now, 0.0, 0
        return False
    loss, steps = math.log(tail[_PART_SPEED] / speed), now - tail[_PART_STEP]
    if loss >= PART:
        rate, last = loss / steps, tail[_RATE]
        tail[_GOOD] = tail[_GOOD] + 1 if abs(rate - last) <= AGREE * last else 1
        tail[_PART_SPEED], tail[_PART_STEP], tail[_RATE] = speed, now, rate
        loss, steps = 0.0, 0.0
    rate = tail[_RATE]
    if tail[_GOOD] < PARTS or abs(loss - rate * steps) > AGREE * PART:
        return False
    if speed >= _SLOW or not _SLOWEST < rate < _FASTEST:
        return False
    return speed * bounds.step / rate <= record.remains[i]


@njit(cache=True)
def _observe(
    ids: IntArray,
    qpos: FloatArray,
    qvel: FloatArray,
    shape: _Shape,
    bounds: _Bounds,
    record: _Record,
) -> None:  # pragma: no cover - compiled
    lengths, coefficients = shape.lengths, shape.coefficients
    seen, still, steps, ending = record.seen, record.still, record.steps, record.ending
    fingers = np.empty((3, 2))
    depth = np.empty(3)
    for i in ids:
        steps[i] += bounds.stride
        fingers_seen(shape.directions, qpos[i], fingers)
        sigma = 0.0
        for k in range(3):
            sigma += coefficients[k] * qpos[i, k]
        off = 0.0
        for k in range(3):
            off = max(off, abs(qpos[i, k] - lengths[k] * sigma))
        depths(shape.vertices, fingers, shape.radius, depth)
        deepest = max(depth[0], depth[1], depth[2])
        touches = 0
        for k in range(3):
            if depth[k] > -TOUCHING:
                touches += 1
        speed = 0.0
        for k in range(6):
            speed = max(speed, abs(qvel[i, k]))
        seen[i, _DEPTH] = max(deepest, 0.0)
        seen[i, _DEPTH_MAX] = max(seen[i, _DEPTH_MAX], deepest)
        seen[i, _SHAPE_MAX] = max(seen[i, _SHAPE_MAX], off)
        seen[i, _RISE_MAX] = max(seen[i, _RISE_MAX], sigma / seen[i, _SIGMA_START])
        seen[i, _TOUCHES] = touches
        fades = record.remains[i] > 0.0 and _fades(i, speed, bounds, record)
        still[i] = still[i] + bounds.stride if speed < bounds.still_speed and touches >= 2 else 0
        if not (math.isfinite(speed) and math.isfinite(sigma) and math.isfinite(deepest)):
            ending[i] = DIVERGED
        elif sigma < bounds.pinched_sigma:
            ending[i] = PINCHED
        elif still[i] >= bounds.still_steps or fades:
            ending[i] = SETTLED
        elif steps[i] >= record.max_steps[i]:
            ending[i] = TIMED_OUT


@dataclass(frozen=True, slots=True)
class StepCheck:
    """The running record of N closings of one scene, a row each; updated in place.

    Attributes
    ----------
    steps, ending:
        (N,) integers; ``ending`` is a code into ``ENDINGS``.
    stride:
        [step] Between two looks.
    """

    scene: Scene
    steps: IntArray
    ending: IntArray
    stride: int
    _max_steps: IntArray
    _remains: FloatArray
    _tail: FloatArray
    _still: IntArray
    _seen: FloatArray
    _told: tuple[_Shape, _Bounds, _Record] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # what the compiled loop reads and updates is the same at every look: gathered once
        scene, config, kinematics = self.scene, self.scene.config, self.scene.kinematics
        shape = _Shape(
            scene.object.vertices,
            scene.finger_radius / scene.object.diameter,
            kinematics.directions,
            kinematics.lengths,
            kinematics.tendon_coefficients,
        )
        bounds = _Bounds(
            config.pinched_size / kinematics.longest_side,
            config.still_speed,
            config.still_steps,
            self.stride,
            config.time_step,
        )
        record = _Record(
            self._max_steps, self._remains, self._tail, self._seen, self._still, self.steps,
            self.ending,
        )  # fmt: skip
        object.__setattr__(self, "_told", (shape, bounds, record))

    @classmethod
    def over(
        cls,
        scene: Scene,
        qpos: FloatArray,
        stride: int = 1,
        patience: FloatArray | None = None,
        remains: FloatArray | None = None,
    ) -> StepCheck:
        """Start watching closings that start from qpos (N, 6), every ``stride`` steps.

        ``patience`` (N,) multiplies the scene's time until a closing
        has timed out. ``remains`` (N,) stands for the scene's own; 0 where anything but the motor
        and the dampers acts, or in another engine.
        """
        count = len(qpos)
        longer = np.ones(count) if patience is None else patience
        seen = np.zeros((count, _FIELDS))
        seen[:, _SIGMA_START] = scene.sigma(qpos)
        rest = scene.config.remains if scene.config.friction == 0.0 else 0.0
        return cls(
            scene,
            steps=np.zeros(count, dtype=np.int64),
            ending=np.full(count, RUNNING, dtype=np.int64),
            stride=stride,
            _max_steps=np.ceil(scene.config.max_steps * longer).astype(np.int64),
            _remains=np.full(count, rest) if remains is None else remains,
            _tail=np.zeros((count, _TAIL_FIELDS)),
            _still=np.zeros(count, dtype=np.int64),
            _seen=seen,
        )

    def observe(self, ids: IntArray, qpos: FloatArray, qvel: FloatArray) -> None:
        """Look at the closings ``ids`` after ``stride`` more steps; qpos and qvel are (N, 6)."""
        observe: Callable[..., None] = _observe
        observe(ids, qpos, qvel, *self._told)

    def diverged(self, ids: IntArray) -> None:
        """Note that the engine gave up on, or warned about, these closings."""
        self.ending[ids] = DIVERGED

    @property
    def running(self) -> IntArray:
        """Ids of the closings that have not ended."""
        return np.flatnonzero(self.ending == _RUNNING)

    @property
    def touches(self) -> FloatArray:
        """(N,) fingers that touched the outline at the last look."""
        return self._seen[:, _TOUCHES]

    @property
    def penetration_max(self) -> FloatArray:
        """[diameter] (N,) deepest disc over all steps."""
        return self._seen[:, _DEPTH_MAX]

    @property
    def penetration_rest(self) -> FloatArray:
        """[diameter] (N,) deepest disc after the last step."""
        return self._seen[:, _DEPTH]

    @property
    def shape_error_max(self) -> FloatArray:
        """[diameter] (N,) farthest a finger was from its place in the similar triangle."""
        return self._seen[:, _SHAPE_MAX]

    @property
    def sigma_rise_max(self) -> FloatArray:
        """[1] (N,) largest sigma / sigma at the start over all steps: above 1 the hand opened."""
        return self._seen[:, _RISE_MAX]
