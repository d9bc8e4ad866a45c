"""The levels of a fine outline lie between those of the outlines inside and around the drawing."""

from __future__ import annotations

from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

import icage
from icage.bracket import bracket
from icage.cells.free_space import FreeSpace, search
from icage.cells.membership import Locator
from icage.discs.offsets import offsets
from icage.errors import GraspError, InputError

CROSS = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="-30 -30 60 60">'
    '<path d="M-28 -4 Q-10 -6 -4 -12 Q-6 -20 0 -28 Q6 -20 4 -12 Q10 -6 28 -4 Q30 0 28 4 '
    'Q10 6 4 12 Q4 20 0 28 Q-4 20 -4 12 Q-10 6 -28 4 Z"/></svg>'
)


@pytest.fixture(scope="module")
def cross(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bracket") / "cross.svg"
    path.write_text(CROSS)
    return path


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_brackets_are_nested_and_hold_the_level_of_a_fine_outline(cross: Path, radius: float):
    case = icage.load(cross, tolerance=0.3, finger_radius=radius)
    case = case.with_grasp(case.grasps(top=1)[0].contacts)
    assert case.reading is not None
    low, high, widest = 0.0, float("inf"), float("inf")
    for tolerance in (0.3, 0.03, 0.003):
        found = bracket(replace(case, reading=replace(case.reading, tolerance=tolerance)))
        assert found.lower is not None
        assert found.upper is not None
        assert low <= found.lower < found.upper <= high
        assert found.upper - found.lower < 0.5 * widest
        assert 0.0 < found.tolerance <= tolerance
        low, high, widest = found.lower, found.upper, found.upper - found.lower
    # The level of the escape from the same placement, on an outline that is neither.
    fine = icage.load(cross, tolerance=0.003).outline
    placement = found.placement
    around = fine if radius == 0.0 else offsets(fine, radius, 64).inner
    free_space = FreeSpace.around(around, case.hand)
    row = np.array([astuple(placement)])
    cells = Locator.of(free_space).cells(case.hand.fingers(row), 1e-12)
    level = search(free_space, cells[0], placement.sigma).level
    assert low - 1e-3 < level < high + 1e-3


def test_what_has_no_drawing_has_no_bracket(cross: Path):
    with pytest.raises(InputError, match="was not read from a drawing"):
        bracket(icage.load("pliers"))
    with pytest.raises(GraspError, match="no target grasp"):
        bracket(icage.load(cross))
