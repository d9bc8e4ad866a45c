"""Grasps ranked by how far the open hand may be off, against a dense enumeration."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from icage import Case, Outline, place, plan
from icage.cage import Cage
from icage.grasps.findings import Findings
from icage.grasps.of_case import best_of_case
from icage.grasps.scores import ROUGH, bound_of
from icage.grasps.search import ranked_grasps
from icage.grasps.wanted import ANY_HAND, HandLimits, Wanted
from tests.icage.grasps.small_outlines import SMALL
from tests.icage.placing.beside_sampling import drawn
from tests.oracles.geometry import Ring
from tests.oracles.grasps import grid_grasps

SOME = ("notched", "arrow", "hour glass", "L")
WANTED = Wanted("place", limits=ANY_HAND)


@cache
def best(name: str) -> tuple[Cage, ...]:
    case = Case(name, "m", Outline(SMALL[name]))
    return best_of_case(case, 4, WANTED, np.random.default_rng(0)).cages


def longest(cage: Cage) -> Cage:
    """The same grasp with fingers 1 and 2 those that are furthest apart, as the search has it."""
    side = np.linalg.norm(cage.contacts - np.roll(cage.contacts, -1, axis=0), axis=1)
    return plan(cage.outline, np.roll(cage.contacts, -int(side.argmax()), axis=0))


def borne(cage: Cage) -> float:
    """Tolerance over sigma_0."""
    return place(cage).tolerance / cage.sigma_0


@pytest.mark.parametrize("name", SOME)
def test_no_grasp_of_a_grid_bears_more(name: str) -> None:
    outline = Outline(SMALL[name])
    grid = [plan(outline, contacts) for _, contacts in grid_grasps(Ring.of(outline.vertices), 8)]
    most = max(borne(longest(cage)) for cage in grid if cage.status != "not_a_cage")
    assert borne(best(name)[0]) >= most * (1.0 - 2.0 * ROUGH)


@pytest.mark.parametrize("name", SOME)
def test_scores_are_those_of_the_placements(name: str) -> None:
    outline = Outline(SMALL[name])
    found = ranked_grasps(outline, wanted=WANTED, rng=np.random.default_rng(0))
    scores = [candidate.score for candidate in found.candidates]
    assert scores == sorted(scores, reverse=True)
    for candidate in found.candidates[:5]:
        cage = plan(outline, candidate.contacts)
        assert borne(cage) == pytest.approx(candidate.score, rel=ROUGH)


@pytest.mark.parametrize("seed", range(21))
def test_no_placement_exceeds_its_bound(seed: int) -> None:
    """And where the fingers move straight out it is nearly reached."""
    cage = drawn(seed)
    if cage.sigma_first is None:
        return
    found = Findings(
        np.zeros((1, 3), np.int64), np.zeros((1, 2)), cage.contacts[None], np.array([cage.sigma_0]),
        np.array([cage.sigma_first]), np.zeros(1, np.int64),
    )  # fmt: skip
    assert borne(cage) <= float(bound_of(found, WANTED)[0]) * (1.0 + 1e-9)


def test_the_bound_is_reached_by_the_triangle() -> None:
    root = 3.0**0.5
    contacts = np.array([[0.5, 0.0], [0.75, 0.25 * root], [0.25, 0.25 * root]])
    cage = plan(np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * root]]), contacts)
    assert cage.sigma_first is not None
    found = Findings(
        np.zeros((1, 3), np.int64), np.zeros((1, 2)), contacts[None], np.array([cage.sigma_0]),
        np.array([cage.sigma_first]), np.zeros(1, np.int64),
    )  # fmt: skip
    assert borne(cage) == pytest.approx(float(bound_of(found, WANTED)[0]), rel=1e-6)


def test_a_hand_that_opens_less() -> None:
    """No hand opens beyond its limit, and one that cannot is worth less."""
    case = Case("L", "m", Outline(SMALL["L"]))
    free = best("L")[0]
    most = 0.5 * (free.sigma_0 + place(free).placement.sigma)
    (narrow,) = case.grasps(1, aim="place", limits=HandLimits(0.0, 0.0, 0.0, most))
    cage = plan(case.outline, narrow.contacts)
    assert place(cage, largest=most).placement.sigma <= most
    assert narrow.score == pytest.approx(
        place(cage, largest=most).tolerance / cage.sigma_0, rel=0.01
    )
    assert narrow.score <= borne(free)
