"""How good is the grasp on these contacts? Thousands of candidates a second, no Python between.

A candidate is three features and the point where their lines of force meet. The search from it ends
as soon as its level is known: at sigma_first where that is ranked, else at sigma_max. Our own.
"""

# pyright: basic
from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import (
    NEAR_DX,
    NEAR_DY,
    NEAR_SIGMA,
    NEAR_WX,
    NEAR_WY,
    RECORD_BIRTH,
    RECORD_LEVEL,
    Ending,
)
from icage.cells.kernels.largest import largest_in
from icage.cells.kernels.minimum import MOST_CELLS, nearest_minimum
from icage.cells.kernels.near import Hand
from icage.cells.kernels.search import explore
from icage.grasps.kernels.hands import first_finger, touches
from icage.kernels.compiled import compiled
from icage.kernels.locate import depth_inside
from icage.tolerance import (
    DEPTH_CUT,
    FREE_FINGER,
    LEVEL,
    NOT_A_CAGE,
    PASS_ERROR,
    TARGET_SHIFT,
    TARGET_TURN,
)

GAVE_UP, _, _, MET = Ending

_PASS_ERROR = 10.0 * PASS_ERROR
"""[diameter] How good the passes of a search from a candidate are: still ten times better than the
depth below which a minimum does not count. ``plan`` computes those of the grasps that are shown."""


class Verdict(IntEnum):
    """What a candidate is."""

    OUTSIDE = 0
    """Its contacts are off their features, where no finger may be, or no hand within the limits."""
    NO_MINIMUM = 1
    """Nothing holds there, or a finger touches nothing."""
    NO_CAGE = 2
    """It opens at once."""
    BROKEN_OFF = 3
    """Its search was larger than allowed."""
    CAGE = 4


OUTSIDE, NO_MINIMUM, NO_CAGE, BROKEN_OFF, CAGE = Verdict


class Sought(NamedTuple):
    """What is sought, and how far the search for it may go.

    Attributes
    ----------
    first:
        Whether sigma_first is ranked, not sigma_max.
    avoided:
        (n, 4) [unit] segments of the outline that are not to be touched.
    reach:
        [unit] How near a finger is that touches.
    cell_limit:
        Cells of one search.
    """

    first: bool
    avoided: np.ndarray
    reach: float
    cell_limit: int


class Evaluated(NamedTuple):
    """One row per candidate: verdict (n,), contacts (n, 3, 2), levels (n, 2) and cells (n,).

    Levels are sigma_0 and the level that is ranked, between fingers 1 and 2 as they come; finger 1
    is contact ``first`` (n,). ``cells`` are those that its search has visited.
    """

    verdict: np.ndarray
    contacts: np.ndarray
    levels: np.ndarray
    first: np.ndarray
    cells: np.ndarray


@compiled
def is_in_set(planes, f, px, py):
    """Whether P lies in the set of feature f."""
    for side in range(2):
        if planes[f, side, 0] * px + planes[f, side, 1] * py < planes[f, side, 2]:
            return False
    return True


@compiled
def _level(found, sigma_0, first, diameter):
    """The level that is ranked, inf if the hand never escapes, 0 if it holds nothing."""
    cut = DEPTH_CUT * diameter
    escape = found.level
    below = escape * (1.0 - 2.0 * LEVEL)
    level = escape if found.outcome != MET else np.inf
    for r in range(len(found.records)):
        at = found.records[r, RECORD_LEVEL]
        if at - found.records[r, RECORD_BIRTH] > cut and (found.outcome == MET or at < below):
            if at <= sigma_0 + cut:  # within the depth cut it closes further: no minimum
                return 0.0
            if first:
                level = at
            break
    return level


@compiled
def evaluate(pieces, origin, ring, x, y, limits, sought):
    """Verdict, first finger, sigma_0, level, cells; x, y (3,) become those of the minimum."""
    first = first_finger(x, y, limits)
    if first < 0:
        return OUTSIDE, 0, 0.0, 0.0, 0
    for k in range(3):
        if touches(x[k], y[k], sought.avoided, sought.reach):
            return OUTSIDE, 0, 0.0, 0.0, 0
    wx, wy = x[1] - x[0], y[1] - y[0]
    ux, uy = x[2] - x[0], y[2] - y[0]
    norm = wx * wx + wy * wy
    z = np.zeros((3, 2))
    z[1, 0] = 1.0
    z[2, 0], z[2, 1] = (ux * wx + uy * wy) / norm, (uy * wx - ux * wy) / norm
    shortest = min(1.0, np.hypot(z[2, 0], z[2, 1]), np.hypot(z[2, 0] - 1.0, z[2, 1]))
    cap = pieces.diameter / shortest
    worst = _PASS_ERROR * pieces.diameter
    wanted = Hand(x[0] - origin[0], y[0] - origin[1], wx, wy)
    held = nearest_minimum(pieces, z, wanted, TARGET_SHIFT, TARGET_TURN, cap, worst, MOST_CELLS)
    if held.row < 0 or held.plateau.long or held.total > MOST_CELLS:
        return NO_MINIMUM, 0, 0.0, 0.0, 0
    near = held.near[held.row]
    own = np.empty((3, 2))
    for k in range(3):
        own[k, 0] = near[NEAR_DX] + near[NEAR_WX] * z[k, 0] - near[NEAR_WY] * z[k, 1]
        own[k, 1] = near[NEAR_DY] + near[NEAR_WX] * z[k, 1] + near[NEAR_WY] * z[k, 0]
    # where two fingers hold already, the best grasps of three would be ones with a finger in the
    # air beside them
    if depth_inside(ring, own, 0.0).min() < -FREE_FINGER * pieces.diameter:
        return NO_MINIMUM, 0, 0.0, 0.0, 0
    for k in range(3):
        x[k], y[k] = own[k, 0] + origin[0], own[k, 1] + origin[1]
    sigma_0 = near[NEAR_SIGMA]
    longer = np.hypot(x[(first + 1) % 3] - x[first], y[(first + 1) % 3] - y[first])
    most = limits.sigma_most * sigma_0 / longer
    enough = DEPTH_CUT * pieces.diameter if sought.first else np.inf
    found = explore(
        pieces, z, held.cells[held.row], sigma_0, cap, worst, most, sought.cell_limit, enough
    )
    if found.outcome == GAVE_UP:
        return BROKEN_OFF, first, sigma_0, 0.0, len(found.nodes)
    level = _level(found, sigma_0, sought.first, pieces.diameter)
    if level == np.inf:
        cells = np.ascontiguousarray(found.nodes[:, :3])
        level = largest_in(pieces, z, cells, most)
    level = min(level, most)
    if level / sigma_0 - 1.0 < NOT_A_CAGE:
        return NO_CAGE, first, sigma_0, level, len(found.nodes)
    return CAGE, first, sigma_0, level, len(found.nodes)
