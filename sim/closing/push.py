"""While the object is pushed about: the engine's own step, for discs on convex pieces, no more.

Three contacts at most push a polygon over a viscous table. The engine spends 5 to 8 us on
each of these steps, most of it on finding what is near what and on a solver for any number of
anything. Here the same step is written down for this one scene and costs a quarter: the same
contacts (disc against the compiled pieces), the same regularization, the same metric, the same
order of updates. It is the engine's map, not one of our own: positions agree to 1e-9 after hundreds
of steps (``tests/sim/closing/test_push.py``), every step is counted and looked at like any other,
and the engine goes on from where it ends. The engine's are all states that might be a grasp: more
than three contacts, and whatever is touched and slow. ``SimConfig.computed_contacts`` = 0 leaves
everything to it.

One step of the integrator ``discrete``, with M and D the diagonals of masses and dampings, h the
time step, W = M + h D, f the motor's pull, and rows J of the linkage and of the contacts:

    a = argmin  (a - a_0)' W (a - a_0) / 2  +  sum_i s_i (J_i a - r_i)^2 / 2,   W a_0 = f - D v
    v' = v + h a,   q' = q + h v'

A contact's term counts only while J_i a < r_i (it never pulls). With p_i the depth (negative) or
the linkage's error, d the impedance, K and B of the time constant and the damping ratio,

    r_i = -((B + h K d) J_i v + K d p_i) / (1 + h B + h^2 K d)
    s_i = d / (1 - d) / w_i,   w_i = w_0 (J W^-1 J') / (J M^-1 J')

and w_0 the compiled inverse weights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numba import njit

from icage.arrays import BoolArray, FloatArray, IntArray
from sim.closing.step_check import RUNNING, StepCheck
from sim.world.engine import MjModel, mj
from sim.world.hand_in_object import fingers_seen
from sim.world.scene import Scene

_STIFFEST: Final = 0.9999
"""The engine's bound on an impedance. Both ends of ours are at it or above: d is constant."""

_MOST: Final = 3
"""Contacts that one step may have here: a grasp of discs in corners has more."""

_SLOW: Final = 0.02
"""[free speed] An object that is touched and slower than this is the engine's: whether it is at
rest, or passes a balance, is not for us to say."""

_WILD: Final = 1e10
"""Positions, velocities or accelerations that large are left to the engine, which warns of them."""

_ROUNDS: Final = 8
"""Tries to find out which contacts press."""

_FLAT: Final = 1e-6
"""[diameter] Vertices of a piece nearer than this to the plane are its rim."""


class _Plant(NamedTuple):
    """The compiled scene in numbers; dof 0..2 are the fingers' slides, 3..5 the object."""

    step: float
    lighter: FloatArray
    metric: FloatArray
    softer: FloatArray
    damping: FloatArray
    pull: FloatArray
    directions: FloatArray
    radius: float
    links: FloatArray
    link_weight: FloatArray
    link_law: FloatArray
    contact_weight: FloatArray
    contact_law: FloatArray
    stiffness: float
    slow: float
    points: FloatArray
    first: IntArray
    middle: FloatArray
    reach: FloatArray


class _Room(NamedTuple):
    """Scratch of one step: rows (2 + _MOST, 6), what each is of, and the system of equations."""

    rows: FloatArray
    weight: FloatArray
    wanted: FloatArray
    finger: IntArray
    system: FloatArray
    right: FloatArray
    fingers: FloatArray
    force: FloatArray
    total: FloatArray


@dataclass(frozen=True, slots=True)
class Pushed:
    """Where the engine takes over, N closings.

    Attributes
    ----------
    positions, velocities, accelerations:
        (N, 6) of the last step computed.
    peak_force:
        (N,) [mass diameter / s^2] largest normal force on a finger at any look.
    """

    positions: FloatArray
    velocities: FloatArray
    accelerations: FloatArray
    peak_force: FloatArray


def push(
    scene: Scene, positions: FloatArray, check: StepCheck, rows: BoolArray | None = None
) -> Pushed:
    """Close from rest at positions (N, 6) while the object is pushed about.

    Steps are counted and looked at in ``check``, every ``check.stride``; what cannot be computed
    here (friction, a linkage that yields, trials outside ``rows``) is left to the engine as it is.
    """
    count = len(positions)
    still = np.zeros((2, count, 6))
    found = Pushed(np.array(positions), still[0], still[1], np.zeros(count))
    if not _known(scene) or not count:
        return found
    chosen = np.ones(count, dtype=np.bool_) if rows is None else rows
    plant, room, most = _plant(scene), _room(), scene.config.computed_contacts
    running = np.flatnonzero(chosen & np.isfinite(positions).all(axis=1))
    running = running[check.ending[running] == RUNNING]
    state = np.stack([found.positions, found.velocities, found.accelerations], axis=1)
    ahead = np.array(state)
    while len(running):
        went = np.zeros(count, dtype=np.bool_)
        _push(running, plant, room, most, check.stride, state, ahead, found.peak_force, went)
        running = running[went[running]]
        check.observe(running, state[:, 0], state[:, 1])
        running = running[check.ending[running] == RUNNING]
    for k, part in enumerate((found.positions, found.velocities, found.accelerations)):
        part[:] = state[:, k]
    return found


def _known(scene: Scene) -> bool:
    """Whether the step is the one written down here."""
    config = scene.config
    rigid = config.linkage_compliance == 0.0 and config.friction == 0.0
    return config.computed_contacts > 0 and rigid and min(config.solimp[:2]) >= _STIFFEST


@njit(cache=True)
def _push(
    ids: IntArray,
    plant: _Plant,
    room: _Room,
    most: int,
    stride: int,
    state: FloatArray,
    ahead: FloatArray,
    peak: FloatArray,
    went: BoolArray,
) -> None:  # pragma: no cover - compiled
    """``stride`` steps of each closing; one that cannot be gone all the way is not begun."""
    for i in ids:
        ahead[i] = state[i]
        went[i] = True
        for _ in range(stride):
            if not _step(plant, room, most, ahead[i]):
                went[i] = False
                break
        if went[i]:
            state[i] = ahead[i]
            peak[i] = max(peak[i], max(room.total[0], room.total[1], room.total[2]))


@njit(cache=True)
def _step(
    plant: _Plant, room: _Room, most: int, state: FloatArray
) -> bool:  # pragma: no cover - compiled
    """One step of state (3, 6) = positions, velocities, accelerations; False: not done."""
    qpos, qvel, qacc = state[0], state[1], state[2]
    count = _rows(plant, room, most, qpos, qvel)
    if count < 0:
        return False
    for k in range(2, count):
        room.force[k - 2] = 1.0  # at first all contacts press
    for _ in range(_ROUNDS):
        _solve(plant, room, count, qvel, qacc)
        same = True
        for k in range(2, count):
            pressing = room.wanted[k] - _dot(room.rows, k, qacc)
            if (pressing > 0.0) != (room.force[k - 2] > 0.0):
                same = False
            room.force[k - 2] = max(pressing, 0.0)
        if same:
            break
    else:
        return False
    for j in range(6):  # the engine's own bound: it warns, and the trial has diverged
        if not (abs(qacc[j]) < _WILD and abs(qvel[j]) < _WILD and abs(qpos[j]) < _WILD):
            return False
    for k in range(3):
        room.total[k] = 0.0
    for k in range(2, count):
        room.total[room.finger[k]] += room.force[k - 2] * room.weight[k]
    for j in range(6):
        qvel[j] += plant.step * qacc[j]
        qpos[j] += plant.step * qvel[j]
    return True


@njit(cache=True)
def _rows(
    plant: _Plant, room: _Room, most: int, qpos: FloatArray, qvel: FloatArray
) -> int:  # pragma: no cover - compiled
    """Rows of linkage and contacts; their number, or -1 if the engine has to go on."""
    for k in range(2):
        for j in range(6):
            room.rows[k, j] = plant.links[k, j]
        room.weight[k] = plant.link_weight[k]
        error, speed = _dot(plant.links, k, qpos), _dot(plant.links, k, qvel)
        room.wanted[k] = -plant.link_law[1] * speed - plant.link_law[0] * error
    fingers_seen(plant.directions, qpos, room.fingers)
    cos, sin = math.cos(qpos[5]), math.sin(qpos[5])
    count = 2
    for finger in range(3):
        x, y = room.fingers[finger, 0], room.fingers[finger, 1]
        for piece in range(len(plant.reach)):
            mx, my = x - plant.middle[piece, 0], y - plant.middle[piece, 1]
            near = plant.reach[piece] + plant.radius
            if mx * mx + my * my >= near * near:
                continue
            first, last = plant.first[piece], plant.first[piece + 1]
            away, nx, ny = _from_piece(plant.points, first, last, x, y)
            if away <= 0.0 or away >= plant.radius:
                if away <= 0.0:
                    return -1
                continue
            if count == most + 2:
                return -1
            row = room.rows[count]
            for j in range(3):
                row[j] = 0.0
            wx, wy = cos * nx - sin * ny, sin * nx + cos * ny
            row[finger] = wx * plant.directions[finger, 0] + wy * plant.directions[finger, 1]
            row[3], row[4] = -wx, -wy
            row[5] = -(x * ny - y * nx)
            soft, hard, speed = 0.0, 0.0, 0.0
            for j in range(6):
                square = row[j] * row[j]
                hard += square * plant.lighter[j]
                soft += square * plant.softer[j]
                speed += row[j] * qvel[j]
            room.weight[count] = plant.stiffness * hard / (soft * plant.contact_weight[finger])
            depth = away - plant.radius
            room.wanted[count] = -plant.contact_law[1] * speed - plant.contact_law[0] * depth
            room.finger[count] = finger
            count += 1
    if count == 2:
        return count
    for j in range(6):
        if abs(qvel[j]) >= plant.slow:
            return count
    return -1


@njit(cache=True)
def _from_piece(
    points: FloatArray, first: int, last: int, x: float, y: float
) -> tuple[float, float, float]:  # pragma: no cover - compiled
    """Distance of a point from a convex piece and the unit vector away from it; 0: inside."""
    nearest, nx, ny = math.inf, 0.0, 0.0
    outside = False
    ax, ay = x - points[last - 1, 0], y - points[last - 1, 1]
    for j in range(first, last):
        bx, by = x - points[j, 0], y - points[j, 1]
        ex, ey = ax - bx, ay - by
        outside |= ax * ey - ay * ex < 0.0
        share = (ax * ex + ay * ey) / (ex * ex + ey * ey)
        share = min(max(share, 0.0), 1.0)
        fx, fy = ax - share * ex, ay - share * ey
        square = fx * fx + fy * fy
        if square < nearest:
            nearest, nx, ny = square, fx, fy
        ax, ay = bx, by
    if not outside:
        return 0.0, 0.0, 0.0
    away = math.sqrt(nearest)
    return away, nx / away, ny / away


@njit(cache=True)
def _dot(rows: FloatArray, k: int, vector: FloatArray) -> float:  # pragma: no cover - compiled
    total = 0.0
    for j in range(6):
        total += rows[k, j] * vector[j]
    return total


@njit(cache=True)
def _solve(
    plant: _Plant, room: _Room, count: int, qvel: FloatArray, qacc: FloatArray
) -> None:  # pragma: no cover - compiled
    """Set ``qacc`` to the minimum with the contacts that press: Cholesky, six by six."""
    system, right = room.system, room.right
    for i in range(6):
        for j in range(i):
            system[i, j] = 0.0
        system[i, i] = plant.metric[i]
        right[i] = plant.pull[i] - plant.damping[i] * qvel[i]
    for k in range(count):
        if k >= 2 and room.force[k - 2] <= 0.0:
            continue
        row, weight = room.rows[k], room.weight[k]
        for i in range(6):
            if row[i] != 0.0:
                right[i] += weight * row[i] * room.wanted[k]
                for j in range(i + 1):
                    system[i, j] += weight * row[i] * row[j]
    for i in range(6):
        for j in range(i + 1):
            total = system[i, j]
            for k in range(j):
                total -= system[i, k] * system[j, k]
            system[i, j] = math.sqrt(total) if i == j else total / system[j, j]
    for i in range(6):
        total = right[i]
        for k in range(i):
            total -= system[i, k] * qacc[k]
        qacc[i] = total / system[i, i]
    for i in range(5, -1, -1):
        total = qacc[i]
        for k in range(i + 1, 6):
            total -= system[k, i] * qacc[k]
        qacc[i] = total / system[i, i]


def _room() -> _Room:
    return _Room(
        np.zeros((2 + _MOST, 6)), np.zeros(2 + _MOST), np.zeros(2 + _MOST),
        np.zeros(2 + _MOST, dtype=np.int64), np.zeros((6, 6)), np.zeros(6), np.zeros((3, 2)),
        np.zeros(_MOST), np.zeros(3),
    )  # fmt: skip


def _plant(scene: Scene) -> _Plant:
    """Everything read off the compiled model, nothing computed a second time."""
    model, config, hand = scene.model, scene.config, scene.kinematics
    body = {name: mj.mj_name2id(model, mj.mjtObj.mjOBJ_BODY, name) for name in _BODIES}
    mass = np.array([*(model.body_mass[body[name]] for name in _BODIES), 0.0, 0.0])
    mass[4], mass[5] = mass[3], model.body_inertia[body["object"], 2]
    damping = np.array(model.dof_damping, dtype=np.float64).reshape(6, -1)[:, 0]
    pull = np.zeros(6)
    pull[:3] = scene.closing_force * hand.tendon_coefficients
    stiffness = _STIFFEST / (1.0 - _STIFFEST)
    metric = mass + config.time_step * damping
    links, link_weight = np.zeros((2, 6)), np.zeros(2)
    for k in range(2):
        one, other = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        links[k, one], links[k, other] = 1.0, -float(model.eq_data[k, 1])
        softer = (links[k] ** 2 / metric).sum() / (links[k] ** 2 / mass).sum()
        loose = float(model.dof_invweight0[one] + model.dof_invweight0[other])
        link_weight[k] = stiffness / (loose * softer)
    weights = np.array(model.body_invweight0)[:, 0]
    contact_weight = np.array([weights[body[name]] for name in _BODIES[:3]])
    points, first = _rims(model, body["object"])
    ends = list(zip(first[:-1].tolist(), first[1:].tolist(), strict=True))
    middle = np.array([points[a:b].mean(axis=0) for a, b in ends])
    reach = [np.hypot(*(points[a:b] - m).T).max() for (a, b), m in zip(ends, middle, strict=True)]
    step = config.time_step
    return _Plant(
        step=step,
        lighter=1.0 / mass,
        metric=metric,
        softer=1.0 / metric,
        damping=damping,
        pull=pull,
        directions=hand.directions,
        radius=float(model.geom("finger_1_tip").size[0]),
        links=links,
        link_weight=link_weight,
        link_law=_law(np.array(model.eq_solref[0]), step),
        contact_weight=contact_weight + weights[body["object"]],
        contact_law=_law(np.array(config.solref), step),
        stiffness=stiffness,
        slow=_SLOW * config.free_speed,
        points=points,
        first=first,
        middle=middle,
        reach=np.array(reach),
    )


_BODIES: Final = ("finger_1", "finger_2", "finger_3", "object")


def _law(solref: FloatArray, step: float) -> FloatArray:
    """What a reference (time constant, damping ratio) makes of an error and of its rate.

    ``discrete`` takes the spring K d and the damper B at the end of the step.
    """
    constant, ratio = solref.tolist()
    scaled = _STIFFEST * constant
    spring, damper = _STIFFEST / (scaled * ratio) ** 2, 2.0 / scaled
    return np.array([spring, damper + step * spring]) / (1.0 + step * damper + step**2 * spring)


def _rims(model: MjModel, body: int) -> tuple[FloatArray, IntArray]:
    """Vertices of the compiled pieces in the plane, counterclockwise, and where each begins."""
    rims: list[FloatArray] = []
    for geom in np.flatnonzero(model.geom_bodyid == body).tolist():
        mesh: Any = model.geom_dataid[geom]
        begin, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        turn = np.zeros(9)
        mj.mju_quat2Mat(turn, model.geom_quat[geom])
        solid = np.array(model.mesh_vert[begin : begin + count], dtype=np.float64)
        placed = solid @ turn.reshape(3, 3).T + model.geom_pos[geom]
        rims.append(placed[np.abs(placed[:, 2]) < _FLAT][:, :2])
    first = np.cumsum([0, *(len(rim) for rim in rims)])
    return np.ascontiguousarray(np.vstack(rims)), first.astype(np.int64)
