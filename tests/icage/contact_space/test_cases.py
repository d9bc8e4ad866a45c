"""The paper's method on every solved case."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from icage.cage import Cage
from icage.case import Case
from icage.cells.membership import query
from icage.contact_space.method import CONTACT_SPACE, ContactSpace
from icage.errors import InputError
from icage.formats.case_json import read_case
from icage.planner import plan
from models import CASES
from tests.oracles.geometry import Ring, unit_hand
from tests.oracles.path_check import path_facts

FILES = sorted(CASES.glob("*.json"))
EXACT = 1e-7


def solved(path: Path, method: ContactSpace = CONTACT_SPACE) -> tuple[Case, Cage]:
    case = read_case(path)
    return case, plan(case.outline, case.contacts, case.finger_radius, method)


def test_all_cases_are_here() -> None:
    assert len(FILES) == 20


@pytest.mark.parametrize("merge", [True, False], ids=["pieces", "triangles"])
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_expected_values(path: Path, merge: bool) -> None:
    _, cage = solved(path, ContactSpace(merge=merge))
    expected = json.loads(path.read_text())["expected"]
    assert cage.status == expected["verdict"]
    for key in ("sigma_0", "sigma_first", "sigma_max"):
        if key in expected:
            level = expected[key]
            assert getattr(cage, key) == (level and pytest.approx(level, rel=EXACT)), key
    if "sigma_max_true_in" in expected:
        low, high = expected["sigma_max_true_in"]
        assert cage.sigma_max is not None
        assert cage.sigma_max_upper is not None
        assert cage.sigma_max_upper / cage.sigma_max - 1.0 < 1e-4
        assert cage.sigma_max <= high
        assert cage.sigma_max_upper >= low
    if cage.status == "not_a_cage":
        assert cage.why


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_grasps_and_punctures_are_those_of_the_cells(path: Path) -> None:
    case, cage = solved(path)
    cells = plan(case.outline, case.contacts, case.finger_radius)
    size = case.outline.diameter
    assert len(cage.grasps) == len(cells.grasps)
    for grasp in cage.grasps:
        # equal grasps of a symmetrical object come in any order
        off = [np.abs(grasp.contacts - g.contacts).max() for g in cells.grasps]
        k = int(np.argmin(off))
        assert off[k] <= 1e-6 * size
        assert grasp.sigma == pytest.approx(cells.grasps[k].sigma, rel=1e-9)
        assert grasp.free_fingers == cells.grasps[k].free_fingers
        assert (grasp.plateau is None) == (cells.grasps[k].plateau is None)
    assert len(cage.punctures) == len(cells.punctures)
    for a, b in zip(cage.punctures, cells.punctures, strict=True):
        assert (a.kind, len(a.joins)) == (b.kind, len(b.joins))
        assert a.sigma == pytest.approx(b.sigma, rel=1e-9)
    assert cage.why == cells.why
    if cells.sigma_largest is not None:
        assert cage.sigma_largest == pytest.approx(cells.sigma_largest, rel=1e-9)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_the_escape_path_leads_out(path: Path) -> None:
    case, cage = solved(path)
    if cage.escape_path is None:
        assert cage.status != "cage"
        return
    ring, hand = Ring.of(case.outline.vertices), unit_hand(case.contacts)
    facts = path_facts(ring, hand, cage.escape_path, cage.contacts, case.finger_radius)
    assert facts.depth <= 1e-9 * ring.diameter
    assert facts.sigma_end == 0.0
    assert facts.start_gap <= 1e-8 * ring.diameter
    assert facts.sigma_max <= (cage.sigma_max_upper or cage.sigma_max) * (1.0 + 1e-9)
    assert facts.sigma_max >= cage.sigma_max * (1.0 - 1e-9)


def test_a_cage_of_the_contact_space_answers_no_queries() -> None:
    _, cage = solved(CASES / "T_best.json")
    with pytest.raises(InputError, match="cells"):
        query(cage, np.array([[0.0, 0.0, 0.0, 1.0]]))


def test_the_log_tells_the_course_of_the_search() -> None:
    _, cage = solved(CASES / "tunnel_golden.json")
    log = cage.search
    assert log is not None
    assert log.iterations[0].kind == "minimum"
    assert log.iterations[0].sigma == pytest.approx(cage.sigma_0, rel=1e-12)
    assert {s.kind for s in log.iterations} <= {
        "minimum", "side", "diagonal", "wall", "tunnel", "pinch",
    }  # fmt: skip
    highest = max(s.sigma for s in log.iterations)
    assert highest == pytest.approx(cage.sigma_max, rel=1e-12)
    assert (log.tunnel_edges_tried, log.tunnel_edges_used) == (1, 1)
    assert log.rectangles_explored <= log.rectangles_total == 3 * 9**2
    assert log.nodes >= len(log.iterations) / 2
