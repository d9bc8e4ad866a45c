"""``icage shake``: derived cases, the answer, and that a hand that does not hold fails."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.cases.with_discs import DerivedCaseError, physical_case, with_discs
from experiments.shake import run as shakes
from icage.formats.case_json import read_case
from icage.hand import HandShape
from models import CASES
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


def test_the_triangle_with_discs_plays_by_the_law(capsys: Any):
    result = here(capsys, "shake", str(CASES / "triangle_eq_best.json"), "--json", "-")
    assert result.code == 0, result
    answer = json.loads(result.out)
    assert answer["format"] == "icage-shake/1"
    assert answer["derived"]
    assert answer["held"]
    assert answer["finger_radius"] == pytest.approx(0.02)
    assert answer["contact_types"] == ["edge"] * 3
    closure = answer["form_closure"]
    assert (closure["rank"], closure["closed"], closure["agrees_with_planner"]) == (2, False, True)
    assert len(answer["shake"]["pushes"]) == 10
    assert [play["delta"] for play in answer["play"]] == [1e-4, 1e-3, 1e-2]
    for play in answer["play"]:
        assert play["on_edges"]
        assert play["law"] == pytest.approx(np.arccos(1.0 / (1.0 + play["delta"])))
        assert play["measured"] == pytest.approx([play["law"]] * 2, rel=0.15)


def test_concave_corners_hold_to_first_order(tmp_path: Path, capsys: Any):
    case = write_case(t_case(), tmp_path / "t.json")
    result = here(capsys, "shake", str(case), "--seed", "5")
    assert result.code == 0, result
    assert "first order (form closure): 5 contacts, 5 with force" in result.out
    assert "rank 3, as 2 concave corners ask for" in result.out
    assert result.out.endswith("held\n")
    assert "play" not in result.out


def test_what_is_not_held_fails(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch):
    """The hand is opened by 5 % before it is locked."""

    def opened(scene: Any, qpos: Any, rng: Any) -> Any:
        wide = qpos.copy()
        wide[:3] *= 1.05
        return locked(scene, wide, rng)

    locked = shakes.shake
    monkeypatch.setattr(shakes, "shake", opened)
    case = write_case(t_case(), tmp_path / "t.json")
    result = here(capsys, "shake", str(case))
    assert result.code == 1
    assert "the object is not held: it moved" in result.err
    assert result.out.endswith("NOT HELD\n")


def test_a_contact_taken_for_another_kind_fails(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
):
    found = shakes.touches
    case = write_case(t_case(), tmp_path / "t.json")
    monkeypatch.setattr(shakes, "touches", lambda *args: _first_three(found(*args)))
    result = here(capsys, "shake", str(case))
    assert result.code == 1
    assert "do not go with 2 contacts at concave corners" in result.err


def _first_three(found: Any) -> Any:
    return type(found)(*(getattr(found, n)[:3] for n in ("finger", "points", "normals", "forces")))


@pytest.mark.parametrize("name", ["L_best", "hammer_best"])
def test_derived_targets_keep_the_hand_and_the_kind(name: str):
    case = read_case(CASES / f"{name}.json")
    derived = with_discs(case, 0.02 * case.outline.diameter)
    cage = physical_case(case).cage
    assert cage.status == "cage"
    assert cage.adjusted_by < 1e-9 * case.outline.diameter
    sides = [np.diff(c[[0, 1, 2, 0]], axis=0) for c in (case.contacts, derived.contacts)]
    lengths = [np.hypot(*side.T) for side in sides]
    assert lengths[1] / lengths[0] == pytest.approx(np.full(3, lengths[1][0] / lengths[0][0]))
    assert lengths[1][0] > lengths[0][0]


def test_what_is_no_cage_is_bad_input(capsys: Any):
    line = here(capsys, "shake", str(CASES / "rectangle_notcage.json")).error_line()
    assert "opposing parallel edges" in line


def test_where_no_disc_fits_another_grasp_of_the_hand_stands_in():
    """The fingers of this case stand in a pocket narrower than the discs."""
    case = read_case(CASES / "never_escapes_b.json")
    found = physical_case(case)
    assert (found.derived, found.another) == (True, True)
    assert "another grasp of that hand" in found.origin
    assert found.cage.hand.phi == pytest.approx(HandShape.from_contacts(case.contacts).phi)
    assert found.cage.sigma_max is not None
    assert found.cage.sigma_max >= 1.01 * found.cage.sigma_0


def test_a_case_that_discs_cannot_hold_anywhere_says_so():
    with pytest.raises(DerivedCaseError, match="nor near another of that hand"):
        physical_case(read_case(CASES / "T_best.json"), radii=[0.4])
