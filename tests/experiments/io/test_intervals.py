"""Wilson's intervals against scipy's and against what they promise; stopping early."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from experiments.io.intervals import (
    AT_LEAST,
    LOOK_EVERY,
    exact_coverage,
    half_width,
    rate_upper,
    stopped_at,
    wilson,
    wilson_bounds,
)
from tests.oracles.against_itself.stopping import exact_stops, looks, simulated_stops


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
@pytest.mark.parametrize("trials", [1, 2, 7, 200, 1000, 100_000])
def test_wilson_is_that_of_scipy(trials: int, confidence: float):
    for successes in {0, 1, trials // 2, trials - 1, trials}:
        theirs = binomtest(successes, trials).proportion_ci(confidence, method="wilson")
        ours = wilson(successes, trials, confidence)
        assert ours == pytest.approx((theirs.low, theirs.high), rel=1e-12, abs=1e-15)


def test_known_values():
    assert wilson(0, 0) == (0.0, 1.0)
    z2 = 1.959963984540054**2
    assert wilson(0, 10) == (0.0, pytest.approx(z2 / (10 + z2)))
    assert wilson(10, 10) == (pytest.approx(10 / (10 + z2)), 1.0)
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)  # Newcombe 1998, table I
    assert rate_upper(0, 200) == pytest.approx(1.0 - 0.05 ** (1.0 / 200.0), rel=1e-12)
    assert rate_upper(24, 24) == 1.0
    assert 0.1 < rate_upper(1, 24) < 0.2


def test_one_sided_bound_against_scipy():
    for successes, trials in ((0, 50), (3, 24), (199, 200)):
        theirs = binomtest(successes, trials, alternative="less").proportion_ci(0.95, "exact")
        assert rate_upper(successes, trials) == pytest.approx(theirs.high, rel=1e-12)


def test_arrays_broadcast_and_agree_with_one_at_a_time():
    successes, trials = np.array([0, 3, 10]), np.array([[10], [20]])
    low, high = wilson_bounds(successes, trials)
    assert low.shape == high.shape == half_width(successes, trials).shape == (2, 3)
    for row, n in enumerate((10, 20)):
        for column, k in enumerate((0, 3, 10)):
            assert (low[row, column], high[row, column]) == wilson(k, n)
    assert np.all((low >= 0.0) & (low <= successes / trials))
    assert np.all((high <= 1.0) & (high >= successes / trials))


@pytest.mark.parametrize(("rate", "trials"), [(0.9, 200), (0.99, 1000)])
def test_simulated_coverage_is_the_exact_one(rate: float, trials: int):
    counts = np.random.default_rng(2018).binomial(trials, rate, 20_000)
    low, high = wilson_bounds(counts, trials)
    simulated = ((low <= rate) & (rate <= high)).mean()
    assert simulated == pytest.approx(exact_coverage(rate, trials), abs=0.01)


def test_exact_coverage_by_hand():
    theirs = [binomtest(k, 20).proportion_ci(method="wilson") for k in range(21)]
    held = [k for k, interval in enumerate(theirs) if interval.low <= 0.9 <= interval.high]
    assert exact_coverage(0.9, 20) == pytest.approx(binom.pmf(held, 20, 0.9).sum())
    assert exact_coverage(0.5, 1) == pytest.approx(1.0)  # [0, 0.79] or [0.21, 1]


def test_stopping_rule():
    rng = np.random.default_rng(5)
    successes = rng.random(20_000) < 0.9
    stop = stopped_at(successes, 0.01)
    assert stop is not None
    assert stop % LOOK_EVERY == 0
    assert half_width(int(successes[:stop].sum()), stop) <= 0.01
    earlier = stop - LOOK_EVERY
    assert half_width(int(successes[:earlier].sum()), earlier) > 0.01
    assert stopped_at(successes[:stop], 0.01) == stop  # what comes later changes nothing
    assert stopped_at(successes[: stop - 1], 0.01) is None
    assert stopped_at(successes[: AT_LEAST - 1], 0.5) is None
    assert stopped_at(successes, 0.5) == AT_LEAST
    assert stopped_at(successes, 0.2, look_every=7, at_least=30) == 30
    assert stopped_at(np.zeros(0, dtype=bool), 0.5) is None


def test_the_benchmark_stops_as_the_rule_does():
    """Trial by trial with ``stopped_at``, from counts, and without chance: one coverage."""
    rate, wanted, runs = 0.97, 0.01, 2000
    trials = np.random.default_rng(3).random((runs, 3500)) < rate
    stops = [stopped_at(one, wanted) for one in trials]
    seen = [
        wilson(int(one[:stop].sum()), stop or 0) for one, stop in zip(trials, stops, strict=True)
    ]
    held = np.mean([low <= rate <= high for low, high in seen])
    coverage, length = exact_stops(rate, wanted)
    assert held == pytest.approx(coverage, abs=0.02)
    assert np.mean([stop or np.nan for stop in stops]) == pytest.approx(length, rel=0.02)
    counted = simulated_stops(rate, wanted, 20_000, np.random.default_rng(4))
    assert counted == pytest.approx((coverage, length), rel=0.01)
    pairs = looks()
    assert [next(pairs), next(pairs)] == [(0, AT_LEAST), (AT_LEAST, AT_LEAST + LOOK_EVERY)]


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.97, 0.99])
@pytest.mark.parametrize("wanted", [0.01, 0.02])
def test_stopping_costs_no_coverage(rate: float, wanted: float):
    """What the docstring of ``stopped_at`` says."""
    assert 0.947 < exact_stops(rate, wanted)[0] < 0.969
