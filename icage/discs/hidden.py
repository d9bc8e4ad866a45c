"""Minima of the true curve that a polygon may hide: solved next to the least points of its cells.

A shallow minimum beside an arc can vanish where chords or tangents stand for the arc. Its cell is
visited all the same, and the forces nearly balance at the least point of it. Our own.
"""

from __future__ import annotations

import numpy as np

from icage.cage import Cage
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BIRTH_WY,
    BORN_FINGER,
    BORN_SLOT,
)
from icage.cells.kernels.region import least_points
from icage.discs.critical import Critical, CurveFeatures


def hidden_minima(features: CurveFeatures, cage: Cage, reach: float) -> list[Critical]:
    """Minima on the true curve next to cells of a cage, its listed ones among them.

    ``reach`` [unit] is how far the polygon may lie off the curve. None for methods without cells.
    """
    work = cage.work
    if work is None:
        return []
    found, tree = work.search, work.tree
    top = np.inf if cage.sigma_max is None else cage.sigma_max
    birth = tree.birth[:, BIRTH_SIGMA]
    use = np.flatnonzero((birth > 0.0) & (birth < top))
    if not len(use):
        return []
    free_space = found.free_space
    low, at = tree.birth[use], tree.birth_at[use]
    points = least_points(
        free_space.pieces, free_space.z, 0, np.ascontiguousarray(found.cells[use]),
        low[:, BIRTH_WX], low[:, BIRTH_WY], at[:, BORN_FINGER], at[:, BORN_SLOT],
    )  # fmt: skip
    d = points[:, 0] + 1j * points[:, 1]
    w = low[:, BIRTH_WX] + 1j * low[:, BIRTH_WY]
    hands = d[:, None] + w[:, None] * free_space.hand.z
    fingers = np.stack([hands.real, hands.imag], axis=2) + free_space.origin
    return features.minima_near(fingers, reach)
