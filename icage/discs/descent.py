"""Steps down the true curve that never open the hand, and the way down from a puncture.

Our own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.discs.balance import free_directions, pushes, pushing, slope_of_half_square
from icage.discs.features import Features

FLAT = 1e-7
"""[1] Curvature of sigma along the features below which a direction is level."""

_STRIDE = 0.25
"""[radius] How far a finger goes in one step."""


def closed(features: Features, v: FloatArray) -> FloatArray | None:
    """The hand (4,) after one step of closing inside the half planes around its fingers, or None.

    The least |w|^2 + weight |step|^2 in them, a least-distance problem. [Lawson1974]
    """
    stride = _STRIDE * features.radius
    slopes, gaps = features.half_planes(v, 3.0 * stride)
    if not len(gaps):
        return None  # nothing is near: the hand closes to a point
    scale = 1.0 / np.sqrt(np.array([1e-3, 1e-3, 1.0, 1.0]))
    aim = -slope_of_half_square(v)  # of the step, without half planes
    # x = (step - aim) / scale: least |x| with slopes (aim + scale x) + gaps >= 0
    columns = np.vstack([(slopes * scale).T, -(gaps + slopes @ aim)])
    wanted = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    force, miss = pushing(columns, wanted)
    if miss < 1e-14:
        return None
    r = columns @ force - wanted
    step = aim + scale * (-r[:4] / r[4])
    longest = features.longest_move(step)
    return np.asarray(v + step * min(1.0, stride / max(longest, 1e-300)))


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
