"""The sublevel structure of a hand shape: all minima of sigma and where they merge.

[Bunis2018, Thm. 1]. Not one search but everything: the diagram of births and merges by the elder
rule. Minima of contact space that are none of free space have no depth, since their tunnel edge
leaves at their own level, and drop out by the depth cut.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.contact_space.exploration import NO_TUNNEL_EDGES, Plane, TunnelEdges
from icage.contact_space.kernels.columns import (
    ABOVE,
    BELOW,
    EDGE_TO,
    HAND_LEVEL,
    MERGE_YOUNGER,
    NODE_SIGMA,
)
from icage.contact_space.kernels.forest import persistence
from icage.contact_space.kernels.whole import all_regions, all_seams, hands_at
from icage.tolerance import DEPTH_CUT


@dataclass(frozen=True, slots=True)
class Sublevels:
    """All minima of sigma for one hand shape, by sigma. [Bunis2018, Def. 8]

    Attributes
    ----------
    births:
        (m,), sigma of each minimum.
    merges:
        (m,), level at which its component meets that of a deeper minimum or of a pinched hand;
        inf: never.
    contacts:
        (m, 3, 2), fingers in the object's frame (the middle of a plateau's first region).
    regions, tunnel_edges:
        Size of the graph: convex regions, tunnel edges.
    """

    births: FloatArray
    merges: FloatArray
    contacts: FloatArray
    regions: int
    tunnel_edges: int


def sublevels(plane: Plane, *, tunnels: bool = True) -> Sublevels:
    """Build the whole caging graph and read it off. O(n^3) regions, so for small n.

    A pinched hand is the oldest minimum of all: every way out ends there, and all pinched hands
    are one (they are connected through the free plane).
    """
    space = plane.space
    regions, nodes, known = all_regions(space)
    edges, values = all_seams(space, regions, known)
    crossed = plane.tunnel_edges() if tunnels else NO_TUNNEL_EDGES
    edges = np.vstack([edges, _ends(plane, crossed, known)])
    values = np.concatenate([values, crossed.hands[:, HAND_LEVEL]])
    births, rows, values = _with_pinch(nodes[:, NODE_SIGMA].copy(), edges, values, space.pinch)
    tree = persistence(births, rows, values, np.inf)
    ended = np.full(len(births), np.inf)
    ended[tree.merges[:, MERGE_YOUNGER]] = tree.levels
    depth = ended[:-1] - births[:-1]
    kept = np.flatnonzero((depth > DEPTH_CUT * plane.outline.diameter) & (births[:-1] > 0.0))
    kept = kept[np.argsort(births[kept], kind="stable")]
    hands = hands_at(space, regions[kept], nodes[kept])
    contacts = np.array([plane.contacts(h) for h in hands]).reshape(-1, 3, 2)
    return Sublevels(births[kept], ended[kept], contacts, len(regions), len(crossed.rows))


def _ends(plane: Plane, crossed: TunnelEdges, known: Mapping[int, int]) -> IntArray:
    """Regions (t, 2) at the upper and the lower end of tunnel edges; -1 = a pinched hand."""
    above, below = crossed.rows[:, ABOVE], crossed.rows[:, BELOW]
    ends = np.full((len(crossed.rows), 2), -1, dtype=np.int64)
    ends[:, 0] = [known[key] for key in plane.keys(above).tolist()]
    landed = np.flatnonzero(below[:, 0] >= 0)
    ends[landed, 1] = [known[key] for key in plane.keys(below[landed]).tolist()]
    return ends


def _with_pinch(
    births: FloatArray, edges: IntArray, values: FloatArray, pinch: float
) -> tuple[FloatArray, IntArray, FloatArray]:
    """One more node for all pinched hands, at sigma 0, and its edges."""
    node = len(births)
    low = np.where(births <= pinch, 0.0, births)
    pinched = np.flatnonzero(low == 0.0)
    out = np.column_stack([pinched, np.full(len(pinched), node)])
    rows = edges.copy()
    rows[rows[:, EDGE_TO] < 0, EDGE_TO] = node
    levels = np.concatenate([values, np.zeros(len(pinched))])
    return np.append(low, -1.0), np.vstack([rows, out]), levels
