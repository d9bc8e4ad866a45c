"""What two methods may differ in, and what is told."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icage.agreement import disagreements
from icage.cage import Cage
from icage.formats.case_json import read_case
from icage.planner import plan
from models import CASES


@pytest.fixture(scope="module")
def discs() -> Cage:
    return plan(read_case(CASES / "disc_hammer.json"))


def test_a_cage_agrees_with_itself(discs: Cage) -> None:
    assert disagreements(discs, discs, 0.0) == []


@pytest.mark.parametrize("name", ["sigma_0", "sigma_first", "sigma_max"])
def test_levels_are_compared(discs: Cage, name: str) -> None:
    other = replace(discs, **{name: getattr(discs, name) * (1.0 + 1e-6)})
    assert any(line.startswith(f"{name}:") for line in disagreements(discs, other))
    assert disagreements(discs, other, 1e-5) == []


def test_bounds_need_not_be_equal_but_to_hold(discs: Cage) -> None:
    level, bound = discs.sigma_max, discs.sigma_max_upper
    assert level is not None
    assert bound is not None
    wider = replace(discs, sigma_max_upper=bound * (1.0 + 3e-5))
    assert disagreements(discs, wider) == disagreements(wider, discs) == []
    false = replace(discs, sigma_max_upper=level * (1.0 - 1e-6))
    none = replace(discs, sigma_max_upper=None)
    for other in (false, none):
        for one, two in ((discs, other), (other, discs)):
            assert any(line.startswith("sigma_max_upper:") for line in disagreements(one, two))
