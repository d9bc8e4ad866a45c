"""Fewer vertices for a ring, within a distance and within the same bounding box."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely

from icage.arrays import FloatArray

_HALVINGS = 12
"""Tries with half the distance where the simplified ring would cross itself; then it is kept."""


def simplified(ring: FloatArray, within: float) -> FloatArray:
    """Ring (m, 2) of vertices of ``ring`` (k, 2, open) at most ``within`` from it, either way.

    Chords split where the ring is furthest off [Douglas1973], between the vertices that touch the
    bounding box, which stay: so the box stays as it is. A simplified chain remains within
    ``within`` of its chords (discs around a chord are convex) and covers them (it is connected),
    hence the Hausdorff distance.
    """
    for halving in range(_HALVINGS):
        fewer = _chains(ring, within / 2.0**halving)
        if len(fewer) >= 3 and shapely.Polygon(fewer).is_valid:
            return fewer
    return ring


def _chains(ring: FloatArray, within: float) -> FloatArray:
    ends = np.unique(np.concatenate([ring.argmin(axis=0), ring.argmax(axis=0)]))
    turned = np.roll(ring, -ends[0], axis=0)
    stops = [*(ends - ends[0]).tolist(), len(ring)]
    closed = np.vstack([turned, turned[:1]])
    kept: list[FloatArray] = []
    for start, stop in pairwise(stops):
        chain = shapely.LineString(closed[start : stop + 1])
        fewer = chain.simplify(within, preserve_topology=False)
        kept.append(shapely.get_coordinates(fewer)[:-1])
    return np.concatenate(kept)
