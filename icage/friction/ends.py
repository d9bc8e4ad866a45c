"""How far from the target may closings stop? The jams below a level, the farthest of them.

Below sigma_first(mu) every jam is within the tolerance. The farthest is bracketed: jams outside a
smaller tolerance either are there or are not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from icage.cells.work import work_of
from icage.friction.jam_search import JamSearch

if TYPE_CHECKING:
    from icage.cage import Cage
    from icage.friction.levels import FrictionLevel

_HALVINGS = 14
"""Of the tolerance: to 1e-4 of it."""

_BELOW = 1e-9
"""[1] Jams this near (relative) to the level are at it."""


@dataclass(frozen=True, slots=True)
class JamEnds:
    """How far from the target closings may stop, at most.

    ``position_max``: the middle of the fingers from its place at the target, [diameter];
    ``angle_max``: the turn of the hand, [rad]; both in the object's frame.
    """

    position_max: float
    angle_max: float


def jam_ends(cage: Cage, level: FrictionLevel) -> JamEnds:
    """The same for closings from below the level; from above by 1e-4 of the tolerance at most."""
    work = work_of(cage)
    allowed = level.tolerance
    if level.mu == 0.0 or work is None:
        return _plateau(cage)
    search = JamSearch(cage, work)
    first = search.known if level.sigma_first is None else level.sigma_first
    below = min(first, search.known) * (1.0 - _BELOW)

    def any_beyond(position: float, angle: float) -> bool:
        return bool(
            np.isfinite(search.least(level.mu, search.within(position, angle), below).sigma)
        )

    low, high = 0.0, allowed.position
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if any_beyond(middle, np.inf) else (low, middle)
    position = high
    low, high = 0.0, allowed.angle
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if any_beyond(np.inf, middle) else (low, middle)
    return JamEnds(position, high)


def _plateau(cage: Cage) -> JamEnds:
    """Without friction: the target, all of it if it can slide at constant sigma."""
    ends = cage.grasps[0].plateau if cage.grasps else None
    if ends is None:
        return JamEnds(0.0, 0.0)
    target = cage.contacts @ [1.0, 1.0j]
    hands = np.array(ends) @ [1.0, 1.0j]
    moved = np.abs(hands.mean(axis=1) - target.mean()) / cage.outline.diameter
    turned = np.abs(np.angle((hands[:, 1] - hands[:, 0]) / (target[1] - target[0])))
    return JamEnds(float(moved.max()), float(turned.max()))
