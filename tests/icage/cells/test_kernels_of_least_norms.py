"""Least norms in half planes: by brute force, fractions and the rules written a second time."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import nnls

from icage.cells.kernels.min_norm import (
    FOUND,
    INFEASIBLE,
    UNSURE,
    _certified,
    _most_violated,
    min_norm,
    min_norm_careful,
)
from icage.cells.kernels.passes import _put
from tests.oracles.geometry import Floats
from tests.oracles.half_planes import least_norm

pytestmark = pytest.mark.usefixtures("plain")


def half_planes(rng: np.random.Generator, n: int) -> Floats:
    """Rows g . w >= c with |g| = 1, with an error that is rounding."""
    angle = rng.uniform(0.0, 2.0 * np.pi, n)
    level = rng.normal(size=n) * 0.4
    error = np.full(n, 1e-15)
    return np.column_stack([np.cos(angle), np.sin(angle), level, error, error])


@pytest.mark.parametrize("count", [1, 2, 3, 5, 9])
def test_the_least_norm_in_half_planes(count: int) -> None:
    rng = np.random.default_rng(count)
    kinds = {INFEASIBLE: 0, FOUND: 0, UNSURE: 0}
    for _ in range(60):
        rows = half_planes(rng, count)
        known = least_norm(rows[:, :2], rows[:, 2], 1e-11)
        found = min_norm(rows, count, 1e-11)
        kinds[found.status] += 1
        if found.status != UNSURE:
            assert (found.status == FOUND) == (known < np.inf)
            if known < np.inf:
                assert np.hypot(found.w_x, found.w_y) == pytest.approx(known, abs=1e-10)
                w = np.array([found.w_x, found.w_y])
                assert (rows[:, :2] @ w >= rows[:, 2] - 1e-10).all()
        pairs = np.zeros((count, 6))
        pairs[:, ::2] = rows[:, :3]
        careful = min_norm_careful(pairs, count, 1e-24)
        assert (careful.status == FOUND) == (known < np.inf)
        if known < np.inf:
            assert np.hypot(careful.w_x, careful.w_y) == pytest.approx(known, abs=1e-10)
    assert kinds[UNSURE] <= 1
    assert kinds[FOUND] >= 5
    assert count < 3 or kinds[INFEASIBLE] > 0
    assert min_norm(rows, 0, 1e-12) == (FOUND, 0.0, 0.0)


def of_points(
    rng: np.random.Generator, rows: list[Floats], c: list[float], rounding: Floats, error: Floats
) -> Floats:
    """Rows of half planes in any order."""
    table = np.column_stack([np.array(rows), c, error, rounding])
    return table[rng.permutation(len(table))]


@pytest.mark.parametrize("size", [1.0, 40.0, 1e-3])
def test_the_least_norm_is_as_good_as_the_rounding_that_it_is_told(size: float) -> None:
    """Forty rows that hold a point, some through it; c may be off by ``rounding``, either way.

    ``FOUND`` is within ``worst`` of the least norm whatever c is, and where nothing is thin it is
    not ``UNSURE``. What may be given besides counts for no value.
    """
    rng = np.random.default_rng(7)
    kinds = {INFEASIBLE: 0, FOUND: 0, UNSURE: 0}
    worst, vertices = 1e-6 * size, 0
    for trial in range(60):
        point = size * rng.normal(size=2)
        angle = np.angle(point @ [1.0, 1j]) + rng.uniform(-1.4, 1.4, 40)
        g = np.column_stack([np.cos(angle), np.sin(angle)])
        free = size * rng.exponential(size=40)
        free[:5] = 0.0
        c = g @ point - free
        rounding = 10.0 ** rng.uniform(-9.0, -6.5 if trial % 2 else -5.5, 40) * size
        error = rounding + 1e-3 * size
        found = min_norm(of_points(rng, list(g), list(c), rounding, error), 40, worst)
        kinds[found.status] += 1
        if found.status != FOUND:
            continue
        off = [rounding, -rounding, rounding * rng.choice([-1.0, 1.0], 40)]
        norms = [least_norm(g, c + o, 1e-12 * size) for o in off]
        value = float(np.hypot(found.w_x, found.w_y))
        assert max(abs(v - value) for v in norms) <= 1.001 * worst
        vertices += abs(value - c.max()) > worst
    assert kinds[FOUND] >= 25
    assert kinds[UNSURE] >= 5
    assert kinds[INFEASIBLE] == 0
    assert vertices > 5


@pytest.mark.parametrize("size", [1.0, 40.0, 1e-3])
def test_no_point_is_said_where_there_is_none_with_all_that_is_given(size: float) -> None:
    """Rows that exclude each other by a part of their errors, or by many times of them."""
    rng = np.random.default_rng(8)
    said = {0.5: 0, 50.0: 0}
    for trial in range(120):
        factor = (0.5, 50.0)[trial % 2]
        opposite = trial % 4 < 2
        turn = rng.uniform(0.0, 2.0 * np.pi)
        apart = [0.0, np.pi] if opposite else [0.0, rng.uniform(1.7, 2.6), rng.uniform(3.7, 4.5)]
        g = np.array([[np.cos(turn + a), np.sin(turn + a)] for a in apart])
        error = 10.0 ** rng.uniform(-7.0, -5.0, len(g)) * size
        weight = nnls(np.vstack([g.T, np.ones(len(g))]), np.array([0.0, 0.0, 1.0]))[0]
        c = g @ (size * rng.normal(size=2))
        c += factor * (weight @ error) / weight.sum()  # sum of weight * g is 0: sum of c decides
        table = of_points(rng, list(g), list(c), 1e-3 * error, error)
        found = min_norm(table, len(table), 1e-4 * size)
        given = least_norm(g, c - error, 1e-12 * size)
        assert (given < np.inf) == (factor < 1.0)
        if factor < 1.0:
            assert found.status != INFEASIBLE
        assert found.status != FOUND
        said[factor] += found.status == INFEASIBLE
    assert said[50.0] == 60


def test_three_rows_exclude_each_other_beyond_four_times_their_doubt() -> None:
    """On the line of the last row the other two leave less than nothing, by so much."""
    rng = np.random.default_rng(10)
    told = {INFEASIBLE: 0, UNSURE: 0}
    for _ in range(300):
        turn = rng.uniform(0.0, 2.0 * np.pi)
        angle = turn + np.array([0.0, rng.uniform(1.2, 2.9), rng.uniform(3.4, 5.0)])
        g = np.column_stack([np.cos(angle), np.sin(angle)])
        weight = nnls(np.vstack([g.T, np.ones(3)]), np.array([0.0, 0.0, 1.0]))[0]
        error = 10.0 ** rng.uniform(-4.0, -2.0, 3)
        c = g @ rng.normal(size=2) + rng.uniform(3.0, 9.0) * weight @ error
        if weight.min() < 0.02 or c.max() <= 0.0:
            continue
        # the furthest, the one its foot violates most, and what is left at their corner
        first = int(np.argmax(c))
        second = int(np.argmax(c - g @ (c[first] * g[first])))
        if second == first or g[first] @ (c[second] * g[second]) >= c[first]:
            continue
        last = 3 - first - second
        corners = [np.linalg.solve(g[[q, last]], c[[q, last]]) for q in (first, second)]
        apart = float(np.hypot(*(corners[0] - corners[1])))
        doubt = sum((error[q] + error[last]) / abs(np.sin(angle[q] - angle[last]))
                    for q in (first, second))  # fmt: skip
        if abs(apart / doubt - 4.0) < 0.01:
            continue
        table = np.column_stack([g, c, error, 1e-12 * error])
        status = min_norm(table, 3, 1.0).status
        assert status == (INFEASIBLE if apart > 4.0 * doubt else UNSURE)
        told[status] += 1
    assert min(told.values()) > 15


def test_parallel_rows_exclude_each_other_beyond_the_rounding_of_their_distance() -> None:
    def asked(c: float, apart: float) -> int:
        rows = np.array([[0.0, 1.0, c, 0.0, 0.0], [0.0, -1.0, apart - c, 0.0, 0.0]])
        return int(min_norm(rows, 2, 1.0).status)

    assert asked(1024.0, 5e-10) == UNSURE
    assert asked(1024.0, 4e-9) == INFEASIBLE
    assert asked(2.0**-10, 1e-13) == INFEASIBLE


def vouched(rows: Floats, w: Floats, tight: list[int], worst: float) -> tuple[bool, float]:
    """Whether a least point is good to ``worst`` by the rule, and how near that is, as a factor.

    Tight rows move it sideways by ``shift``; whatever is then near enough to be tight must leave a
    wedge in which a step makes up for the largest rounding.
    """
    angle, rounding = np.angle(rows[:, :2] @ [1.0, 1j]), rows[:, 4]
    shift, factors = rounding[tight[0]], []
    if len(tight) == 2:
        shift = rounding[tight].sum() / abs(np.sin(angle[tight[0]] - angle[tight[1]]))
    factors.append(10.0 * worst / shift)
    gap, most = rows[:, :2] @ w - rows[:, 2], 4.0 * (rounding + shift)
    near = gap < most
    factors += list(np.abs(gap / most))
    turn = np.angle(np.exp(1j * (angle[near] - np.angle(w @ [1.0, 1j]))))
    room = np.pi - (max(0.0, turn.max()) - min(0.0, turn.min()))
    if room > 0.0:
        factors.append(worst * np.sin(min(0.5 * room, 1.5)) / rounding[near].max())
        factors.append(room / 1e-3)
    good = 10.0 * worst >= shift and (gap >= -most).all() and room >= 1e-3
    good = good and rounding[near].max() <= worst * np.sin(min(0.5 * room, 1.5))
    return bool(good), float(np.abs(np.log(np.maximum(factors, 1e-300))).min())


def test_a_least_point_is_vouched_for_by_its_wedge() -> None:
    rng = np.random.default_rng(11)
    told = [0, 0]
    for trial in range(1200):
        two = trial % 4 > 0
        ahead = rng.uniform(0.0, 2.0 * np.pi)
        w = rng.choice([0.03, 1.0, 30.0]) * np.array([np.cos(ahead), np.sin(ahead)])
        off = [rng.uniform(0.05, 1.55), -rng.uniform(0.05, 1.55)] if two else [0.0]
        if trial % 8 == 5:  # hardly a wedge
            off = [rng.uniform(1.55, 0.5 * np.pi), -0.5 * np.pi + 10.0 ** rng.uniform(-4.0, -2.0)]
        off = [*off, *rng.uniform(-3.0, 3.0, 3)]
        g = np.column_stack([np.cos(ahead + np.array(off)), np.sin(ahead + np.array(off))])
        rounding = 10.0 ** rng.uniform(-6.0, -4.0, len(g))
        c = g @ w
        c[1 + two :] -= rng.choice([-1e-4, 0.0, 1e-5, 1e-4, 0.3], 3) * rng.exponential(size=3)
        rows = np.column_stack([g, c, np.full(len(g), 9.0), rounding])
        tight = [1, 0] if two else [0]
        worst = 10.0 ** rng.uniform(-6.0, -3.0)
        good, close = vouched(rows, w, tight, worst)
        if close < 0.01:
            continue
        found = _certified(rows, len(g), worst, *w, tight[0], tight[1] if two else -1)
        assert found == (FOUND if good else UNSURE)
        told[good] += 1
    assert min(told) > 150
    assert _certified(np.zeros((0, 5)), 0, 1.0, 0.0, 0.0, -1, -1) == FOUND


def test_the_row_that_is_violated_most() -> None:
    rng = np.random.default_rng(9)
    none = 0
    for _ in range(60):
        angle = rng.uniform(0.0, 2.0 * np.pi, 6)
        rounding = rng.exponential(0.3, 6)
        rows = np.column_stack([np.cos(angle), np.sin(angle), rng.normal(size=6) - 0.7,
                                np.full(6, 9.0), rounding])  # fmt: skip
        w = rng.normal(size=2)
        over = rows[:5, 2] - rows[:5, :2] @ w - rounding[:5]
        known = int(np.argmax(over)) if over.max() > 0.0 else -1
        assert _most_violated(rows, 5, *w) == known
        none += known < 0
    assert 5 < none < 55
    # violated by as much as rounding may be: not violated
    assert _most_violated(np.array([[1.0, 0.0, 0.5, 0.0, 0.25]]), 1, 0.25, 9.0) == -1


def test_what_doubles_cannot_tell_is_said() -> None:
    """Parallel rows, a thin wedge, an error that is too large: unsure, unless it is clear."""
    error = 1e-14

    def asked(*rows: tuple[float, float, float], worst: float = 1e-12, off: float = error) -> int:
        table = np.array([(*r, off, off) for r in rows])
        found = min_norm(table, len(table), worst)
        assert found.status != INFEASIBLE or found[1:] == (0.0, 0.0)
        return found.status

    up, down = (0.0, 1.0), (0.0, -1.0)
    assert asked((*up, 0.5), (*down, -0.6)) == FOUND
    assert asked((*up, 0.5), (*down, -0.5 + 1e-13)) == UNSURE
    assert asked((*up, 0.5), (*down, -0.4)) == INFEASIBLE
    assert asked((*down, -0.4), (*up, 0.5)) == INFEASIBLE
    assert asked((*up, 0.5), off=2e-12) == UNSURE
    assert asked((*up, 0.5), off=0.9e-12, worst=1e-12) == FOUND
    tilt = (np.sin(1e-4), -np.cos(1e-4))  # almost down: the corner is 1e4 times as far off
    assert asked((*up, 0.5), (*tilt, -0.5 * np.cos(1e-4) + 1e-6)) == UNSURE
    # three lines through one point that leave hardly a wedge
    corner = np.array([0.3, 0.4])
    g = [np.array([np.cos(a), np.sin(a)]) for a in (0.5, 0.5 + np.pi - 1e-5)]
    assert asked(*[(*r, float(r @ corner)) for r in g]) == UNSURE
    wide = [np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.6)]
    assert asked(*[(*r, float(r @ corner)) for r in wide]) == FOUND
    # three rows that no point satisfies, by little and by much
    star = [np.array([np.cos(a), np.sin(a)]) for a in (0.0, 2.1, 4.2)]
    assert asked(*[(*r, 0.1) for r in star]) == INFEASIBLE
    assert asked(*[(*r, 1e-15) for r in star]) in (UNSURE, FOUND)
    assert asked(*[(*r, 3e-14) for r in star]) == UNSURE


def test_double_doubles_tell_what_doubles_cannot() -> None:
    def asked(*rows: tuple[float, float, float, float], slack: float = 1e-24) -> int:
        """Rows g_x, g_y, c and the low part of c."""
        table = np.array([(r[0], 0.0, r[1], 0.0, r[2], r[3]) for r in rows])
        return min_norm_careful(table, len(table), slack).status

    assert asked((0.0, 1.0, 0.5, 0.0), (0.0, -1.0, -0.5, 0.0)) == FOUND
    assert asked((0.0, 1.0, 0.5, 1e-20), (0.0, -1.0, -0.5, 0.0)) == INFEASIBLE
    assert asked((0.0, 1.0, 0.5, 1e-20), (0.0, -1.0, -0.5, 0.0), slack=1e-19) == FOUND
    assert asked((0.0, 1.0, 0.5, -1e-20), (0.0, -1.0, -0.5, 0.0)) == FOUND
    star = [(np.cos(a), np.sin(a)) for a in (0.0, 2.1, 4.2)]
    assert asked(*[(*r, 1e-20, 0.0) for r in star]) == INFEASIBLE
    assert asked(*[(*r, -1e-20, 0.0) for r in star]) == FOUND


def exact_least_norm(rows: Floats) -> float:
    """Over rows g_x, g_y, c, each hi and lo, in fractions; inf for none."""
    g = [[Fraction(float(r[k])) + Fraction(float(r[k + 1])) for k in (0, 2, 4)] for r in rows]
    tries = [(Fraction(0), Fraction(0))]
    tries += [(x * c / (x * x + y * y), y * c / (x * x + y * y)) for x, y, c in g]
    for (a, b, c), (d, e, f) in combinations(g, 2):
        det = a * e - b * d
        if det != 0:
            tries.append(((c * e - f * b) / det, (a * f - d * c) / det))
    tiny = Fraction(1, 10**24)
    held = [w for w in tries if all(x * w[0] + y * w[1] >= c - tiny for x, y, c in g)]
    return min((float(x * x + y * y) ** 0.5 for x, y in held), default=np.inf)


def test_double_doubles_are_fractions_in_thin_wedges_and_beside_parallel_rows() -> None:
    rng = np.random.default_rng(12)
    corners = 0
    for trial in range(80):
        angle = rng.uniform(0.0, 2.0 * np.pi, 4)
        if trial % 2:  # as good as opposite: the corner is far off, and hangs on the last digits
            angle[1] = angle[0] + np.pi - 10.0 ** rng.uniform(-8.0, -5.0)
        rows = np.zeros((4, 6))
        rows[:, 0], rows[:, 2] = np.cos(angle), np.sin(angle)
        rows[:, 4] = [0.3, -0.2, *rng.normal(size=2)] if trial % 2 else rng.normal(size=4)
        if trial % 2 == 0:
            rows[3, :4], rows[3, 4] = rows[0, :4], rows[0, 4] + 0.1  # the same way, further on
        else:
            rows[2:, 4] = -9.0
            rows[:2, 1::2] = 1e-17 * rng.uniform(-1.0, 1.0, (2, 3))
            rows[1, 4] = -0.3 + 10.0 ** rng.uniform(-9.0, -7.0)
        known = exact_least_norm(rows)
        found = min_norm_careful(rows, 4, 1e-24)
        assert (found.status == FOUND) == (known < np.inf)
        if known < np.inf:
            assert np.hypot(found.w_x, found.w_y) == pytest.approx(known, rel=1e-12)
            corners += known > rows[:, 4].max() * (1.0 + 1e-9)
        else:
            assert found[1:] == (0.0, 0.0)
    assert corners > 20


def test_a_row_without_a_direction_is_left_to_double_doubles() -> None:
    """Where rounding is all there is of g, it is not known whether the row holds."""
    rows = np.full((2, 5), np.nan)

    def put(g: float, c: float, err: float = 1e-14) -> tuple[int, int]:
        count, status = _put(0.6 * g, 0.8 * g, c, err, 0.5 * err, 1.0, 10.0, rows, 1)
        return int(count), int(status)

    assert put(1e-13, 0.0) == (1, UNSURE)
    assert put(1e-13, 1e-12) == (1, UNSURE)
    assert put(1e-13, -1e-12) == (1, UNSURE)
    assert put(1e-13, 1e-11) == (1, INFEASIBLE)
    assert put(1e-13, -1e-11) == (1, FOUND)  # it holds for every hand
    assert np.isnan(rows).all()
    assert put(0.5, 2.0) == (2, FOUND)
    assert rows[1] == pytest.approx([0.6, 0.8, 4.0, 2e-14, 1e-14])
