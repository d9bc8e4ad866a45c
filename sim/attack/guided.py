"""The object led along a given path of the hand, by springs weak enough to obey the fingers.

The path is the plan's own claim of a way out. Its rows are inverted to poses of the object in the
palm's frame; a carrot runs along them and the object follows it, with a little random force on top.
If the carrot cannot advance any more it goes back a little and comes again, slowly; if it is stuck
after that too, the object is held.

The hand lags behind the carrot, so at a narrow pass it begins to close before it was open as far as
its stop lets it, and a random push then decides on which side of the pass the object is wedged. A
carrot that comes slowly finds the hand open.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.attack.random import PUSH
from sim.world.machine_loops import counting
from sim.world.scene import Scene

FINE = 2e-3
"""[diameter] Spacing of the points of a path."""

TURN_LENGTH = 0.5
"""[diameter / rad] A turn by one radian counts as a way of this length."""

_NO_SIZE = 1e-9
"""[diameter] A hand smaller than this has no direction."""

_AT_STOP = 1e-3
"""[1] The opening wanted is kept this much (relative) beyond the stop, and from as much before it
the hand is pressed against it."""


class _Spring(NamedTuple):
    """What leads the object: a spring, its largest force, and how far the carrot waits.

    ``spin`` [diameter^2] is the object's radius of gyration squared, ``slow`` [1] the pace of a
    carrot that comes again.
    """

    lag: float
    stiffness: float
    force: float
    spin: float
    slow: float


class _Carrots(NamedTuple):
    """Where the carrots of N attacks are, a row each; updated but for the pace."""

    pace: FloatArray
    at: FloatArray
    waited: FloatArray
    back_to: FloatArray
    slow_to: FloatArray


class _Hand(NamedTuple):
    """What opens the hand: as ``sim.attack.random.opening_force``, towards the carrot's sigma.

    ``rate`` and ``limit`` are of the motor's control, ``widest`` [diameter] is the path's largest
    sigma, ``openings`` (N,) [diameter] where the stop is, ``jitter`` (N, pieces, 3) the random
    forces on the object.
    """

    rate: float
    limit: float
    widest: float
    tendon: FloatArray
    openings: FloatArray
    jitter: FloatArray


@dataclass(frozen=True, slots=True)
class GuidedPull:
    """How the object is led: as speeds, which the dampers of ``SimConfig`` turn into forces."""

    pace: float = 0.25
    """[diameter / s] Of the carrot, at most."""

    rate: float = 40.0
    """[1 / s] Of the leading spring: the object lags 25 ms behind."""

    speed: float = 0.5
    """[diameter / s] Of the object, at most."""

    grip: float = 0.25
    """[diameter / s] Of the hand, at most, root sum square of the fingers."""

    grip_rate: float = 13.0
    """[1 / s] Of the hand on the way to the opening wanted."""

    lag: float = 0.012
    """[diameter] The carrot waits while the object is farther away than this, twice its usual lag.
    With 0.03 it ran ahead round a sharp corner of the way out and pulled the object into the wall:
    3 of 24 came out of the equilateral triangle at 1.002 sigma_max, with this all."""

    patience: float = 0.6
    """[s] A carrot that has not moved for so long is stuck."""

    retries: int = 2
    """Times that a stuck carrot goes back and comes again, in one attack; then the object is held.
    Without, 16 of 200 did not come out of ``Z_twofold_multi`` at 1.002 sigma_max."""

    back: float = 0.03
    """[diameter] How far it goes back at first, more than the object and the hand lag; and as far
    beyond where it was stuck it comes slowly. Twice that the next time."""

    slow: float = 0.25
    """[1] Its pace when it comes again."""

    jitter: float = 0.1
    """[diameter / s] That the largest random force gives, new every ``jitter_time`` seconds."""

    jitter_time: float = 0.1
    """[s]"""

    max_time: float = 60.0
    """[s] Bound on one attack."""


def object_path(scene: Scene, hand_path: FloatArray) -> FloatArray:
    """Way points (p, 5) = object's x, y, turn in P, sigma, length so far; all in diameters, rad.

    ``hand_path`` (k, 4) = x, y, theta, sigma of the hand in B. Between its rows d and
    w = sigma e^{i theta} change linearly (cells are convex in them), so theta does not.
    """
    rows = np.asarray(hand_path, dtype=np.float64)
    d = rows[:, 0] + 1j * rows[:, 1]
    w = rows[:, 3] * np.exp(1j * rows[:, 2])
    size = scene.object.diameter
    parts: list[FloatArray] = []
    for k in range(len(rows) - 1):
        side = (abs(d[k + 1] - d[k]) + abs(w[k + 1] - w[k])) / size
        turn = abs(np.angle(w[k + 1] * np.conj(w[k]))) if w[k + 1] and w[k] else 0.0
        steps = max(1, math.ceil((side + turn) / FINE))
        share = np.arange(steps + (k == len(rows) - 2)) / steps
        here = d[k] + share * (d[k + 1] - d[k])
        wide = w[k] + share * (w[k + 1] - w[k])
        parts.append(np.column_stack([here.real, here.imag, np.angle(wide), np.abs(wide)]))
    fine = np.concatenate(parts)
    shut = fine[:, 3] < _NO_SIZE * size
    if shut.any():  # a shut hand has no direction: it keeps its last one
        last = int(np.flatnonzero(~shut)[-1])
        fine[last + 1 :, 2] = fine[last, 2]
    fine[:, 2] = np.unwrap(fine[:, 2])
    qpos = scene.start_positions(fine)
    way = np.column_stack([qpos[:, 3:6], fine[:, 3] / size])
    step = np.diff(way, axis=0) * [1.0, 1.0, TURN_LENGTH, 1.0]
    length = np.concatenate([[0.0], np.cumsum(np.hypot.reduce(step, axis=1))])
    return np.column_stack([way, length])


@dataclass(frozen=True, slots=True, eq=False)
class GuidedDriver:
    """N attacks along one path (p, 5) of ``object_path``; randomness from ``rng``.

    Where the stop allows more than the path's largest sigma, the whole path is opened in that
    ratio about the palm's centre; where it allows less, the path's sigma is cut at the stop.
    """

    scene: Scene
    openings: FloatArray
    path: FloatArray
    rng: np.random.Generator
    pull: GuidedPull = GuidedPull()
    _jitter: FloatArray = field(init=False, repr=False)
    _pace: FloatArray = field(init=False, repr=False)
    _at: FloatArray = field(init=False, repr=False)
    _waited: FloatArray = field(init=False, repr=False)
    _tries: IntArray = field(init=False, repr=False)
    _back_to: FloatArray = field(init=False, repr=False)
    _slow_to: FloatArray = field(init=False, repr=False)
    _told: tuple[FloatArray, float, _Spring, _Carrots, _Hand] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        count, pull = len(self.openings), self.pull
        pieces = math.ceil(pull.max_time / pull.jitter_time)
        jitter, pace = np.empty((count, pieces, 3)), np.empty(count)
        push = pull.jitter * self.scene.config.object_damping
        for i, own in enumerate(self.rng.spawn(count)):
            pace[i] = pull.pace * own.uniform(0.6, 1.0)
            jitter[i] = push * own.uniform(-1.0, 1.0, (pieces, 3)) * [1.0, 1.0, 0.3]
        object.__setattr__(self, "_jitter", jitter)
        object.__setattr__(self, "_pace", pace)
        object.__setattr__(self, "_at", np.zeros(count))
        object.__setattr__(self, "_waited", np.zeros(count))
        object.__setattr__(self, "_tries", np.zeros(count, dtype=np.int64))
        object.__setattr__(self, "_back_to", np.full(count, np.inf))
        object.__setattr__(self, "_slow_to", np.zeros(count))
        object.__setattr__(self, "_told", self._gathered())

    def _gathered(self) -> tuple[FloatArray, float, _Spring, _Carrots, _Hand]:
        """What the compiled loop reads and updates: the same arrays at every step."""
        pull, scene = self.pull, self.scene
        damping, kinematics = scene.config.object_damping, scene.kinematics
        finger, spread = scene.config.finger_damping, kinematics.spread
        spring = _Spring(
            pull.lag,
            pull.rate * damping,
            pull.speed * damping,
            scene.object.gyration_squared,
            pull.slow,
        )
        carrots = _Carrots(self._pace, self._at, self._waited, self._back_to, self._slow_to)
        hand = _Hand(
            pull.grip_rate * finger * spread * spread,
            pull.grip * finger * spread,
            float(self.path[:, 3].max()),
            kinematics.tendon_coefficients,
            self.openings,
            self._jitter,
        )
        return self.path, scene.config.time_step, spring, carrots, hand

    @property
    def max_steps(self) -> int:
        """[step] Bound on one attack."""
        return math.ceil(self.pull.max_time / self.scene.config.time_step)

    def drive(
        self, ids: IntArray, step: int, qpos: FloatArray, wrench: FloatArray, motor: FloatArray
    ) -> IntArray:
        """Advance the carrots, pull the objects after them."""
        pull = self.pull
        piece = min(
            int(step * self.scene.config.time_step / pull.jitter_time), self._jitter.shape[1] - 1
        )
        lead: Callable[..., None] = _lead
        lead(ids, qpos, piece, *self._told, wrench, motor)
        stuck = ids[self._waited[ids] > pull.patience]
        return self._stuck(stuck) if len(stuck) else stuck

    def _stuck(self, ids: IntArray) -> IntArray:
        """Send stuck carrots back; returns those that were sent back too often already."""
        pull = self.pull
        again = ids[self._tries[ids] < pull.retries]
        way = pull.back * 2.0 ** self._tries[again]
        self._back_to[again] = np.maximum(self._at[again] - way, 0.0)
        self._slow_to[again] = np.maximum(self._slow_to[again], self._at[again] + way)
        self._waited[again] = 0.0
        held = ids[self._tries[ids] >= pull.retries]
        self._tries[again] += 1
        return held


@counting
def _lead(
    ids: IntArray,
    qpos: FloatArray,
    piece: int,
    path: FloatArray,
    dt: float,
    spring: _Spring,
    carrots: _Carrots,
    hand: _Hand,
    wrench: FloatArray,
    motor: FloatArray,
) -> None:  # pragma: no cover - compiled
    lag, stiffness, force, spin, slow = spring
    pace, at, waited, back_to, slow_to = carrots
    rate, limit, widest, tendon, openings, jitter = hand
    last = path.shape[0] - 1
    end = path[last, 4]
    most = force * math.sqrt(spin)
    for i in ids:
        k = min(max(np.searchsorted(path[:, 4], at[i], side="right") - 1, 0), last - 1)
        here, there = path[k], path[k + 1]
        span = there[4] - here[4]
        share = min((at[i] - here[4]) / span, 1.0) if span > 0.0 else 1.0
        ex = here[0] + share * (there[0] - here[0]) - qpos[i, 3]
        ey = here[1] + share * (there[1] - here[1]) - qpos[i, 4]
        turn = here[2] + share * (there[2] - here[2]) - qpos[i, 5]
        goal = here[3] + share * (there[3] - here[3])
        away = math.hypot(ex, ey)
        if at[i] > back_to[i]:  # on its way back it waits for nobody
            at[i] = max(at[i] - pace[i] * dt, back_to[i])
            if at[i] == back_to[i]:
                back_to[i] = np.inf
        elif away + TURN_LENGTH * abs(turn) < lag and at[i] < end:
            part = slow if at[i] < slow_to[i] else 1.0
            at[i] = min(at[i] + part * pace[i] * dt, end)
            waited[i] = 0.0
        else:
            waited[i] += dt
        cut = stiffness * min(1.0, force / (stiffness * away)) if away > 0.0 else 0.0
        wrench[i, 0], wrench[i, 1] = cut * ex, cut * ey
        wrench[i, 2] = min(max(stiffness * spin * turn, -most), most)
        wrench[i] += jitter[i, piece]
        stop, sigma = openings[i], 0.0
        wanted = goal * np.maximum(stop / widest, 1.0)
        if wanted >= stop * (1.0 - _AT_STOP):
            asked = stop * PUSH
        else:
            asked = np.minimum(wanted, stop * (1.0 + _AT_STOP))
        for j in range(len(tendon)):
            sigma += tendon[j] * qpos[i, j]
        motor[i] = np.minimum(np.maximum(rate * (asked - sigma), -limit), limit)
