"""Clipping polygons of hands and looking for the least of them: against hands drawn from them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.friction.kernels.disc_balance import _halving_row
from icage.friction.kernels.far import Near, is_far, least_far
from icage.friction.kernels.goal import Goal, _middle, cheapest
from icage.friction.kernels.polygon import clip, keep, keep_near, least, put_hands_of_two
from tests.icage.friction.flat_polygons import ROOM, Flat, fingers_of
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

Z = np.array([[0.1, -0.2], [1.0, 0.1], [0.4, 0.9]])
SEEDS = range(12)
NO_GOAL = Goal(np.zeros((3, 2)), 0.0, False)


def drawn(seed: int, size: float = 1.0) -> tuple[Flat, np.random.Generator]:
    rng = np.random.default_rng([seed, 8])
    return Flat.drawn(rng, np.append(rng.normal(size=2), [1.5, 0.8]), size), rng


@pytest.mark.parametrize("seed", SEEDS)
def test_clipping_keeps_what_is_in_the_half_space(seed: int) -> None:
    flat, rng = drawn(seed)
    n = len(flat.inside)
    hands = flat.hands(rng, 60)
    row = rng.normal(size=5)
    row[4] = -row[:4] @ flat.hands(rng, 1)[0]
    kept = np.full((ROOM, 4), np.nan)
    m = clip(flat.room(), n, row, kept)
    assert 3 <= m <= n + 1
    assert (kept[:m] @ row[:4] + row[4]).min() >= -1e-12
    for hand, value in zip(hands, hands @ row[:4] + row[4], strict=True):
        if abs(value) > 1e-9:
            assert flat.holds(kept[:m], hand) == (value > 0.0)
    where = flat.room()
    assert keep(where, n, row, np.empty((ROOM, 4))) == m
    assert where[:m].tolist() == kept[:m].tolist()
    row[4] = 100.0
    assert clip(flat.room(), n, row, kept) == n
    row[4] = -100.0
    assert clip(flat.room(), n, row, kept) == 0


def test_corners_on_the_border_are_kept_and_room_that_is_too_small_keeps_all() -> None:
    square = np.zeros((4, 4))
    square[:, :2] = [[0, 0], [1, 0], [1, 1], [0, 1]]
    kept = np.empty((ROOM, 4))
    assert clip(square, 4, np.array([0.0, 1.0, 0.0, 0.0, 0.0]), kept) == 4
    m = clip(square, 4, np.array([0.0, -1.0, 0.0, 0.0, 0.0]), kept)
    assert {tuple(q) for q in kept[:m, :2]} == {(0.0, 0.0), (1.0, 0.0)}
    half = np.array([1.0, 0.0, 0.0, 0.0, -0.5])
    assert clip(square, 4, half, np.empty((6, 4))) == 4
    few = np.full((4, 4), np.nan)
    assert clip(square, 4, half, few) == 4
    assert few.tolist() == square.tolist()


@pytest.mark.parametrize("seed", SEEDS)
def test_no_hand_of_a_polygon_is_smaller(seed: int) -> None:
    flat, rng = drawn(seed, 2.0 if seed % 2 else 0.4)
    hands = flat.hands(rng, 400)
    point = np.empty(4)
    found = least(flat.room(), len(flat.inside), point)
    assert np.hypot(*point[2:]) == pytest.approx(found, abs=1e-12)
    assert flat.holds(flat.corners, point)
    ring = flat.corners
    ends = np.linspace(0.0, 1.0, 400)[:, None]
    sides = [a + ends * (b - a) for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)]
    on_sides = np.concatenate(sides)
    assert np.hypot(on_sides[:, 2], on_sides[:, 3]).min() >= found - 1e-12
    assert is_pinched(flat) or np.hypot(hands[:, 2], hands[:, 3]).min() >= found - 1e-12


def is_pinched(flat: Flat) -> bool:
    """Whether a hand of the polygon has no size: its corners' w go all round."""
    turns = np.sort(np.arctan2(flat.corners[:, 3], flat.corners[:, 2]))
    return bool(np.diff(turns, append=turns[0] + 2.0 * np.pi).max() < np.pi)


def test_a_polygon_that_is_one_hand() -> None:
    one = np.tile([1.0, 2.0, 3.0, 4.0], (4, 1))
    point = np.empty(4)
    assert least(one, 4, point) == 5.0
    assert point.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert least(one, 0, point) == np.inf


@pytest.mark.parametrize("seed", SEEDS)
def test_a_finger_is_kept_near_a_side(seed: int) -> None:
    flat, rng = drawn(seed)
    hands = flat.hands(rng, 80)
    finger = int(rng.integers(3))
    at = fingers_of(hands, Z)[:, finger]
    middle, side = at[0], complex(*rng.normal(size=2)) if seed % 3 else 0.0j
    loose = float(rng.uniform(0.2, 0.6))
    place = np.array([middle.real, middle.imag, side.real, side.imag])
    polygon = flat.room()
    n = keep_near(
        place, Z[finger], loose, np.empty(5), polygon, len(flat.inside), np.empty((ROOM, 4))
    )
    assert n >= 3
    way = side / abs(side) if side else 1.0
    off = (at - middle) * np.conj(way)
    gap = np.min([off.real + loose, abs(side) + loose - off.real, loose - np.abs(off.imag)], axis=0)
    assert (gap > 0.0).any()
    for hand, value in zip(hands, gap, strict=True):
        if abs(value) > 1e-9:
            assert flat.holds(polygon[:n], hand) == (value > 0.0)


def test_hands_of_two_stand_on_the_ends_of_both_sides() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        p, q = rng.normal(size=(2, 4))
        i, j = rng.permutation(3)[:2]
        polygon = np.empty((4, 4))
        put_hands_of_two(p, q, Z[i], Z[j], polygon)
        at = fingers_of(polygon, Z)
        ends = [[complex(*e[:2]), complex(*e[:2]) + complex(*e[2:])] for e in (p, q)]
        known = [(0, 0), (1, 0), (1, 1), (0, 1)]  # round the polygon
        for corner, (s, u) in zip(at, known, strict=True):
            assert corner[i] == pytest.approx(ends[0][s], abs=1e-12)
            assert corner[j] == pytest.approx(ends[1][u], abs=1e-12)


def tolerance(flat: Flat, seed: int) -> Near:
    """Round the middle of the polygon, a good part of it out of reach; of every third no turn, or
    no shift, is asked."""
    x, y, wx, wy = flat.middle
    size = math.hypot(wx, wy)
    mid = Z.mean(axis=0)
    all_in = Near(
        x + wx * mid[0] - wy * mid[1], y + wx * mid[1] + wy * mid[0], np.inf, wx / size, wy / size,
        np.inf, mid[0], mid[1], 1e-10,
    )  # fmt: skip
    shift, turn = off(flat.corners, all_in)
    return all_in._replace(
        reach=np.inf if seed % 3 == 1 else 0.6 * float(shift.max()),
        turn=np.inf if seed % 3 == 2 else min(1.5, 0.6 * float(turn.max())),
    )


def off(hands: Floats, near: Near) -> tuple[Floats, Floats]:
    """By how much the middles of hands (n, 4) are shifted and the hands are turned."""
    middle = fingers_of(hands, np.array([[near.mid_x, near.mid_y]]))[:, 0]
    turn = np.angle((hands[:, 2] + 1j * hands[:, 3]) / complex(near.ahead_x, near.ahead_y))
    return np.abs(middle - complex(near.at_x, near.at_y)), np.abs(turn)


def far_by_angle_and_shift(hands: Floats, near: Near, slack: float) -> np.ndarray:
    """Which hands (n, 4) are out of the tolerance by more than some slack."""
    shift, turn = off(hands, near)
    return (turn > near.turn + slack) | (shift > near.reach + slack)


@pytest.mark.parametrize("seed", SEEDS)
def test_no_far_hand_is_smaller(seed: int) -> None:
    flat, rng = drawn(seed, 0.7)
    near = tolerance(flat, seed)
    n, part, point = len(flat.inside), np.empty((ROOM, 4)), np.empty(4)
    hands = flat.hands(rng, 3000)
    far = far_by_angle_and_shift(hands, near, 1e-7)
    assert far.any()
    assert not far.all()
    told = np.array([is_far(q, near) for q in hands[:200]])
    assert not (told & ~far_by_angle_and_shift(hands[:200], near, -1e-7)).any()
    assert not (far[:200] & ~told).any()
    found = least_far(flat.room(), n, near, 1e9, part, point)
    assert np.hypot(hands[far, 2], hands[far, 3]).min() >= found
    assert np.hypot(*point[2:]) == pytest.approx(found, abs=1e-12)
    assert flat.holds(flat.corners, point)
    assert far_by_angle_and_shift(point[None], near, -1e-6)[0]
    assert cheapest(flat.room(), n, near, NO_GOAL, Z, 1e9, part, point) == found
    assert least_far(flat.room(), n, near, found * (1.0 - 1e-9), part, point) == np.inf
    assert least_far(flat.room(), n, near, found * (1.0 + 1e-6), part, point) <= found + 1e-9
    if near.turn < np.inf:
        wide = near._replace(reach=1e3, turn=1.57)
        assert least_far(flat.room(), n, wide, 1e9, part, point) == np.inf


@pytest.mark.parametrize("seed", SEEDS)
def test_no_hand_is_nearer_to_the_goal(seed: int) -> None:
    """The goal beside the polygon, or in it; some of its hands are too large to count."""
    flat, rng = drawn(seed, 0.7)
    hands = flat.hands(rng, 4000)
    goal = flat.hands(rng, 1)[0] + (0.4 if seed % 3 else 0.0) * rng.normal(size=4)
    spots = fingers_of(goal[None], Z)[0]
    sigma = np.hypot(hands[:, 2], hands[:, 3])
    most = float(np.quantile(sigma, 0.4))
    asked = Goal(np.column_stack([spots.real, spots.imag]), most, True)
    distance = np.abs(fingers_of(hands, Z) - spots).max(axis=1)
    n, part, point = len(flat.inside), np.empty((ROOM, 4)), np.empty(4)
    near = tolerance(flat, 0)
    found = cheapest(flat.room(), n, near, asked, Z, 1e9, part, point)
    assert distance[sigma <= most].min() >= found * (1.0 - 1e-8)
    assert np.abs(fingers_of(point[None], Z)[0] - spots).max() == pytest.approx(found, abs=1e-12)
    assert np.hypot(*point[2:]) <= most * (1.0 + 1e-12)
    assert flat.holds(flat.corners, point)
    if found > 1e-3:
        less, more = found * (1.0 - 1e-6), found * (1.0 + 1e-6)
        assert cheapest(flat.room(), n, near, asked, Z, less, part, point) == np.inf
        assert cheapest(flat.room(), n, near, asked, Z, more, part, point) <= more
    none = asked._replace(most=0.5 * float(sigma.min()))
    if not is_pinched(flat):
        assert cheapest(flat.room(), n, near, none, Z, 1e9, part, point) == np.inf


def test_a_polygon_without_corners_has_no_nearest_hand() -> None:
    """Whatever stands in the room of its corners, a hand of another polygon for one."""
    room = np.tile([0.0, 0.0, 1.0, 0.0], (ROOM, 1))
    asked = Goal(Z.copy(), 2.0, True)
    near = tolerance(drawn(0)[0], 0)
    part, point = np.empty((ROOM, 4)), np.empty(4)
    assert cheapest(room, 1, near, asked, Z, 1e9, part, point) == pytest.approx(0.0, abs=1e-12)
    assert cheapest(room, 0, near, asked, Z, 1e9, part, point) == np.inf
    assert cheapest(room, 0, near, NO_GOAL, Z, 1e9, part, point) == np.inf


def test_the_middle_of_the_sides() -> None:
    at = np.empty(4)
    ring = np.array([[0.0, 0, 0, 0], [4, 0, 0, 0], [4, 0, 0, 0], [4, 3, 0, 0]])
    _middle(ring, 4, at)
    assert at.tolist() == pytest.approx(
        [(4 * 2 + 3 * 4 + 5 * 2) / 12, (3 * 1.5 + 5 * 1.5) / 12, 0, 0]
    )
    _middle(np.tile(ring[3], (2, 1)), 2, at)
    assert at.tolist() == ring[3].tolist()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_polygon_is_halved_across_its_longest_extent(seed: int) -> None:
    flat, _ = drawn(seed)
    row, w = np.full(5, np.nan), flat.corners[:, 2:]
    assert _halving_row(row, flat.room(), len(w))
    apart = np.hypot(*(w[:, None] - w[None]).transpose(2, 0, 1))
    a, b = np.unravel_index(np.argmax(apart), apart.shape)
    assert row[:2].tolist() == [0.0, 0.0]
    values = w @ row[2:4] + row[4]
    assert abs(values[a]) == pytest.approx(0.5 * apart[a, b] ** 2)
    assert values[a] == pytest.approx(-values[b])
    assert not _halving_row(row, np.tile(flat.corners[0], (3, 1)), 3)
