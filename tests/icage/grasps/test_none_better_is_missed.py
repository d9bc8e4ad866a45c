"""The best grasp that is found, against a dense enumeration."""

from __future__ import annotations

from functools import cache

import pytest

from icage.cage import Cage
from icage.grasps.wanted import Aim
from icage.outline import Outline
from icage.planner import plan
from tests.icage.grasps.small_outlines import AIMS, SMALL, found, score
from tests.oracles.geometry import Ring
from tests.oracles.grasps import grid_grasps, one_edge_grasps


@cache
def enumerated(name: str) -> tuple[Cage, ...]:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    grasps = [contacts for _, contacts in grid_grasps(ring, 20)]
    grasps += list(one_edge_grasps(ring, 6))
    return tuple(plan(outline, contacts) for contacts in grasps)


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", SMALL)
def test_no_grasp_of_a_dense_grid_is_better(name: str, aim: Aim) -> None:
    best = max(score(cage, aim) for cage in enumerated(name))
    assert best > 1.0
    assert found(name, aim)[0].score >= best * (1.0 - 1e-6)


@pytest.mark.parametrize("name", SMALL)
def test_nearly_all_grasps_of_the_grid_are_cages(name: str) -> None:
    """The oracle's strict minima are the planner's: shallow ones alone may fall to the cut."""
    verdicts = [cage.status for cage in enumerated(name)]
    assert len(verdicts) >= 8
    assert verdicts.count("not_a_cage") == 0


@pytest.mark.parametrize("name", SMALL)
def test_the_largest_cage_is_no_smaller_than_the_largest_first(name: str) -> None:
    """The winner by sigma_first has a cage at least as large: the winner by cage is no smaller."""
    first = found(name, "first")[0]
    largest = score(plan(Outline(SMALL[name]), first.contacts), "cage")
    assert found(name, "cage")[0].score >= largest * (1.0 - 1e-3)
