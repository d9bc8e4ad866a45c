"""Equations, features near a hand and steps of closing: against numpy, scipy and definitions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from icage.discs.features import Features
from icage.discs.kernels.features import (
    _fingers_of,
    _pushing_at,
    felt,
    near_features,
    nearly_balanced,
    put_gaps,
)
from icage.discs.kernels.newton import Ended, _half_planes, _solved, descend, newton
from icage.hand import HandShape
from icage.kernels.forces import _without_pulling, least_squares, pushing_of
from icage.outline import Outline
from tests.oracles.geometry import Floats
from tests.oracles.targets import random_target

pytestmark = pytest.mark.usefixtures("plain")


@pytest.mark.parametrize("size", [1, 2, 3, 6, 8])
def test_equations_are_solved_as_by_numpy(size: int) -> None:
    rng = np.random.default_rng(size)
    for trial in range(15):
        a, b = rng.normal(size=(size, size)), rng.normal(size=size)
        if trial % 3 == 0 and size > 2:  # zeros where the first pivots would be
            a[0, 0] = a[size - 1, 0] = 0.0
            a[size // 2] *= 1e3
        table = np.column_stack([a, b])
        assert _solved(table, size)
        assert table[:, size] == pytest.approx(np.linalg.solve(a, b), rel=1e-7, abs=1e-9)
    if size > 1:
        a[-1] = a[0]
        assert not _solved(np.column_stack([a, b]), size)
        a[-1] = a[0] * (1.0 + 1e-9)
        assert not _solved(np.column_stack([a, b]), size)
        a = np.eye(size)
        a[-1, -1] = 1e-6
        assert _solved(np.column_stack([a, b]), size)
        a[-1, -1] = 0.9e-7
        assert not _solved(np.column_stack([a, b]), size)
    assert not _solved(np.zeros((size, size + 1)), size)


def test_least_squares_are_numpys() -> None:
    rng = np.random.default_rng(1)
    for _ in range(40):
        m, count = int(rng.integers(2, 6)), int(rng.integers(1, 5))
        columns, wanted = rng.normal(size=(m, 7)), rng.normal(size=m)
        which = rng.permutation(7)[:count]
        best = np.full(count, np.nan)
        regular = least_squares(columns, which, count, wanted, best)
        if count <= m:
            known = np.linalg.lstsq(columns[:, which], wanted, rcond=None)[0]
            assert best == pytest.approx(known)
            r = np.abs(np.diag(np.linalg.qr(columns[:, which])[1]))
            assert regular == pytest.approx(r.min() / r.max())
        else:
            assert regular == 0.0
            assert best[m:].tolist() == [0.0] * (count - m)
            assert columns[:, which] @ best == pytest.approx(wanted)
    columns = np.array([[1.0, 2.0, 0.0], [1.0, 2.0, 1.0], [0.0, 0.0, 0.0]])
    best = np.full(3, np.nan)
    assert least_squares(columns, np.arange(3), 3, np.array([3.0, 5.0, 9.0]), best) == 0.0
    assert best.tolist() == pytest.approx([3.0, 0.0, 2.0])
    assert least_squares(np.zeros((2, 1)), np.arange(1), 1, np.ones(2), best) == 0.0
    assert best[0] == 0.0


def test_forces_that_push_are_scipys_in_any_number() -> None:
    rng = np.random.default_rng(2)
    for _ in range(120):
        m, count = int(rng.integers(1, 6)), int(rng.integers(0, 9))
        columns, wanted = rng.normal(size=(m, count)), rng.normal(size=m)
        found = pushing_of(columns, wanted)
        known = nnls(columns, wanted)[1] if count else float(np.linalg.norm(wanted))
        assert found.miss == pytest.approx(known, abs=1e-9)
        assert found.force.min(initial=0.0) >= 0.0
        assert np.linalg.norm(columns @ found.force - wanted) == pytest.approx(known, abs=1e-9)
    all_press = pushing_of(np.eye(3), np.array([1.0, 2.0, 3.0]))
    assert all_press.force.tolist() == [1.0, 2.0, 3.0]
    assert all_press.miss == 0.0
    none = pushing_of(np.eye(2), np.array([-3.0, -4.0]))
    assert none.force.tolist() == [0.0, 0.0]
    assert none.miss == 5.0
    # columns that are nearly one: as near, with moderate forces
    close = np.array([[1.0, 1.0 + 1e-9], [0.0, 1e-9]])
    found = pushing_of(close, np.array([1.0, 0.0]))
    assert found.miss == pytest.approx(0.0, abs=1e-8)
    assert found.force.sum() == pytest.approx(1.0)


def left_pressing(columns: Floats, wanted: Floats, pressing: list[int], force: Floats) -> list[int]:
    """Who still presses, by the rule: straight to the best, whoever would pull first leaves."""
    force = force.copy()
    while pressing:
        best = np.linalg.lstsq(columns[:, pressing], wanted, rcond=None)[0]
        if best.min() > 0.0:
            break
        share = {
            j: force[j] / (force[j] - b) for j, b in zip(pressing, best, strict=True) if b <= 0
        }
        way = min(share.values())
        force[pressing] += way * (best - force[pressing])
        pressing = [j for j in pressing if share.get(j, 1.0) > way]
    return pressing


def test_from_forces_that_press_those_that_would_pull_first_are_left_out() -> None:
    rng = np.random.default_rng(4)
    rounds = {0: 0, 1: 0, 2: 0, 3: 0}
    for _ in range(150):
        count = int(rng.integers(1, 6))
        columns, wanted = rng.normal(size=(6, count + 1)), rng.normal(size=6)
        which = rng.permutation(count + 1)[:count]
        start = np.zeros(count + 1)
        start[which] = rng.exponential(size=count)
        force, pressing, presses = start.copy(), which.copy(), start > 0.0
        best = np.full(count, np.nan)
        now = _without_pulling(columns, wanted, pressing, count, presses, force, best)
        known = left_pressing(columns, wanted, which.tolist(), start)
        rounds[min(3, count - len(known))] += 1
        assert pressing[:now].tolist() == known
        assert np.flatnonzero(presses).tolist() == sorted(known)
        own = np.zeros(count + 1)
        if known:
            own[known] = np.linalg.lstsq(columns[:, known], wanted, rcond=None)[0]
        assert force == pytest.approx(own)
        assert force.min() >= 0.0
        miss = [np.linalg.norm(columns @ f - wanted) for f in (start, force)]
        assert miss[1] <= miss[0] + 1e-12
    assert min(rounds.values()) > 5
    # a force of nothing does not press, exactly; and nobody may be left
    force, pressing, presses = np.ones(2), np.arange(2), np.ones(2, np.bool_)
    args = (pressing, 2, presses, force, np.empty(2))
    assert _without_pulling(np.eye(2), np.array([3.0, 0.0]), *args) == 1
    assert (force.tolist(), presses.tolist()) == ([3.0, 0.0], [True, False])
    force, presses = np.zeros(2), np.array([False, True])
    args = (np.array([1, 0]), 1, presses, force, np.empty(2))
    assert _without_pulling(np.eye(2), np.array([3.0, -1.0]), *args) == 0
    assert not presses.any()


class Setting:
    """Features of a random target."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([seed, 31])
        target = random_target(self.rng, radius=float(self.rng.uniform(0.01, 0.08)))
        self.outline = Outline(target.vertices)
        hand = HandShape.from_contacts(target.contacts)
        self.features = Features(self.outline, target.radius, hand)
        self.sides = self.features.sides
        self.v = self.features.as_hand(target.contacts)
        self.n = len(self.sides.start)

    def fingers(self, v: Floats) -> Floats:
        """(fingers,) complex."""
        return np.asarray(self.features.fingers(v)) @ [1.0, 1j]

    def near(self, v: Floats, reach: float, beyond: float) -> list[int]:
        """Features by their definition: where a finger is along an edge, or from a vertex."""
        s, found = self.sides, []
        start, way, out = (a @ [1.0, 1j] for a in (s.start, s.way, s.out))
        for f, p in enumerate(self.fingers(v)):
            at = p - start
            gap, along = (at * np.conj(out)).real - s.radius, (at * np.conj(way)).real
            on = (np.abs(gap) <= reach) & (along >= -beyond) & (along <= s.length + beyond)
            round_it = (np.abs(np.abs(at) - s.radius) <= reach) & (along <= beyond)
            round_it &= np.roll(along - s.length, 1) >= -beyond
            found += [2 * self.n * f + q for q in np.flatnonzero(on)]
            found += [2 * self.n * f + self.n + q for q in np.flatnonzero(round_it & s.convex)]
        return found


@pytest.mark.parametrize("seed", range(8))
def test_features_near_a_hand_by_their_definition(seed: int) -> None:
    s = Setting(seed)
    count = 0
    for reach in (1e-3, 0.05, 0.4):
        v = s.v + reach * 0.5 * s.rng.normal(size=4)
        known = s.near(v, reach, reach)
        assert near_features(s.sides, v, reach, reach).tolist() == known
        count += len(known)
        fingers = len({k // (2 * s.n) for k in known})
        which = np.array(known, np.int64)
        assert _fingers_of(s.sides, which, len(known)) == fingers
        here = felt(s.sides, v, reach)
        if fingers < 2:
            assert len(here.which) == len(here.gap) == len(here.force) == 0
            continue
        assert here.which.tolist() == known
        m = len(known)
        value, normal, slope = np.empty(m), np.empty((m, 2)), np.empty((m, 4))
        put_gaps(s.sides, v, which, len(known), value, normal, slope)
        gaps = s.features.gaps(v, s.features.named(which))
        assert value == pytest.approx(gaps.value, abs=1e-12)
        assert normal == pytest.approx(gaps.normal, abs=1e-12)
        assert slope == pytest.approx(gaps.slope, abs=1e-12)
        assert here.gap.tolist() == value.tolist()
        wanted = np.array([0.0, 0.0, v[2], v[3]])
        gap, pushed = _pushing_at(s.sides, v, which, len(known))
        assert gap.tolist() == value.tolist()
        assert pushed.miss == pytest.approx(nnls(slope.T, wanted)[1], abs=1e-9)
        assert here.force.tolist() == pushed.force.tolist()
    assert count > 3


@pytest.mark.parametrize("seed", range(8))
def test_hands_nearly_balanced_are_the_first_of_their_features(seed: int) -> None:
    s = Setting(seed)
    reach, share = 0.02, 0.6
    hands = s.v + 0.02 * s.rng.normal(size=(60, 4)) * s.rng.random((60, 1))
    hands[10] = hands[3]
    hands[11] = s.v
    hands[40:45, :2] += 30.0  # nothing near
    seen: set[tuple[int, ...]] = set()
    known = []
    for row, v in enumerate(hands):
        features = tuple(s.near(v, reach, 0.0))
        if len({k // (2 * s.n) for k in features}) < 2 or features in seen:
            continue
        seen.add(features)
        which = np.array(features, np.int64)
        _, pushed = _pushing_at(s.sides, v, which, len(which))
        if pushed.miss <= share * np.hypot(v[2], v[3]):
            known.append(row)
    assert nearly_balanced(s.sides, hands, reach, share).tolist() == known
    assert len(seen) > 1
    many = s.v + 0.03 * s.rng.normal(size=(600, 4)) * s.rng.random((600, 1))
    kinds: dict[tuple[int, ...], int] = {}  # more than the table begins with
    for row, v in enumerate(many):
        kinds.setdefault(tuple(s.near(v, reach, 0.0)), row)
    rows = [
        row for key, row in kinds.items()
        if len({k // (2 * s.n) for k in key}) > 1
        and _pushing_at(s.sides, many[row], np.array(key), len(key))[1].miss
        <= share * np.hypot(*many[row, 2:])
    ]  # fmt: skip
    assert nearly_balanced(s.sides, many, reach, share).tolist() == rows
    assert nearly_balanced(s.sides, hands, reach, 1e9).tolist() != []


@pytest.mark.parametrize("seed", range(10))
def test_newton_finds_the_hand_that_forces_balance(seed: int) -> None:
    s = Setting(seed)
    which = near_features(s.sides, s.v, 1e-7, 1e-7)
    _, pushed = _pushing_at(s.sides, s.v, which, len(which))
    which = which[pushed.force > 1e-6]
    start = s.v + 1e-3 * s.rng.normal(size=4)
    found = newton(s.sides, start, which)
    assert start.tolist() != found.v.tolist()
    if found.ended != Ended.SOLVED:
        assert found.ended in (Ended.FAILED, Ended.IRREGULAR)
        return
    m = len(which)
    value, normal, slope = np.empty(m), np.empty((m, 2)), np.empty((m, 4))
    put_gaps(s.sides, found.v, which, m, value, normal, slope)
    assert np.abs(value).max() <= 1e-10
    assert found.force @ slope == pytest.approx([0.0, 0.0, *found.v[2:]], abs=1e-9)
    five = np.concatenate([which, which])[:5]
    if len(five) == 5:
        assert newton(s.sides, start, five).ended == Ended.IRREGULAR
    twice = np.concatenate([which[:1], which])[:4]
    assert newton(s.sides, start, twice).ended == Ended.IRREGULAR


def test_newton_solves_most_targets_and_says_where_it_cannot() -> None:
    ends = []
    for seed in range(10):
        s = Setting(seed)
        which = near_features(s.sides, s.v, 1e-7, 1e-7)
        _, pushed = _pushing_at(s.sides, s.v, which, len(which))
        which = which[pushed.force > 1e-6]
        ends.append(newton(s.sides, s.v + 1e-3, which).ended)
        far = newton(s.sides, s.v + 3.0 * s.rng.normal(size=4), which)
        if far.ended == Ended.SOLVED:
            value, normal, slope = np.empty(9), np.empty((9, 2)), np.empty((9, 4))
            put_gaps(s.sides, far.v, which, len(which), value, normal, slope)
            assert np.abs(value[: len(which)]).max() <= 1e-10
    assert ends.count(Ended.SOLVED) >= 7


@pytest.mark.parametrize("seed", range(8))
def test_a_step_of_closing_is_the_best_inside_the_half_planes(seed: int) -> None:
    """Least |w|^2 + 1e-3 |step|^2: the multipliers of what is tight say so."""
    s = Setting(seed)
    v = s.v.copy()
    v[2:] *= 1.05
    stride = 0.05
    room = s.n * len(s.sides.maps)
    slope, gap = np.full((room, 4), np.nan), np.full(room, np.nan)
    count = _half_planes(s.sides, v, 3.0 * stride, slope, gap)
    known = []
    for f, p in enumerate(s.fingers(v)):
        for q in range(s.n):
            a, way = complex(*s.sides.start[q]), complex(*s.sides.way[q])
            t = np.clip(((p - a) * np.conj(way)).real, 0.0, s.sides.length[q])
            off = p - a - t * way
            if 1e-9 < abs(off) < s.sides.radius + 3.0 * stride:
                n = off / abs(off)
                known.append([*(n.real * s.sides.maps[f, 0] + n.imag * s.sides.maps[f, 1]),
                              abs(off) - s.sides.radius])  # fmt: skip
    assert count == len(known) > 0
    assert np.column_stack([slope, gap])[:count] == pytest.approx(np.array(known), abs=1e-9)
    sigma = float(np.hypot(*v[2:]))
    one = descend(s.sides, v.copy(), sigma, stride, 1)
    assert one.steps == 1
    assert one.sigma == pytest.approx(np.hypot(*one.v[2:]))
    step = one.v - v
    moves = np.abs(np.asarray(s.features.fingers(step)) @ [1.0, 1j])
    assert moves.max() <= stride * (1.0 + 1e-9)
    if moves.max() < stride * (1.0 - 1e-9):
        left = gap[:count] + slope[:count] @ step
        assert left.min() >= -1e-9
        gradient = np.array([0.0, 0.0, *one.v[2:]]) + [1e-3, 1e-3, 0, 0] * step
        wanted = gradient
        _, miss = nnls(slope[:count][left < 1e-8].T, wanted)
        assert miss < 1e-3 * sigma + 1e-9
    more = descend(s.sides, v.copy(), sigma, stride, 40)
    assert more.sigma <= one.sigma + 1e-12
    assert more.ended in (Ended.STANDS, Ended.MOVING, Ended.LOST)
    if more.ended == Ended.STANDS:
        again = descend(s.sides, more.v.copy(), more.sigma, stride, 5)
        assert (again.ended, again.steps) == (Ended.STANDS, 1)
        assert again.sigma == pytest.approx(more.sigma, abs=1e-9)
    assert descend(s.sides, v.copy(), sigma, stride, 0)[2:] == (sigma, 0)
    away = v + [90.0, 90.0, 0.0, 0.0]
    lost = descend(s.sides, away, sigma, stride, 7)
    assert (lost.ended, lost.steps) == (Ended.LOST, 0)
    assert lost.v.tolist() == away.tolist()
