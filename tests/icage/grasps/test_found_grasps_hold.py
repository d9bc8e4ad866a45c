"""Every grasp that is found holds, by forces solved another way, and is planned to its score."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from icage.discs.offsets import offsets
from icage.discs.true_curve import refine
from icage.grasps.wanted import Aim, Candidate
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from tests.icage.grasps.small_outlines import AIMS, DISC_SHAPES, RADIUS, SMALL, found, score
from tests.oracles.geometry import Floats, Ring
from tests.oracles.grasps import is_fair_hand
from tests.oracles.statics import is_strict_minimum

every_search = pytest.mark.parametrize(
    ("name", "aim"), [(name, aim) for name in SMALL for aim in AIMS]
)


@every_search
def test_the_contacts_of_points_are_those_of_a_grasp_that_holds(name: str, aim: Aim) -> None:
    ring = Ring.of(SMALL[name])
    for grasp in found(name, aim):
        # margin 0: the best grasp is often the last one before the forces cease to hold
        assert is_strict_minimum(ring, grasp.contacts, tol=1e-9, margin=0.0)


@every_search
def test_points_hold_and_the_plan_gives_the_same_levels(name: str, aim: Aim) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    grasps = found(name, aim)
    scores = [g.score for g in grasps]
    assert scores == sorted(scores, reverse=True)
    for grasp in grasps:
        cage = plan(outline, grasp.contacts)
        assert cage.status != "not_a_cage"
        assert is_strict_minimum(ring, cage.contacts, tol=1e-9, margin=0.0)
        assert score(cage, aim) == pytest.approx(grasp.score, rel=1e-9)
        assert grasp.sigma_0 == pytest.approx(cage.sigma_0, rel=1e-9)
        assert grasp.sigma_0 < grasp.level == pytest.approx(grasp.score * grasp.sigma_0)
        assert is_fair_hand(grasp.contacts, outline.diameter * (1.0 - 1e-9))


def on_true_curve(name: str, grasp: Candidate) -> Floats:
    """The grasp as found if it holds; else (contacts on chords) solved on the true curve."""
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    if is_strict_minimum(ring, grasp.contacts, r, tol=1e-9, margin=0.0):
        return grasp.contacts
    solved = refine(outline, HandShape.from_contacts(grasp.contacts), r, grasp.contacts)
    assert solved is not None
    off = np.linalg.norm(solved - grasp.contacts, axis=1).max()
    assert off <= 4.0 * offsets(outline, r, 16).sagitta + 1e-5 * ring.diameter
    return solved


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", DISC_SHAPES)
def test_discs_hold_on_the_true_curve(name: str, aim: Aim) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    sagitta = offsets(outline, r, 16).sagitta
    for grasp in found(name, aim, RADIUS):
        for p in grasp.contacts:
            assert abs(ring.depth(p, r)) <= sagitta + 1e-9 * ring.diameter
        contacts = on_true_curve(name, grasp)
        assert is_strict_minimum(ring, contacts, r, tol=1e-8, margin=0.0)


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", DISC_SHAPES)
def test_discs_on_the_true_curve_can_be_planned(name: str, aim: Aim) -> None:
    outline = Outline(SMALL[name])
    for grasp in found(name, aim, RADIUS):
        cage = plan(outline, on_true_curve(name, grasp), RADIUS * outline.diameter)
        assert cage.status != "not_a_cage"
        assert score(cage, aim) == pytest.approx(grasp.score, rel=2e-3)


@pytest.mark.parametrize("name", DISC_SHAPES)
def test_refining_leaves_a_grasp_that_holds_where_it_is(name: str) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    for grasp in found(name, "first", RADIUS):
        if not is_strict_minimum(ring, grasp.contacts, r, tol=1e-9, margin=0.0):
            continue
        solved = refine(outline, HandShape.from_contacts(grasp.contacts), r, grasp.contacts)
        assert solved is not None
        # sigma is flat round some: where it is least is known to the root of rounding only
        assert np.abs(solved - grasp.contacts).max() <= 1e-7 * ring.diameter
        sigma, least = (np.hypot(*(c[1] - c[0])) for c in (grasp.contacts, solved))
        assert abs(sigma - least) <= 1e-13 * ring.diameter


def test_no_two_grasps_are_nearly_the_same() -> None:
    for name in SMALL:
        for one, other in combinations(found(name, "first"), 2):
            copies = [np.roll(one.contacts, k, axis=0) for k in range(len(one.contacts))]
            apart = [np.linalg.norm(c - other.contacts, axis=1).max() for c in copies]
            assert min(apart) >= 0.08 * Outline(SMALL[name]).diameter
