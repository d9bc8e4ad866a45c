"""The way down from a puncture of the true curve. Our own. [docs/theory.md, Sec. 4]"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.discs.balance import free_directions, pushes, pushing, slope_of_half_square
from icage.discs.features import Features

FLAT = 1e-7
"""[1] Curvature of sigma along the features below which a direction is level."""


def way_down(features: Features, v: FloatArray) -> FloatArray | None:
    """A direction (4,) along the touched features in which sigma falls to second order, or None.

    A minimum of chords may stand on the very puncture of the arcs.
    """
    near = features.near(v, 1e-6)
    if len({f.finger for f in near}) < 2:
        return None
    chosen = features.chosen(near)
    gaps = features.gaps_of(v, chosen)
    force, _ = pushing(gaps.slope.T, slope_of_half_square(v))
    along = free_directions(gaps.slope[pushes(force)])
    if not len(along):
        return None
    bend, ways = np.linalg.eigh(along @ features.curvature(chosen, gaps, force) @ along.T)
    if bend[0] >= -FLAT:
        return None
    way = ways[:, 0] @ along
    return np.asarray(way / features.longest_move(way))
