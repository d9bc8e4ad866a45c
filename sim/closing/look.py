"""One look at one closing: how deep each disc is, the hand's shape and size, whether it is at rest.

Compiled loops and the tuples they read. The penetration is measured here, from the poses and the
true outline, and not taken from the engine's contacts: a contact the engine missed would not be
missed here.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.closing.near_edges import NearEdges, depth_near
from sim.world.hand_in_object import fingers_seen
from sim.world.machine_loops import borrowing, inlined


class EndingCode(IntEnum):
    """How a closing ended, before anybody asks where. A pinched hand has shut on nothing."""

    RUNNING = 0
    SETTLED = 1
    PINCHED = 2
    TIMED_OUT = 3
    DIVERGED = 4


RUNNING, SETTLED, PINCHED, TIMED_OUT, DIVERGED = EndingCode

ENDINGS = tuple(code.name.lower() for code in EndingCode)
"""The words for the codes, in their order: those of files and reports."""

TOUCHING = 1e-6
"""[diameter] A finger this close to the outline touches it: ten times the resolution of the
engine's meshes, a thousandth of what a step moves."""

PART, PARTS = 0.5, 3
"""[1] A tail is exponential if this many parts in a row, in each of which the logarithm of the
speed falls by ``PART``, ..."""

_WITHIN_PART = 0.999 * math.exp(PART)
"""[1] A fall of the speed by less has not gone through a part for certain, whatever the
rounding."""

AGREE = 0.01
"""[1] ... fall at rates that differ by less than this. A second motion hidden under the first (a
slower tail, a body that leaves an unstable balance) then has less than a thirtieth of the speed;
what swings, turns back or creeps falls faster and faster, or not at all."""

_SLOW = 1e-3
"""[diameter / s, rad / s] Faster than this nothing is called rest."""

_SLOWEST, _FASTEST = 5e-5, 0.05
"""[1 / step] Rates of tails that are foreseen. A faster one is a contact's own: it is waited for,
since it is over soon and the depth at rest is measured."""

(DEPTH_MAX, DEPTH, SHAPE_MAX, RISE_MAX, SIGMA_START, TOUCHES) = range(6)
FIELDS = 6

(_SPEED, _PART_SPEED, _PART_STEP, _RATE, _GOOD) = range(5)
TAIL_FIELDS = 5


class Shape(NamedTuple):
    """The object's outline (n, 2) and the fingers of the hand, all in diameters; ``near`` is a grid
    of its edges, filled as it goes.
    """

    vertices: FloatArray
    near: NearEdges
    radius: float
    directions: FloatArray
    lengths: FloatArray
    coefficients: FloatArray


class Bounds(NamedTuple):
    """When a closing has ended; ``stride`` [step] is the time between two looks, ``step``
    [s] one step.
    """

    pinched_sigma: float
    still_speed: float
    still_steps: int
    stride: int
    step: float


class Record(NamedTuple):
    """What is updated, a row each for N closings; ``max_steps``, ``remains`` (N,) are read only.

    ``tail`` (N, 5) is the last speed; speed and step at which the present part of the tail began;
    the rate of the part before and how many in a row had it. ``apart`` (N, 3, 3) says where each
    finger stood in the object's axes when its depth was last measured, and how far from there it
    touches nothing for certain: until it has come so far, there is nothing to measure.
    """

    max_steps: IntArray
    remains: FloatArray
    tail: FloatArray
    apart: FloatArray
    seen: FloatArray
    still: IntArray
    steps: IntArray
    ending: IntArray


@inlined
def _fades(
    i: int, speed: float, bounds: Bounds, record: Record
) -> bool:  # pragma: no cover - compiled
    """Whether the speed falls exponentially and what is left of the way is short enough."""
    tail, now = record.tail[i], record.steps[i]
    before = tail[_SPEED]
    tail[_SPEED] = speed
    if not 0.0 < speed < before or record.seen[i, TOUCHES] < 3:
        tail[_PART_SPEED], tail[_PART_STEP], tail[_RATE], tail[_GOOD] = speed, now, 0.0, 0
        return False
    fall, steps = tail[_PART_SPEED] / speed, now - tail[_PART_STEP]
    if fall < _WITHIN_PART and (tail[_GOOD] < PARTS or speed >= _SLOW):
        return False  # whatever the logarithm is
    loss = math.log(fall)
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


@inlined
def _measure(
    i: int,
    vertices: FloatArray,
    near: NearEdges,
    fingers: FloatArray,
    radius: float,
    apart: FloatArray,
    depth: FloatArray,
) -> None:  # pragma: no cover - compiled
    """depth[k] = how deep finger k is; of one that touches nothing, a number below -``TOUCHING``.

    Nothing but that is asked of it, and most fingers are on their way for most of a closing.
    """
    for k in range(fingers.shape[0]):
        x, y = fingers[k, 0], fingers[k, 1]
        u, v, room = x - apart[i, k, 0], y - apart[i, k, 1], apart[i, k, 2]
        if room > 0.0 and u * u + v * v < room * room:
            depth[k] = -2.0 * TOUCHING
        else:
            depth[k] = depth_near(vertices, x, y, radius, near)
            apart[i, k, 0], apart[i, k, 1] = x, y
            apart[i, k, 2] = -depth[k] - 2.0 * TOUCHING


@inlined
def look_at(
    i: int,
    qpos: FloatArray,
    qvel: FloatArray,
    fingers: FloatArray,
    depth: FloatArray,
    shape: Shape,
    bounds: Bounds,
    record: Record,
) -> bool:  # pragma: no cover - compiled
    """Look at closing i at ``qpos``, ``qvel`` (6,); whether it goes on.

    ``fingers`` (3, 2) are in the object's axes, ``depth`` (3,) is to compute in.
    """
    lengths, coefficients = shape.lengths, shape.coefficients
    seen, still, steps, ending = record.seen, record.still, record.steps, record.ending
    steps[i] += bounds.stride
    sigma = 0.0
    for k in range(3):
        sigma += coefficients[k] * qpos[k]
    off = 0.0
    for k in range(3):
        off = max(off, abs(qpos[k] - lengths[k] * sigma))
    _measure(i, shape.vertices, shape.near, fingers, shape.radius, record.apart, depth)
    deepest = max(depth[0], depth[1], depth[2])
    touches = 0
    for k in range(3):
        if depth[k] > -TOUCHING:
            touches += 1
    speed = 0.0
    for k in range(6):
        speed = max(speed, abs(qvel[k]))
    seen[i, DEPTH] = max(deepest, 0.0)
    seen[i, DEPTH_MAX] = max(seen[i, DEPTH_MAX], deepest)
    seen[i, SHAPE_MAX] = max(seen[i, SHAPE_MAX], off)
    seen[i, RISE_MAX] = max(seen[i, RISE_MAX], sigma / seen[i, SIGMA_START])
    seen[i, TOUCHES] = touches
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
    return ending[i] == RUNNING


def observe(
    ids: IntArray,
    qpos: FloatArray,
    qvel: FloatArray,
    shape: Shape,
    bounds: Bounds,
    record: Record,
) -> IntArray:
    """Look at closings ``ids`` of N, qpos and qvel (N, 6); those of them that go on."""
    left = np.empty(len(ids), dtype=np.int64)
    room = np.empty((3, 2)), np.empty(3)
    count: int = _observe(ids, qpos, qvel, shape, bounds, record, *room, left)
    return left[:count]


@borrowing
def _observe(
    ids: IntArray,
    qpos: FloatArray,
    qvel: FloatArray,
    shape: Shape,
    bounds: Bounds,
    record: Record,
    fingers: FloatArray,
    depth: FloatArray,
    left: IntArray,
) -> int:  # pragma: no cover - compiled
    count = 0
    for i in ids:
        fingers_seen(shape.directions, qpos[i], fingers)
        if look_at(i, qpos[i], qvel[i], fingers, depth, shape, bounds, record):
            left[count] = i
            count += 1
    return count
