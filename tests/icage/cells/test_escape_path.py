"""The escape path of every case, checked against the object with shapely."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models import CASES
from tests.icage.cells.wandering import Solved, solved
from tests.oracles.path_check import PathFacts, path_facts

NAMES = sorted(path.stem for path in Path(CASES).glob("*.json"))
SLACK = 1e-9
"""[diameter] Rounding of a path's corners."""


def facts(case: Solved) -> PathFacts:
    path = case.cage.escape_path
    assert path is not None
    return path_facts(case.ring, case.hand, path, case.cage.contacts, case.cage.finger_radius)


def is_a_way_out(case: Solved) -> bool:
    found, cage = facts(case), case.cage
    level = cage.sigma_max_upper if cage.finger_radius else cage.sigma_max
    assert level is not None
    size = case.ring.diameter
    return (
        found.depth <= SLACK * size
        and found.sigma_max <= level * (1.0 + 1e-9)
        and found.start_gap <= SLACK * size
        and found.sigma_end == 0.0
    )


@pytest.mark.parametrize("name", NAMES)
def test_the_path_leads_out(name: str) -> None:
    case = solved(name)
    if case.cage.status != "cage":
        assert case.cage.escape_path is None
        assert case.cage.min_finger_gap is None
        return
    assert is_a_way_out(case)
    gap = case.cage.min_finger_gap
    assert gap is not None
    assert 0.0 <= gap <= facts(case).finger_gap + SLACK * case.ring.diameter


@pytest.mark.parametrize("name", ["T_best", "pliers_best", "cross_multi", "disc_hammer"])
def test_a_planted_shortcut_is_seen(name: str) -> None:
    """Without one of its corners, or 1e-6 of the diameter off, the path goes through the object."""
    case = solved(name)
    path = case.cage.escape_path
    assert path is not None
    seen = 0
    for k in range(1, min(8, len(path) - 1)):
        cut = replace(case, cage=replace(case.cage, escape_path=np.delete(path, k, axis=0)))
        seen += not is_a_way_out(cut)
    for way in ([1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]):
        moved = path.copy()
        moved[1:, :2] += 1e-6 * case.ring.diameter * np.array(way)
        off = replace(case, cage=replace(case.cage, escape_path=moved))
        seen += not is_a_way_out(off)
    assert seen > 0


@pytest.mark.parametrize("name", ["T_best", "L_best", "ngon9_best"])
def test_the_path_reaches_its_level(name: str) -> None:
    """A path that stays below sigma_max would be a contradiction; it must touch it."""
    case = solved(name)
    assert facts(case).sigma_max == pytest.approx(case.cage.sigma_max, rel=1e-9)
