"""Contact space against cells on random targets, whole trees too: a slice of the sweep."""

from __future__ import annotations

import pytest

from tests.oracles.against_itself.two_methods import (
    judge_discs,
    judge_large,
    judge_points,
    judge_trees,
)

SEED = 41


@pytest.mark.parametrize("first", range(0, 120, 20))
def test_levels_of_point_fingers(first: int) -> None:
    for number in range(first, first + 20):
        outcome = judge_points(SEED, number)
        assert not outcome.disagreements, (number, outcome.disagreements)
        assert not outcome.exceptions, (number, outcome.exceptions)
        assert outcome.runs >= 6


def test_edges_parallel_to_1e_6_are_no_plateau() -> None:
    """The only one of 20,000 targets on which they once differed; the cells were wrong."""
    outcome = judge_points(2018, 19837)
    assert outcome.verdict == "cage"
    assert not outcome.disagreements + outcome.exceptions


@pytest.mark.parametrize("number", [62, 93])
def test_basins_that_only_a_tunnel_edge_from_above_connects(number: int) -> None:
    outcome = judge_large(2018, number)
    assert not outcome.disagreements + outcome.exceptions


@pytest.mark.parametrize("number", range(3))
def test_levels_on_large_polygons(number: int) -> None:
    outcome = judge_large(SEED, number)
    assert not outcome.disagreements + outcome.exceptions


@pytest.mark.parametrize("number", range(12))
def test_whole_trees(number: int) -> None:
    outcome = judge_trees(SEED, number)
    assert not outcome.disagreements + outcome.exceptions
    assert outcome.runs > 3


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 1600, 100))
def test_more_targets(first: int) -> None:
    for number in range(first, first + 100):
        outcome = judge_points(SEED, number)
        assert not outcome.disagreements + outcome.exceptions, number


@pytest.mark.parametrize("number", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
def test_discs(number: int) -> None:
    outcome = judge_discs(SEED, number)
    assert not outcome.disagreements + outcome.exceptions
