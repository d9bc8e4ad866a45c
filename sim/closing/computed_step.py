"""One step of the engine, written down for discs on convex pieces: compiled loops.

One step of the integrator ``discrete``, with M and D the diagonals of masses and dampings, h the
time step, W = M + h D, f the motor's pull, and rows J of the linkage and of the contacts:

    a = argmin  (a - a_0)' W (a - a_0) / 2  +  sum_i s_i (J_i a - r_i)^2 / 2,   W a_0 = f - D v
    v' = v + h a,   q' = q + h v'

A contact's term counts only while J_i a < r_i (it never pulls). With p_i the depth (negative) or
the linkage's error, d the impedance, K and B of the time constant and the damping ratio,

    r_i = -((B + h K d) J_i v + K d p_i) / (1 + h B + h^2 K d)
    s_i = d / (1 - d) / w_i,   w_i = w_0 (J W^-1 J') / (J M^-1 J')

and w_0 the compiled inverse weights.

These loops and the tuples they read are in one file: numba's cache on disk notices a change
of the file that a loop is in, and of no other.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from sim.world.hand_in_object import fingers_turned
from sim.world.machine_loops import borrowing, inlined

STIFFEST: Final = 0.9999
"""The engine's bound on an impedance. Both ends of ours are at it or above: d is constant."""

STIFFNESS: Final = STIFFEST / (1.0 - STIFFEST)
"""d / (1 - d)"""

_LINKS: Final = 2
"""Rows of the linkage, before those of the contacts."""

_MOST: Final = 3
"""Contacts that one step may have here: a grasp of discs in corners has more."""

_WILD: Final = 1e10
"""Positions, velocities or accelerations that large are left to the engine, which warns of them."""

_ROUNDS: Final = 8
"""Tries to find out which contacts press."""


class Plant(NamedTuple):
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
    slow: float
    points: FloatArray
    first: IntArray
    middle: FloatArray
    reach: FloatArray


class Room(NamedTuple):
    """Scratch of one step: rows (_LINKS + _MOST, 6), what each is of, and the system of equations.

    ``force`` is a row's force over its weight; a contact whose ``force`` is 0 does not press.
    ``fingers`` (3, 2) and ``turn`` (2,), its cosine and sine, are the pose at hand.
    """

    rows: FloatArray
    weight: FloatArray
    wanted: FloatArray
    force: FloatArray
    finger: IntArray
    system: FloatArray
    right: FloatArray
    fingers: FloatArray
    turn: FloatArray
    total: FloatArray


def empty_room() -> Room:
    """Scratch for any number of steps, one after another."""
    rows = _LINKS + _MOST
    return Room(
        np.zeros((rows, 6)), np.zeros(rows), np.zeros(rows), np.zeros(rows),
        np.zeros(rows, dtype=np.int64), np.zeros((6, 6)), np.zeros(6), np.zeros((3, 2)),
        np.zeros(2), np.zeros(3),
    )  # fmt: skip


@inlined
def copy_rows(rows: FloatArray, out: FloatArray) -> None:  # pragma: no cover - compiled
    """``out[:] = rows`` (3, 6), which would take two seconds to compile, for what it may raise."""
    for a in range(rows.shape[0]):
        for b in range(rows.shape[1]):
            out[a, b] = rows[a, b]


def go_on(
    ids: IntArray,
    plant: Plant,
    room: Room,
    most: int,
    stride: int,
    state: FloatArray,
    peak: FloatArray,
) -> BoolArray:
    """``stride`` steps of the closings ``ids``, with at most ``most`` contacts; which of them went.

    Updated in place, a row each for N closings: ``state`` (N, 3, 6) = positions, velocities,
    accelerations, and the largest force ``peak`` (N,). One that cannot go all the way is not begun.
    """
    went = np.empty(len(ids), dtype=np.bool_)
    _go_on(ids, plant, room, most, stride, state, peak, np.empty((3, 6)), went)
    return went


@borrowing
def _go_on(
    ids: IntArray,
    plant: Plant,
    room: Room,
    most: int,
    stride: int,
    state: FloatArray,
    peak: FloatArray,
    ahead: FloatArray,
    went: BoolArray,
) -> None:  # pragma: no cover - compiled
    for n in range(len(ids)):
        i = ids[n]
        copy_rows(state[i], ahead)
        went[n] = goes_on(plant, room, most, stride, False, ahead)
        if went[n]:
            copy_rows(ahead, state[i])
            peak[i] = max(peak[i], pressing(room))


@inlined
def stand(plant: Plant, room: Room, qpos: FloatArray) -> None:  # pragma: no cover - compiled
    """Have the pose ``qpos`` (6,) at hand."""
    cos, sin = math.cos(qpos[5]), math.sin(qpos[5])
    room.turn[0], room.turn[1] = cos, sin
    fingers_turned(plant.directions, qpos, cos, sin, room.fingers)


@inlined
def goes_on(
    plant: Plant, room: Room, most: int, stride: int, stands: bool, ahead: FloatArray
) -> bool:  # pragma: no cover - compiled
    """``stride`` steps of one closing ``ahead`` (3, 6); False: it cannot go all the way.

    ``stands`` says that its pose is at hand.
    """
    for k in range(stride):
        if k > 0 or not stands:
            stand(plant, room, ahead[0])
        if not _step(plant, room, most, ahead):
            return False
    return True


@inlined
def pressing(room: Room) -> float:  # pragma: no cover - compiled
    """The largest force on a finger in the last step."""
    return max(room.total[0], room.total[1], room.total[2])


@inlined
def _step(
    plant: Plant, room: Room, most: int, state: FloatArray
) -> bool:  # pragma: no cover - compiled
    """One step of state (3, 6) = positions, velocities, accelerations; False: not done.

    The pose of the positions is at hand.
    """
    qpos, qvel, qacc = state[0], state[1], state[2]
    count = _rows(plant, room, most, qpos, qvel)
    if count < 0:
        return False
    for k in range(count):
        room.force[k] = 1.0  # at first all contacts press; the linkage always acts
    for _ in range(_ROUNDS):
        _solve(plant, room, count, qvel, qacc)
        same = True
        for k in range(_LINKS, count):
            pressing = room.wanted[k] - _dot(room.rows, k, qacc)
            if (pressing > 0.0) != (room.force[k] > 0.0):
                same = False
            room.force[k] = max(pressing, 0.0)
        if same:
            break
    else:
        return False
    for j in range(6):  # the engine's own bound: it warns, and the trial has diverged
        if not (abs(qacc[j]) < _WILD and abs(qvel[j]) < _WILD and abs(qpos[j]) < _WILD):
            return False
    for k in range(3):
        room.total[k] = 0.0
    for k in range(_LINKS, count):
        room.total[room.finger[k]] += room.force[k] * room.weight[k]
    for j in range(6):
        qvel[j] += plant.step * qacc[j]
        qpos[j] += plant.step * qvel[j]
    return True


@inlined
def _rows(
    plant: Plant, room: Room, most: int, qpos: FloatArray, qvel: FloatArray
) -> int:  # pragma: no cover - compiled
    """Rows of linkage and contacts; their number, or -1 if the engine has to go on."""
    for k in range(_LINKS):
        for j in range(6):
            room.rows[k, j] = plant.links[k, j]
        room.weight[k] = plant.link_weight[k]
        error, speed = _dot(plant.links, k, qpos), _dot(plant.links, k, qvel)
        room.wanted[k] = -plant.link_law[1] * speed - plant.link_law[0] * error
    cos, sin = room.turn[0], room.turn[1]
    count = _LINKS
    for finger in range(3):
        x, y = room.fingers[finger, 0], room.fingers[finger, 1]
        for piece in range(len(plant.reach)):
            mx, my = x - plant.middle[piece, 0], y - plant.middle[piece, 1]
            near = plant.reach[piece] + plant.radius
            if mx * mx + my * my >= near * near:
                continue
            first, last = plant.first[piece], plant.first[piece + 1]
            away, nx, ny = _from_piece(plant.points, first, last, x, y)
            if away <= 0.0:
                return -1
            if away >= plant.radius:
                continue
            if count == _LINKS + most:
                return -1
            row = room.rows[count]
            for j in range(3):
                row[j] = 0.0
            wx, wy = cos * nx - sin * ny, sin * nx + cos * ny
            row[finger] = wx * plant.directions[finger, 0] + wy * plant.directions[finger, 1]
            row[3], row[4] = -wx, -wy
            row[5] = -(x * ny - y * nx)
            soft, hard = 0.0, 0.0
            for j in range(6):
                square = row[j] * row[j]
                hard += square * plant.lighter[j]
                soft += square * plant.softer[j]
            room.weight[count] = STIFFNESS * hard / (soft * plant.contact_weight[finger])
            depth, speed = away - plant.radius, _dot(room.rows, count, qvel)
            room.wanted[count] = -plant.contact_law[1] * speed - plant.contact_law[0] * depth
            room.finger[count] = finger
            count += 1
    if count == _LINKS:
        return count
    for j in range(6):
        if abs(qvel[j]) >= plant.slow:
            return count
    return -1


@borrowing
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


@borrowing
def _dot(rows: FloatArray, k: int, vector: FloatArray) -> float:  # pragma: no cover - compiled
    total = 0.0
    for j in range(6):
        total += rows[k, j] * vector[j]
    return total


@inlined
def _solve(
    plant: Plant, room: Room, count: int, qvel: FloatArray, qacc: FloatArray
) -> None:  # pragma: no cover - compiled
    """Set ``qacc`` to the minimum with the contacts that press: Cholesky, six by six."""
    system, right = room.system, room.right
    for i in range(6):
        for j in range(i):
            system[i, j] = 0.0
        system[i, i] = plant.metric[i]
        right[i] = plant.pull[i] - plant.damping[i] * qvel[i]
    for k in range(count):
        if room.force[k] <= 0.0:
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
