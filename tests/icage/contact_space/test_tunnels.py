"""Tunnel edges: what they are for, and what happens without them. [Bunis2018, Sec. V-B]"""

from __future__ import annotations

from pathlib import Path

import pytest

from icage.case import Case
from icage.contact_space.method import CONTACT_SPACE, ContactSpace
from icage.formats.case_json import read_case
from icage.planner import plan
from models import CASES, HARD
from tests.oracles.grid_flood import bracket_sigma_max

SPIRAL = Path(__file__).with_name("tunnel_spiral.json")
"""Our own: target 1995 of seed 77 of the sweep's ``point_target``; found by comparing both."""

RIGHT_AND_WITHOUT = [
    (CASES / "tunnel_golden.json", 4.307777383, 4.454539874),
    (SPIRAL, 0.09706181521437017, 0.14777533201604695),
]


def sigma_max(case: Case, method: ContactSpace) -> float:
    level = plan(case.outline, case.contacts, 0.0, method).sigma_max
    assert level is not None
    return level


@pytest.mark.parametrize(("path", "right", "without"), RIGHT_AND_WITHOUT)
def test_without_tunnel_edges_sigma_max_is_too_high(
    path: Path, right: float, without: float
) -> None:
    case = read_case(path)
    cage = plan(case.outline, case.contacts, 0.0, CONTACT_SPACE)
    assert cage.sigma_max == pytest.approx(right, rel=1e-9)
    assert cage.search is not None
    assert cage.search.tunnel_edges_used >= 1
    assert sigma_max(case, ContactSpace(tunnels=False)) == pytest.approx(without, rel=1e-9)
    assert plan(case.outline, case.contacts).sigma_max == pytest.approx(right, rel=1e-9)


@pytest.mark.slow
def test_brute_force_sides_with_the_tunnels() -> None:
    case = read_case(SPIRAL)
    bracket = bracket_sigma_max(case.outline, case.contacts, 0.01)
    assert bracket.lower <= 0.09706181521437017 <= bracket.upper
    assert bracket.upper < 0.14777533201604695


def test_false_minima_appear_without_tunnel_edges() -> None:
    """The cage of the golden case has one grasp; without tunnels three more seem to be there."""
    case = read_case(CASES / "tunnel_golden.json")
    assert len(plan(case.outline, case.contacts, 0.0, CONTACT_SPACE).grasps) == 1
    assert len(plan(case.outline, case.contacts, 0.0, ContactSpace(tunnels=False)).grasps) == 4


def test_without_tunnel_edges_the_levels_of_disc_fingers_have_no_order() -> None:
    """Here the highest of the inner polygons is above the lowest of the outer ones."""
    case = read_case(HARD / "spiral_tunnel.json")
    wrong, right = (
        plan(case.outline, case.contacts, case.finger_radius, method)
        for method in (ContactSpace(tunnels=False), CONTACT_SPACE)
    )
    assert wrong.sigma_max == pytest.approx(0.131544953, rel=1e-8)
    assert wrong.sigma_max_upper == pytest.approx(0.131561897, rel=1e-8)
    assert right.sigma_max_upper is not None
    assert wrong.sigma_max is not None
    assert right.sigma_max_upper < 0.93 * wrong.sigma_max
