"""From candidates on a polygon to grasps on the true curve: none is lost without a word."""

from __future__ import annotations

import json
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from icage.discs.offsets import offsets
from icage.discs.true_curve import grasp_on_curve, onto_curve, refine
from icage.errors import GeometryError, GraspError, OutlineError
from icage.formats.case_json import read_case, read_object
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.planned import planned_grasps, planned_grasps_of_hand
from icage.grasps.scores import score
from icage.grasps.search import ranked_grasps
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.outline import MAX_VERTICES, Outline
from icage.planner import plan
from tests.oracles.geometry import Ring

INPUTS = Path(__file__).parents[3] / "tests" / "inputs"


@pytest.fixture(scope="module")
def slot() -> tuple[Outline, list[np.ndarray]]:
    outline = read_object(INPUTS / "slot_disc_grasps.json").outline
    found = ranked_grasps(outline, finger_radius=2.0, rng=np.random.default_rng(0))
    return outline, [candidate.contacts for candidate in found.candidates]


@pytest.mark.parametrize("top", [1, 2, 3, 10])
def test_the_best_grasp_of_the_slot_is_there_at_every_top(
    slot: tuple[Outline, list[np.ndarray]], top: int
) -> None:
    case = read_case(INPUTS / "slot_disc_plan.json")
    known = plan(case.outline, case.contacts, case.finger_radius)
    cages = planned_grasps(slot[0], 2.0, slot[1], Wanted(), top).cages
    assert 1 <= len(cages) <= top
    # many grasps of the slot open equally far: which of them is told first is no matter
    assert score(cages[0], Wanted()) >= score(known, Wanted()) - 1e-9
    assert score(cages[0], Wanted()) == pytest.approx(1.02032, abs=1e-5)
    assert [score(c, Wanted()) for c in cages] == sorted(
        (score(c, Wanted()) for c in cages), reverse=True
    )


def test_a_failing_candidate_gives_its_place_to_the_next(
    slot: tuple[Outline, list[np.ndarray]],
) -> None:
    """Planted: the best candidate moved along its edges to where it holds nothing."""
    outline, candidates = slot
    right = planned_grasps(outline, 2.0, candidates, Wanted(), 2)
    bad = np.array([[42.0, 3.0], [-2.0, 25.0], [5.0, -2.0]])
    found = planned_grasps(outline, 2.0, [bad, *candidates], Wanted(), 2)
    assert [c.sigma_0 for c in found.cages] == [c.sigma_0 for c in right.cages]
    assert len(found.failures) == 1
    assert found.failures[0].why
    assert found.reasons()[0][1] == 1


def test_what_cannot_be_planned_does_not_end_the_search(
    slot: tuple[Outline, list[np.ndarray]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise GeometryError("planted")

    monkeypatch.setattr("icage.grasps.planned.plan", fails)
    found = planned_grasps(slot[0], 2.0, slot[1], Wanted(), 1)
    assert not found.cages
    assert {failure.why for failure in found.failures} == {"it could not be planned (our fault)"}


def test_contacts_on_chords_move_onto_the_curve(slot: tuple[Outline, list[np.ndarray]]) -> None:
    outline, candidates = slot
    ring = Ring.of(outline.vertices)
    moved = [onto_curve(outline, 2.0, contacts) for contacts in candidates[:20]]
    assert sum(m is not None for m in moved) > 10
    for before, after in zip(candidates, moved, strict=False):
        if after is not None:
            assert max(abs(ring.depth(p, 2.0)) for p in after) < 1e-9 * ring.diameter
            assert np.abs(after - before).max() < 0.01 * 2.0


@cache
def hook() -> tuple[Outline, HandShape, list[np.ndarray]]:
    outline = read_object(INPUTS / "hook_bracket.json").outline
    hand = HandShape.from_angles_deg(60.0, 120.0)
    return outline, hand, grasps_of_hand(offsets(outline, 4.0, 8).inner, hand)


@pytest.mark.slow
def test_a_collapsed_refinement_is_none() -> None:
    outline, hand, candidates = hook()
    assert len(candidates) == 45
    ring, outcomes = Ring.of(outline.vertices), Counter[bool]()
    for contacts in candidates:
        solved = refine(outline, hand, 4.0, contacts)
        outcomes[solved is not None] += 1
        if solved is not None:
            assert max(ring.depth(p, 4.0) for p in solved) < 1e-9 * ring.diameter
            sigma = float(np.hypot(*(solved[1] - solved[0])))
            assert sigma > 0.9 * float(np.hypot(*(contacts[1] - contacts[0])))
        else:
            with pytest.raises(GraspError, match="no minimum"):
                grasp_on_curve(outline, 4.0, contacts, hand)
    # 11 once collapsed, and 5 were balanced by forces of 1e11 between the walls of a slot that a
    # finger just fills: by rounding of their directions.
    assert outcomes == {True: 30, False: 15}


@pytest.mark.slow
def test_grasps_of_one_hand_on_the_hook() -> None:
    outline, hand, candidates = hook()
    found = planned_grasps_of_hand(outline, 4.0, hand, candidates, Wanted())
    assert len(found.cages) + sum(found.alike) + len(found.failures) == len(candidates)
    assert len(found.cages) >= 20
    for cage in found.cages:
        assert abs(cage.hand.z_3 - hand.z_3) < 1e-9


def test_the_limit_of_vertices_is_for_what_users_bring() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, MAX_VERTICES + 1, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    with pytest.raises(OutlineError, match=f"{len(circle)} vertices; at most {MAX_VERTICES}"):
        Outline(circle)
    assert len(Outline.computed(circle)) == len(circle)
    with pytest.raises(GeometryError, match="computed polygon"):
        Outline.computed([[0, 0], [1, 1], [1, 0], [0, 1]])
    case = json.loads((INPUTS / "hook_bracket.json").read_text())
    finest = offsets(Outline(case["outline"]["vertices"]), 4.0, 1024)
    assert len(finest.inner) > MAX_VERTICES
