"""Contact space against cells on random targets, whole trees too: a slice of the sweep."""

from __future__ import annotations

import numpy as np
import pytest

from icage.planner import METHODS, plan
from tests.oracles.against_itself.two_methods import (
    judge_discs,
    judge_large,
    judge_points,
    judge_trees,
)
from tests.oracles.polygons import rotated

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


@pytest.mark.parametrize("turned", range(24))
def test_a_slide_that_ends_in_a_concave_corner_is_one(turned: int) -> None:
    """The regions of the corner's other edge have but the end of it; rounding chose among them."""
    ring = np.array(
        [[-0.5, 0], [0.5, 0], [0.1, 2.4], [1.8, 2.4], [1.8, 3.4], [-1.8, 3.4], [-1.8, 2.4],
         [-0.5, 2.4]]
    )  # fmt: skip
    contacts = np.array([[0.5, 2.4], [0.11537121366031844, 3.4], [-0.5, 2.4]])
    if turned:
        rng = np.random.default_rng(turned)
        contacts[0, 0], contacts[1, 0] = rng.uniform(0.2, 1.5), rng.uniform(-0.4, 0.1)
        angle = 0.5 * np.pi * (turned % 4) if turned < 12 else turned
        ring, contacts = rotated(ring, angle), np.roll(rotated(contacts, angle), turned % 3, axis=0)
    for method in METHODS:
        cage = plan(ring, contacts, method=method)
        assert cage.status == "not_a_cage"
        assert "opposing parallel edges" in (cage.why or "")


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
