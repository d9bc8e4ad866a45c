"""Close the hand from placements that the query judges: an exact closing must agree with it."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.membership import VERDICTS, query
from tests.icage.cells.wandering import Solved, as_configurations, grasp_at, solved, wander
from tests.oracles.planar_closing import close_hand

TARGET_CASES = (
    "T_best", "L_best", "triangle_eq_best", "cross_multi", "Z_twofold_multi", "hammer_best",
    "notched_bar_best", "pliers_best", "rand16_best", "near_parallel_tight", "tunnel_golden",
    "never_escapes_a", "disc_Y", "disc_hammer",
)  # fmt: skip
CAGED_CASES = (
    "Z_twofold_multi", "cross_multi", "hammer_best", "handsaw_best", "hook_deep_multi",
    "ngon9_best", "notched_bar_best", "rand16_best", "never_escapes_b",
)  # fmt: skip
EACH = 45
"""Placements a case: 630 over 14 cases from the target set."""
SAME_GRASP = 1e-6
"""[diameter]"""
EAGERNESS = (0.02, 0.3, 3.0, 100.0)


def ends(case: Solved, placements: np.ndarray, seed: int) -> list[int | None]:
    """Grasp ids in which closings from the placements end (None: elsewhere, -1: escaped)."""
    rng = np.random.default_rng(seed)
    found: list[int | None] = []
    for q in as_configurations(placements):
        closed = close_hand(
            case.ring, case.hand, q, case.cage.finger_radius, float(rng.choice(EAGERNESS))
        )
        within = SAME_GRASP * case.ring.diameter
        found.append(-1 if closed.escaped else grasp_at(case.cage, closed.contacts, within))
    return found


@pytest.mark.parametrize("name", TARGET_CASES)
def test_target_placements_close_to_the_target(name: str) -> None:
    case = solved(name)
    placements = wander(case.cage, ("target",), np.random.default_rng(11), EACH)
    first = case.cage.sigma_first
    if case.cage.finger_radius and first is not None:
        # chords stand in for arcs: a placement within the bracket of sigma_first may be either
        placements = placements[placements[:, 3] < first * (1.0 - 1e-4)]
    assert ends(case, placements, 1) == [0] * len(placements)


@pytest.mark.parametrize("name", CAGED_CASES)
def test_caged_placements_close_to_a_listed_grasp(name: str) -> None:
    case = solved(name)
    placements = wander(case.cage, ("caged",), np.random.default_rng(12), EACH, steps=120)
    assert set(ends(case, placements, 2)) <= {g.id for g in case.cage.grasps}


def test_caged_placements_do_end_in_several_grasps() -> None:
    met: set[int | None] = set()
    for name in ("ngon9_best", "cross_multi", "never_escapes_b"):
        case = solved(name)
        placements = wander(case.cage, ("caged",), np.random.default_rng(12), EACH, steps=120)
        met |= {(name, k) for k in ends(case, placements, 2)}  # type: ignore[misc]
    assert len(met) > 4


@pytest.mark.parametrize("name", CAGED_CASES)
def test_closing_ends_in_a_grasp_that_the_query_names(name: str) -> None:
    case = solved(name)
    placements = wander(case.cage, ("caged", "other"), np.random.default_rng(13), EACH)
    answers = query(case.cage, placements)
    for row, end in enumerate(ends(case, placements, 3)):
        if answers.in_cage[row]:
            assert end in answers.grasps_of(row)
        else:
            assert VERDICTS[answers.verdict[row]] == "other"
            assert end not in (0, -1)


def test_the_same_closing_does_find_ways_out() -> None:
    """The checks above can fail: from placements judged to escape, many closings do."""
    case = solved("T_best")
    rng = np.random.default_rng(14)
    noise = rng.normal(size=(1000, 4)) * case.cage.sigma_0
    placements = case.cage.target_placement.as_array() + noise
    placements[:, 3] = np.abs(placements[:, 3])
    out = query(case.cage, placements).verdict == VERDICTS.index("escapes")
    assert ends(case, placements[out][:60], 4).count(-1) > 10
