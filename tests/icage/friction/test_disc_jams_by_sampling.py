"""Jams of disc fingers, against hands and balances drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.friction.kernels import disc_balance as module
from icage.friction.kernels.disc_balance import _power, _torque, least_balanced
from icage.friction.kernels.disc_features import ARC, CORNER, rays
from icage.friction.kernels.disc_hands import (
    COLUMNS,
    slack_of,
)
from icage.friction.kernels.disc_jams import Room, _begun, _room, _sizes_fit, _smaller
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal
from tests.icage.friction.drawn_discs import RADIUS, contacts
from tests.icage.friction.flat_polygons import Flat, fingers_of
from tests.icage.friction.test_cones_of_forces import Z, edges
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

ALL_FAR = Near(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1e-12)
NO_GOAL = Goal(np.zeros((3, 2)), 0.0, False)


def squeeze(ray: Floats, hands: Floats) -> Floats:
    """Of hands (n, 4) the least T_a P_b - T_b P_a, T_a > 0 > T_b: below 0 forces hold them."""
    torque = np.array([[_torque(r, q) for r in ray] for q in hands])
    power = np.array([[_power(r, q) for r in ray] for q in hands])
    work = torque[:, :, None] * power[:, None, :] - torque[:, None, :] * power[:, :, None]
    sides = (torque[:, :, None] > 0.0) & (torque[:, None, :] < 0.0)
    return np.where(sides, work, np.inf).min(axis=(1, 2))


def drawn(seed: int) -> tuple[np.random.Generator, Flat, Room, Floats]:
    """A flat polygon of hands, room to work in, and the rays (m, ...) of forces on some edges."""
    rng = np.random.default_rng([seed, 3])
    flat = Flat.drawn(rng, np.append(rng.normal(size=2), [1.5, 0.8]), 0.5)
    room = _room(3)
    m = 0
    while not m:
        m = rays(Z, edges(rng, 5), 5, room.ray)
    return rng, flat, room, room.ray[:m].copy()


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12])  # 7 takes long
@pytest.mark.parametrize("towards", [False, True])
def test_no_hand_that_forces_hold_is_smaller_or_nearer(seed: int, towards: bool) -> None:
    rng, flat, room, ray = drawn(seed)
    hands = flat.hands(rng, 300)
    held = hands[squeeze(ray, hands) < -1e-9]
    size = np.hypot(hands[:, 2], hands[:, 3])
    spots = fingers_of(flat.middle[None] + 0.2 * rng.normal(size=4), Z)[0]
    most = float(np.quantile(size, 0.7)) if towards else 0.0
    goal = Goal(np.column_stack([spots.real, spots.imag]), most, True) if towards else NO_GOAL
    room.polygon[: len(flat.inside)] = flat.corners
    point = np.full(4, np.nan)
    n = len(flat.inside)
    found = least_balanced(n, Z, ray, len(ray), ALL_FAR, goal, 1e6, 1e-12, 1e-12, room, point)

    def costs(q: Floats) -> Floats:
        sizes = np.hypot(q[:, 2], q[:, 3])
        apart = np.abs(fingers_of(q, Z) - spots).max(axis=1)
        return np.where(sizes <= most, apart, np.inf) if towards else sizes

    if len(held):
        assert found <= costs(held).min() + 1e-9
    if found < np.inf:
        assert costs(point[None] * [1, 1, 1 - 1e-12, 1 - 1e-12])[0] == pytest.approx(
            found, abs=1e-6
        )
        assert flat.holds(flat.corners, point, 1e-8)
        wiggled = point + 1e-6 * rng.normal(size=(40, 4))
        assert squeeze(ray, wiggled).min() < 1e-5
        less, more = found * (1.0 - 1e-6), found * (1.0 + 1e-6)
        args = (ALL_FAR, goal)
        assert least_balanced(n, Z, ray, len(ray), *args, less, 1e-12, 1e-12, room, point) == np.inf
        again = least_balanced(n, Z, ray, len(ray), *args, more, 1e-12, 1e-12, room, point)
        assert again == pytest.approx(found, rel=1e-6)


def test_features_that_fit_a_size() -> None:
    """Two points three apart: hands whose side is 1 have sigma 3, to within what is thick."""
    which = contacts(np.random.default_rng(8))
    which.kind[:] = CORNER
    which.place[:2] = [[0.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0]]
    state, place = np.zeros((3, COLUMNS)), np.empty((3, 4))
    finger = np.array([0, 1])

    def fits(least: float, most: float, thick: float = 1e-6) -> bool:
        one, other = (
            _sizes_fit(
                Z + [0.7, -0.4], finger, np.array(pair), 2, which, turned, least, most, thick, place
            )
            for pair, turned in (([0, 1], state), ([1, 0], state[[1, 0, 2]]))
        )
        assert one == other
        return bool(one)

    assert fits(1.0, 3.1)
    assert fits(2.9, 5.0)
    assert fits(3.0, 3.0)
    assert not fits(1.0, 2.9)
    assert not fits(3.1, 5.0)
    assert fits(1.0, 2.9, 0.2)
    assert fits(3.1, 5.0, 0.2)
    assert fits(1.0, 2.5, 0.5)
    assert not fits(1.0, 2.4375, 0.5)
    assert fits(4.0, 9.0, 0.5)
    assert not fits(4.0625, 9.0, 0.5)
    which.place[1, 2:] = 0.0, 4.0  # a side from (3, 0) to (3, 4): 3 to 5 away
    assert fits(1.0, 3.1)
    assert fits(4.9, 6.0)
    assert fits(5.5, 9.0)
    assert not fits(5.7, 9.0)
    assert not fits(0.1, 1.5)
    which.place[1, 2:] = 4.0, 0.0  # from (3, 0) to (7, 0)
    assert fits(3.1, 3.1)
    assert not fits(1.0, 2.9)
    assert fits(6.9, 9.0)
    assert not fits(7.1, 9.0)
    which.place[1, 2:] = 0.0
    which.kind[1], state[1, :2] = ARC, (0.0, 0.5)
    chord, bulge = 2 * RADIUS * math.sin(0.5), RADIUS * (1.0 - math.cos(0.5))
    middle = 3.0 + RADIUS * math.cos(0.5)
    most = middle + 0.5 * chord + bulge
    assert fits(most - 1e-4, 9.0)
    assert not fits(most + 1e-4, 9.0)


def test_what_begins_and_what_is_left_of_a_tolerance() -> None:
    which = contacts(np.random.default_rng(9))
    finger, state = np.zeros(3, np.int64), np.full((3, COLUMNS), -1.0)
    assert _begun(np.array([True, False, True]), np.array([3, 1, 0]), which, finger, state) == 2
    assert finger[:2].tolist() == [0, 2]
    assert state[[0, 2], :2].tolist() == which.angle[[3, 1]].tolist()
    assert state[1].tolist() == [-1.0] * COLUMNS
    near = Near(1.0, 2.0, 0.5, 1.0, 0.0, 0.3, 3.0, 4.0, 1e-9)
    slack = slack_of(Z, np.array([0, 1]), np.array([2, 3]), which, state)._replace(shift=0.2)
    left = _smaller(near, slack, 0.1)
    assert left.reach == pytest.approx(0.3)
    assert left.turn == pytest.approx(0.3 - 0.16)
    assert left._replace(reach=0.5, turn=0.3) == near
    assert _smaller(near, slack._replace(shift=1.0), 1.0)[2::3] == (0.0, 0.0, 4.0)[:2] + left[8:]


@pytest.mark.parametrize("seed", [42, 72, 81, 92, 98])
def test_a_bound_rises_as_its_polygon_is_halved(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two balances that squeeze together only on a curve: what is left of it is never too much."""
    rng, flat, room, ray = drawn(seed)
    hands = flat.hands(rng, 3000)
    held = hands[squeeze(ray, hands) < -1e-9]
    n, point = len(flat.inside), np.full(4, np.nan)
    bounds = []
    for most in (0, 3, 6, 9):
        monkeypatch.setattr(module, "HALVED", most)
        room.polygon[:n] = flat.corners
        bound = least_balanced(
            n, Z, ray, len(ray), ALL_FAR, NO_GOAL, 1e6, 1e-12, 1e-12, room, point
        )
        bounds.append(float(bound))
    assert bounds == sorted(bounds)
    if len(held):
        least = np.hypot(held[:, 2], held[:, 3]).min()
        assert bounds[-1] <= least + 1e-9
        assert bounds[-1] >= least - 0.3
    assert bounds[-1] > bounds[0]
