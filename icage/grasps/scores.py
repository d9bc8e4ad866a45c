"""What a planned grasp is worth: the ratio that ranks it."""

from __future__ import annotations

from icage.cage import Cage
from icage.errors import GeometryError
from icage.grasps.wanted import Wanted


def level_of(cage: Cage, wanted: Wanted) -> float:
    """The level that is ranked, [unit]; where there is none, the largest sigma of the component."""
    top = cage.sigma_max if cage.sigma_max is not None else cage.sigma_largest
    if top is None:
        raise GeometryError("a cage without sigma_max and without a largest sigma")
    if wanted.aim == "cage":
        return top
    if wanted.mu is None:
        return top if cage.sigma_first is None else cage.sigma_first
    first = cage.friction(wanted.mu).sigma_first
    return top if first is None else first


def score(cage: Cage, wanted: Wanted) -> float:
    """Ratio that ranks: the level that is aimed at, over sigma_0."""
    return level_of(cage, wanted) / cage.sigma_0
