"""Each puncture is a watershed: closings from beside it end on both of its sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from icage.cage import Puncture
from icage.cells.membership import VERDICTS, query
from icage.hand import Placement
from models import CASES
from tests.icage.cells.wandering import Solved, as_configurations, grasp_at, solved
from tests.oracles.geometry import Floats
from tests.oracles.planar_closing import close_hand

NAMES = sorted(path.stem for path in CASES.glob("*.json"))
WITH_PUNCTURES = [n for n in NAMES if "not_a_cage" not in n and "notcage" not in n]
TRIES = 30_000
CLOSINGS = 30


def beside(case: Solved, puncture: Puncture, rng: np.random.Generator) -> Floats:
    """Free configurations (n, 4) about the puncture, from 1e-5 to 3 % of the diameter away.

    Half of them any, half of them judged to be in the target's set: where its side of the
    watershed is a narrow funnel, plain chance misses it. The closings decide, not the query.
    """
    at = as_configurations(Placement.from_contacts(puncture.contacts).as_array()[None])[0]
    scale = case.ring.diameter * 10.0 ** rng.uniform(-5.0, -1.5, (TRIES, 1))
    tried = at + scale * rng.normal(size=(TRIES, 4))
    w = tried[:, 2] + 1j * tried[:, 3]
    rows = np.column_stack([tried[:, :2], np.angle(w), np.abs(w)])
    verdict = query(case.cage, rows).verdict
    free = np.flatnonzero(verdict != VERDICTS.index("collision"))
    target = np.flatnonzero(verdict == VERDICTS.index("target"))
    return tried[np.concatenate([free[:CLOSINGS], target[:CLOSINGS]])]


def ends_beside(case: Solved, puncture: Puncture) -> set[int | None]:
    """Grasp ids (None: in no listed grasp, or out of the hand) where closings beside it end."""
    ends: set[int | None] = set()
    for q in beside(case, puncture, np.random.default_rng(31)):
        closed = close_hand(case.ring, case.hand, q, case.cage.finger_radius)
        within = 1e-5 * case.ring.diameter
        ends.add(None if closed.escaped else grasp_at(case.cage, closed.contacts, within))
    return ends


@pytest.mark.parametrize("name", [n for n in WITH_PUNCTURES if n != "never_escapes_a"])
def test_the_first_puncture_parts_the_target_from_what_it_joins(name: str) -> None:
    case = solved(name)
    first = case.cage.punctures[0]
    assert first.sigma == case.cage.sigma_first or case.cage.finger_radius
    ends = ends_beside(case, first)
    assert 0 in ends
    assert ends & (set(first.joins) if first.joins else {None})


@pytest.mark.parametrize("name", WITH_PUNCTURES)
def test_every_puncture_parts_the_cage_from_what_it_joins(name: str) -> None:
    case = solved(name)
    inside = {0}
    for puncture in case.cage.punctures:
        ends = ends_beside(case, puncture)
        assert ends & inside
        assert ends & (set(puncture.joins) if puncture.joins else {None})
        inside |= set(puncture.joins)
    assert inside == {g.id for g in case.cage.grasps}


@pytest.mark.parametrize("name", WITH_PUNCTURES)
def test_free_fingers_are_those_that_touch_nothing(name: str) -> None:
    case = solved(name)
    for event in (*case.cage.grasps, *case.cage.punctures):
        gaps = [-case.ring.depth(p, case.cage.finger_radius) for p in event.contacts]
        far = 1e-3 if case.cage.finger_radius else 1e-6  # chords stand off the arcs
        free = [k + 1 for k, gap in enumerate(gaps) if gap > far * case.ring.diameter]
        assert list(event.free_fingers) == free


def test_beside_the_target_there_is_no_watershed() -> None:
    """The check can fail: a puncture put where there is none has one side only."""
    case = solved("T_best")
    false = replace(case.cage.punctures[0], contacts=case.cage.contacts)
    assert ends_beside(case, false) == {0}
