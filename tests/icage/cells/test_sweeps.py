"""Slices of the big sweeps (benchmarks/sweeps): every way to a level gives the same level."""

from __future__ import annotations

import pytest

from tests.oracles.against_itself import disc_targets, point_targets
from tests.oracles.against_itself.levels import Levels, difference
from tests.oracles.against_itself.outcome import Outcome

SEED = 2018


def check(outcomes: list[Outcome]) -> None:
    for outcome in outcomes:
        assert not outcome.disagreements, (outcome.number, outcome.disagreements)
        assert not outcome.exceptions, (outcome.number, outcome.exceptions)
        assert outcome.runs > 4


def wide_share(outcomes: list[Outcome]) -> float:
    wide = [o for o in outcomes if o.verdict == "never_escapes" or (o.opening or 1.0) > 1.05]
    return len(wide) / len(outcomes)


def test_point_targets() -> None:
    outcomes = [point_targets.judge(SEED, number) for number in range(60, 100)]
    check(outcomes)
    assert wide_share(outcomes) > 1 / 3
    assert len({o.family for o in outcomes}) == 7


@pytest.mark.slow
def test_disc_targets() -> None:
    check([disc_targets.judge(SEED, number, (4, 8)) for number in range(8)])


@pytest.mark.slow
def test_more_point_targets() -> None:
    outcomes = [point_targets.judge(SEED, number) for number in range(200)]
    check(outcomes)
    assert wide_share(outcomes) > 1 / 3


@pytest.mark.slow
def test_more_disc_targets() -> None:
    check([disc_targets.judge(SEED, number, (4, 8, 32)) for number in range(8, 12)])
    check([disc_targets.judge(SEED, number, (64,)) for number in range(30, 31)])


def test_a_planted_disagreement_is_seen() -> None:
    right = Levels(1.0, 1.2, 1.5)
    assert difference(right, right) == 0.0
    assert difference(right, Levels(1.0, 1.2, 1.5 * (1 + 2e-7))) > 1e-7
    assert difference(right, Levels(1.0, 1.2 * (1 - 2e-7), 1.5)) > 1e-7
    assert difference(right, Levels(1.0, 1.2, float("inf"))) == float("inf")
    outcome = Outcome(0, "none")
    outcome.add("a way", 2e-7)
    assert outcome.disagreements
