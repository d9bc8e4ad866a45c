"""Which shapes of the zoo have a grasp, and what is said of those that have none."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.method import CELLS
from icage.contact_space.method import ContactSpace
from icage.discs.offsets import offsets
from icage.errors import GraspError
from icage.grasps.search import best_grasps
from icage.outline import Outline
from icage.planner import plan
from tests.zoo.shapes import VALID, WITHOUT_GRASP, Shape
from tests.zoo.specimens import specimen


def test_nearly_all_specimens_have_a_grasp_of_discs() -> None:
    without = [s.name for s in VALID if specimen(s.name).discs is None]
    assert len(without) <= len(VALID) // 6, without


@pytest.mark.parametrize("shape", WITHOUT_GRASP, ids=lambda s: s.name)
def test_shapes_without_a_grasp(shape: Shape) -> None:
    outline = Outline(shape.vertices)
    with pytest.raises(GraspError, match="no immobilizing"):
        best_grasps(outline, rng=np.random.default_rng(0))
    low, high = outline.vertices.min(0), outline.vertices.max(0)
    middle = 0.5 * (low + high)
    on = np.array([[low[0], middle[1]], [middle[0], low[1]], [high[0], middle[1]]])
    for method in (CELLS, ContactSpace()):
        cage = plan(outline, on, method=method)
        assert cage.status == "not_a_cage"
        assert cage.why
        assert cage.sigma_0 == cage.sigma_first == cage.sigma_max
    assert (offsets(outline, 0.1, 8).outer.area) > outline.area
