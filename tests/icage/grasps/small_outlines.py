"""Small outlines of many shapes, and the best grasps of each, found once for all tests."""

from __future__ import annotations

from functools import cache

import numpy as np

from icage.cage import Cage
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Aim, Candidate, Wanted
from icage.outline import Outline
from tests.oracles.geometry import Floats
from tests.oracles.polygons import random_polygon

AIMS: tuple[Aim, ...] = ("first", "cage")
SMALL: dict[str, Floats] = {
    name: np.array(ring, dtype=np.float64)
    for name, ring in {
        "triangle": [[0, 0], [1, 0], [0.4, 0.8]],
        "quadrilateral": [[0, 0], [1.3, 0.1], [1.1, 0.9], [0.1, 0.7]],
        "dart": [[0, 0], [2, 0], [0.7, 0.6], [0, 2]],
        "house": [[0, 0], [1, 0], [1, 0.7], [0.5, 1.2], [0, 0.7]],
        "notched": [[0, 0], [4, 0], [4, 2], [2, 1], [0, 2]],
        "boat": [[0, 0], [6, 0], [6, 1], [3, 0.3], [0, 1]],
        "arrow": [[0, 0], [2, 0], [2.5, 1], [2, 2], [0, 2], [0.8, 1]],
        "hour glass": [[0, 0], [2, 0], [1.4, 1], [2, 2], [1, 2.4], [0, 2], [0.6, 1]],
        "slit": [[0, 0], [4, 0], [4, 3], [2.2, 3], [2, 0.5], [1.8, 3], [0, 3]],
        "L": [[0, 0], [2, 0], [2, 0.7], [0.7, 0.7], [0.7, 2], [0, 2]],
    }.items()
}
_rng = np.random.default_rng(15)
SMALL["random 15"] = random_polygon(_rng, int(_rng.integers(4, 8)))
DISC_SHAPES = ("triangle", "dart", "notched", "L", "hour glass")
RADIUS = 0.05
"""[diameter]"""


@cache
def found(name: str, aim: Aim, radius: float = 0.0, top: int = 6) -> tuple[Candidate, ...]:
    """The search's answer, once for all tests; ``radius`` is in diameters."""
    outline = Outline(SMALL[name])
    rng = np.random.default_rng(0)
    r = radius * outline.diameter
    return tuple(
        best_grasps(outline, finger_radius=r, top=top, wanted=Wanted(aim, limits=ANY_HAND), rng=rng)
    )  # fmt: skip


def score(cage: Cage, aim: Aim) -> float:
    """What the search ranks, from the plan of the same grasp."""
    if cage.status == "not_a_cage":
        return 0.0
    last = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
    first = last if cage.sigma_first is None else cage.sigma_first
    level = first if aim == "first" else last
    assert level is not None
    return level / cage.sigma_0
