"""Every expected value of every solved case."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from icage.cage import Cage
from icage.formats.case_json import parse_case
from icage.planner import plan
from models import CASES

FILES = sorted(CASES.glob("*.json"))
EXACT = 1e-7


def load(path: Path) -> tuple[Cage, dict]:
    data = json.loads(path.read_text())
    case = parse_case(data, path.parent)
    return plan(case.outline, case.contacts, case.finger_radius), data["expected"]


def same(found: float | None, expected: float | None) -> bool:
    if found is None or expected is None:
        return found is expected
    return abs(found / expected - 1.0) <= EXACT


def test_all_cases_are_here() -> None:
    assert len(FILES) == 20


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_expected_values(path: Path) -> None:
    cage, expected = load(path)
    assert cage.status == expected["verdict"]
    assert same(cage.sigma_0, expected["sigma_0"])
    for key in ("sigma_first", "sigma_max"):
        if key in expected:
            assert same(getattr(cage, key), expected[key]), key
    for key in ("phi_deg",):
        if key in expected:
            assert cage.hand.phi_deg == pytest.approx(expected[key], abs=1e-9)
    for key in ("sigma_first", "sigma_max"):
        bracket = expected.get(f"{key}_bracket")
        if bracket is not None:
            slack = 1.0 + 1e-12
            assert bracket[0] / slack <= getattr(cage, key) <= bracket[1] * slack
    if cage.status == "not_a_cage":
        assert cage.why


@pytest.mark.parametrize("path", [p for p in FILES if "disc" in p.stem], ids=lambda p: p.stem)
def test_disc_brackets(path: Path) -> None:
    cage, expected = load(path)
    assert cage.sigma_max is not None
    assert cage.sigma_max_upper is not None
    low, high = expected["sigma_max_true_in"]
    assert cage.sigma_max_upper / cage.sigma_max - 1.0 < 1e-4
    assert cage.sigma_max <= high
    assert cage.sigma_max_upper >= low
    assert cage.sigma_first_converged
    assert cage.sigma_first == pytest.approx(expected["sigma_first_true_in"][0], rel=1e-4)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_the_document_is_consistent(path: Path) -> None:
    """Punctures ascend from sigma_first to the escape, joins name grasps, levels are ordered."""
    cage, _ = load(path)
    if cage.status == "not_a_cage":
        assert cage.sigma_first == cage.sigma_max == cage.sigma_0
        return
    levels = [p.sigma for p in cage.punctures]
    assert levels == sorted(levels)
    assert [g.id for g in cage.grasps] == list(range(len(cage.grasps)))
    joined = sorted(i for p in cage.punctures for i in p.joins)
    assert joined == list(range(1, len(cage.grasps)))
    if cage.punctures:
        assert cage.punctures[0].sigma == cage.sigma_first
    if cage.status == "cage":
        assert cage.sigma_first is not None
        assert cage.sigma_max is not None
        assert cage.punctures[-1].kind == "escape"
        assert cage.punctures[-1].sigma == cage.sigma_max
        assert cage.sigma_0 <= cage.sigma_first <= cage.sigma_max
    else:
        assert cage.sigma_max is None
        assert cage.escape_path is None


def test_reasons() -> None:
    by_name = {path.stem: load(path)[0] for path in FILES if "not" in path.stem}
    assert "slide" in str(by_name["rectangle_notcage"].why)
    assert "no equilibrium" in str(by_name["stretching_not_a_cage"].why)
