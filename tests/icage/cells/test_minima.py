"""The planner's grasps against all minima of the hand, found by trying every set of contacts."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.membership import query
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import Placement
from tests.icage.cells.wandering import grasp_at, solved
from tests.oracles.geometry import Floats
from tests.oracles.minima import all_minima

NAMES = (
    "T_best", "L_best", "triangle_eq_best", "cross_multi", "Z_twofold_multi", "hammer_best",
    "hook_deep_multi", "notched_bar_best", "ngon9_best", "near_parallel_tight", "tunnel_golden",
    "never_escapes_b",
)  # fmt: skip
SAME = 1e-7
"""[diameter]"""


@pytest.mark.parametrize("name", NAMES)
def test_all_grasps_of_a_hand(name: str) -> None:
    case = solved(name)
    strict = [m.contacts for m in all_minima(case.ring, case.hand) if not m.plateau]
    told = grasps_of_hand(case.cage.outline, case.cage.hand)
    assert unmatched(told, strict, case.ring.diameter) == []
    assert unmatched(strict, told, case.ring.diameter) == []


@pytest.mark.parametrize("name", NAMES)
def test_the_cage_lists_exactly_the_minima_that_the_query_puts_in_it(name: str) -> None:
    case = solved(name)
    minima = all_minima(case.ring, case.hand)
    rows = np.array([Placement.from_contacts(m.contacts).as_array() for m in minima])
    answers = query(case.cage, rows)
    listed = {grasp_at(case.cage, m.contacts, SAME * case.ring.diameter) for m in minima}
    assert listed - {None} == {g.id for g in case.cage.grasps}
    for k, minimum in enumerate(minima):
        is_listed = grasp_at(case.cage, minimum.contacts, SAME * case.ring.diameter) is not None
        assert is_listed == bool(answers.in_cage[k])


def unmatched(some: list[Floats], others: list[Floats], diameter: float) -> list[Floats]:
    """Those of ``some`` that are none of the ``others``."""
    return [a for a in some if not any(np.abs(a - b).max() <= SAME * diameter for b in others)]
