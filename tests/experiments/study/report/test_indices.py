"""Sobol indices against functions whose indices are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import norm, qmc, sobol_indices

from experiments.io.intervals import wilson
from experiments.study.report.indices import (
    FEWEST,
    RAREST,
    Index,
    Indices,
    design_rows,
    layout,
    sobol,
    split,
)
from icage.arrays import FloatArray
from icage.errors import InputError

Function = Callable[[FloatArray], FloatArray]
"""Of points (D, N), uniform in the unit cube."""


def study(function: Function, groups: list[list[int]], base: int, seed: int = 0) -> Indices:
    """The indices of groups of columns, through the trial order of a whole study."""
    dimensions = sum(len(group) for group in groups)
    sample = qmc.Sobol(2 * dimensions, rng=np.random.default_rng([seed, 1])).random(base).T
    a, b = sample[:dimensions], sample[dimensions:]
    base_point, member = layout(np.arange(design_rows(base, len(groups))), len(groups))
    points = a[:, base_point].copy()
    for column in range(dimensions):
        number = next(g for g, group in enumerate(groups) if column in group)
        from_b = (member == 1) | (member == 2 + number)
        points[column, from_b] = b[column, base_point[from_b]]
    names = [f"g{number}" for number in range(len(groups))]
    outcomes = split(function(points), len(groups))
    return sobol(*outcomes, names, np.random.default_rng([seed, 2]))


def known(result: Indices) -> tuple[Index, ...]:
    assert result.groups is not None, result.why
    return result.groups


def ishigami(u: FloatArray) -> FloatArray:
    x = np.pi * (2.0 * u - 1.0)
    return np.sin(x[0]) + 7.0 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0])


def check(result: Indices, first: list[float], total: list[float], near: float) -> None:
    """Estimates near the truth, and the truth in their intervals."""
    for index, true_first, true_total in zip(known(result), first, total, strict=True):
        assert index.first == pytest.approx(true_first, abs=near)
        assert index.total == pytest.approx(true_total, abs=near)
        assert index.first_low - 1e-12 <= true_first <= index.first_high
        assert index.total_low - 1e-12 <= true_total <= index.total_high
        assert index.first_low <= index.first <= index.first_high
        assert index.total_low <= index.total <= index.total_high


def test_ishigami():
    v1, v2, v13 = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 8.0 * np.pi**8 / 22_500.0
    v = v1 + v2 + v13
    first, total = [v1 / v, v2 / v, 0.0], [(v1 + v13) / v, v2 / v, v13 / v]
    result = study(ishigami, [[0], [1], [2]], 1024)
    assert result.base == 1024
    check(result, first, total, near=0.03)
    grouped = study(ishigami, [[0, 2], [1]], 1024)
    check(grouped, [(v1 + v13) / v, v2 / v], [(v1 + v13) / v, v2 / v], near=0.03)


def test_groups_that_interact():
    """x1 + 2 x2 + 3 x1 x3, standard normal: variances 1, 4 and 9."""

    def function(u: FloatArray) -> FloatArray:
        x = norm.ppf(u)
        return x[0] + 2.0 * x[1] + 3.0 * x[0] * x[2]

    result = study(function, [[0], [1, 2]], 1024)
    check(result, [1 / 14, 4 / 14], [10 / 14, 13 / 14], near=0.05)
    together = study(function, [[0, 2], [1]], 1024)
    check(together, [10 / 14, 4 / 14], [10 / 14, 4 / 14], near=0.05)


def test_an_outcome_of_0_or_1():
    """1 if x1 + x2 > 1, whatever x3: S = 1/3 and T = 2/3 each; x3 changes nothing."""
    result = study(lambda u: u[0] + u[1] > 1.0, [[0], [1], [2]], 1024)
    *two, idle = known(result)
    for index in two:
        assert index.first == pytest.approx(1 / 3, abs=0.05)
        assert index.total == pytest.approx(2 / 3, abs=0.05)
        assert index.first_low < 1 / 3 < index.first_high
        assert index.total_low < 2 / 3 < index.total_high
    assert (idle.first, idle.total) == (0.0, 0.0)
    assert (idle.first_low, idle.total_low) == (0.0, 0.0)
    assert idle.total_high == pytest.approx(wilson(0, 1024)[1] / 0.5, rel=0.01)  # not 0
    assert idle.first_high == idle.total_high
    additive = study(lambda u: 1.0 * (u[0] < 0.3) + (u[1] < 0.3), [[0], [1]], 512)
    check(additive, [0.5, 0.5], [0.5, 0.5], near=0.05)


def test_one_group_is_everything():
    (only,) = known(study(lambda u: u[0] < 0.3, [[0]], 512))
    assert only.total == pytest.approx(1.0, abs=0.1)
    assert only.first == pytest.approx(1.0, abs=0.1)


def test_the_same_seed_the_same_interval():
    rng = np.random.default_rng(1)
    f_a, f_b, f_ab = rng.random(64), rng.random(64), rng.random((2, 64))
    one, again, other = (
        sobol(f_a, f_b, f_ab, ("p", "q"), np.random.default_rng(seed)) for seed in (7, 7, 8)
    )
    assert one == again
    assert one != other
    theirs = sobol_indices(func={"f_A": f_a[None], "f_B": f_b[None], "f_AB": f_ab[:, None]}, n=64)
    assert [index.first for index in known(one)] == pytest.approx(theirs.first_order)
    assert [index.total for index in known(one)] == pytest.approx(theirs.total_order)
    assert [index.name for index in known(one)] == ["p", "q"]


def test_a_prefix_of_a_study_is_cut_to_balanced_base_points():
    values = np.random.default_rng(2).random(design_rows(100, 3))
    f_a, f_b, f_ab = split(values[:-2], 3)
    assert f_a.shape == f_b.shape == (99,)
    assert f_ab.shape == (3, 99)
    assert f_b[7] == values[7 * 5 + 1]
    assert f_ab[2, 98] == values[98 * 5 + 4]
    result = sobol(f_a, f_b, f_ab, "abc", np.random.default_rng(0))
    assert result.base == 64
    first64 = sobol(f_a[:64], f_b[:64], f_ab[:, :64], "abc", np.random.default_rng(0))
    assert result == first64
    empty = split(values[:4], 3)
    assert [part.shape for part in empty] == [(0,), (0,), (3, 0)]
    assert known_why(sobol(*empty, "abc", np.random.default_rng(0))).startswith("0 base points")


def known_why(result: Indices) -> str:
    assert result.groups is None
    assert result.why is not None
    return result.why


def test_outcomes_without_indices():
    rng = np.random.default_rng(0)
    same, few = np.ones(64), np.zeros(64)
    few[: RAREST - 1] = 1.0

    def why(f_a: FloatArray, f_b: FloatArray) -> str:
        return known_why(sobol(f_a, f_b, np.stack([f_b, f_a]), "ab", rng))

    assert why(same, same) == "all 128 outcomes of A and B are 1: no variance to share out"
    assert why(few, 0.0 * same) == "only 9 of 128 outcomes of A and B are not 0: too few"
    assert why(np.where(few, np.nan, 1.0), same) == "18 outcomes are not finite"
    assert why(same[: FEWEST - 1], few[: FEWEST - 1]) == "16 base points; at least 32 are needed"
    with pytest.raises(InputError, match=r"outcomes of 2 groups.*\(64,\) and \(1, 64\)"):
        sobol(same, same, same[None], "ab", rng)
