"""Where a polygon all but touches itself: a slit or a neck too thin for floating point. Our own."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.arrays import FloatArray, IntArray

NEAREST: Final = 1e-8
"""[diameter] Stretches of an outline that are further along it must be this far apart: at 1e-9 the
two methods begin to differ (1e-6 of a level), at 1e-13 either may see a slit as closed.
[docs/decisions/0020-fuzzing.md]"""

_ALONG: Final = 10.0
"""[1] How much longer the way along the outline must be than the gap, and than the least gap, for
the two to be different stretches, and not one corner or one short edge."""


class NearTouch(NamedTuple):
    """A vertex, the first vertex of an edge, and how far apart they are."""

    vertex: int
    edge: int
    gap: float


def near_touch(ring: FloatArray, diameter: float) -> NearTouch | None:
    """The vertex of a ring (n, 2) that is nearest to a stretch of it that is not its own.

    None if all are further away than ``NEAREST``, [diameter].
    """
    ends = np.roll(ring, -1, axis=0)
    least = NEAREST * diameter
    edges: NDArray[np.object_] = np.asarray(shapely.linestrings(np.stack([ring, ends], axis=1)))
    found = shapely.STRtree(edges).query(shapely.points(ring), predicate="dwithin", distance=least)
    vertex, edge = _not_incident(found, len(ring))
    if not len(vertex):
        return None
    way = ends[edge] - ring[edge]
    length = np.hypot(way[:, 0], way[:, 1])
    off = ring[vertex] - ring[edge]
    share = np.clip((off * way).sum(axis=1) / length**2, 0.0, 1.0)
    rest = off - share[:, None] * way
    gap = np.hypot(rest[:, 0], rest[:, 1])
    along = _along(ring, ends, vertex, edge, share)
    apart = along > _ALONG * np.maximum(gap, least)
    if not apart.any():
        return None
    k = int(np.argmin(np.where(apart, gap, np.inf)))
    return NearTouch(int(vertex[k]), int(edge[k]), float(gap[k]))


def _not_incident(found: IntArray, n: int) -> tuple[IntArray, IntArray]:
    """Pairs of a vertex and an edge that it is no end of."""
    vertex, edge = found
    own = (vertex == edge) | (vertex == (edge + 1) % n)
    return vertex[~own], edge[~own]


def _along(
    ring: FloatArray, ends: FloatArray, vertex: IntArray, edge: IntArray, share: FloatArray
) -> FloatArray:
    """The shorter way along the ring from a vertex to a place on an edge."""
    lengths = np.hypot(*(ends - ring).T)
    start = np.concatenate([[0.0], np.cumsum(lengths)])
    one_way = np.abs(start[vertex] - (start[edge] + share * lengths[edge]))
    return np.minimum(one_way, start[-1] - one_way)
