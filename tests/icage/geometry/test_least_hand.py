"""The smallest hand among half spaces: against scipy's solver, and by what makes it smallest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog, minimize, nnls

from icage.arrays import FloatArray
from icage.geometry.least_hand import least_hand

Z = np.array([0.0, 1.0, 0.4 + 0.8j])


def half_spaces(rng: np.random.Generator, count: int, *, square: bool) -> FloatArray:
    """Rows (count, 4): edges that fingers keep to; at right angles where ``square``."""
    turn = rng.integers(0, 4, count) * np.pi / 2 if square else rng.uniform(0, 2 * np.pi, count)
    n = np.exp(1j * turn)
    g = n * np.conj(Z[rng.integers(0, 3, count)])
    return np.column_stack([n.real, n.imag, g.real, g.imag])


def scipys(rows: FloatArray, levels: FloatArray) -> FloatArray | None:
    """What SLSQP finds from a hand that is inside, None if there is none."""
    free = [(None, None)] * 4
    inside = linprog(np.zeros(4), A_ub=-rows, b_ub=-levels, bounds=free)
    if inside.status == 2:
        return None
    found = minimize(
        lambda v: v[2] ** 2 + v[3] ** 2, inside.x, jac=lambda v: v * [0.0, 0.0, 2.0, 2.0],
        constraints={"type": "ineq", "fun": lambda v: rows @ v - levels, "jac": lambda v: rows},
        method="SLSQP", options={"ftol": 1e-15, "maxiter": 500},
    )  # fmt: skip
    return found.x


@pytest.mark.parametrize("square", [False, True])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 8, 14, 40])
def test_the_opening_is_that_of_scipys_solver(count: int, square: bool):
    rng = np.random.default_rng([count, square])
    kinds = {"none": 0, "shut": 0, "held": 0}
    for _ in range(60):
        rows = half_spaces(rng, count, square=square)
        levels = rng.uniform(-0.6 if count > 4 else -0.2, 0.3 if count < 40 else 0.02, count)
        known = scipys(rows, levels)
        v = least_hand(rows, levels, rng.uniform(-0.1, 0.1, 2))
        assert (v is None) == (known is None)
        if v is None or known is None:
            kinds["none"] += 1
            continue
        assert (rows @ v - levels).min() >= -1e-11
        assert np.hypot(v[2], v[3]) <= np.hypot(known[2], known[3]) + 1e-9
        assert (rows @ known - levels).min() >= -1e-6
        assert np.hypot(v[2], v[3]) >= np.hypot(known[2], known[3]) - 1e-6
        kinds["held" if np.hypot(v[2], v[3]) > 1e-9 else "shut"] += 1
    if count >= 3:
        assert kinds["held"] >= 5


@pytest.mark.filterwarnings("error")
def test_no_hand_is_smaller_to_rounding():
    """Some rows that are met exactly balance w: all others are further off."""
    rng = np.random.default_rng(0)
    held = 0
    for _ in range(300):
        count = int(rng.integers(3, 8))
        rows = half_spaces(rng, count, square=False)
        levels = rng.uniform(-0.2, 0.3, count)
        v = least_hand(rows, levels, np.zeros(2))
        if v is None or np.hypot(v[2], v[3]) < 1e-6:
            continue
        tight = rows[rows @ v - levels <= 1e-11 * (1.0 + np.abs(v).max())]
        wanted = np.array([0.0, 0.0, v[2], v[3]])
        force, miss = nnls(tight.T, wanted)
        assert miss <= 1e-9 * (1.0 + force.max())
        held += 1
    assert held >= 100


def test_where_it_may_slide_it_is_nearest():
    """Two fingers between parallel walls, seen from inside: along them d is free."""
    rows = np.array([[0.0, 1.0, 0.0, 1.0], [0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]])
    levels = np.array([0.5, 0.1, -0.2])
    for x, expected in ((0.3, 0.3), (-0.1, -0.1), (-5.0, -0.2)):
        v = least_hand(rows, levels, np.array([x, 7.0]))
        assert v is not None
        np.testing.assert_allclose(v, [expected, -0.1, 0.0, 0.6], atol=1e-15)


def test_walls_that_contradict_each_other_leave_none():
    rows = np.array([[1.0, 0.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0]])
    assert least_hand(rows, np.array([0.1, 0.1]), np.zeros(2)) is None
    assert least_hand(rows, np.array([0.1, -0.1]), np.zeros(2)) is not None
