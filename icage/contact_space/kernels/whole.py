"""The whole caging graph of one hand: all regions of all rectangles. [Bunis2018, Def. 7]"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.typed import Dict

from icage.contact_space.kernels.columns import NODE_S, NODE_SIGMA, NODE_U
from icage.contact_space.kernels.explore import configuration, region_key
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    least_of_region,
    region_corners,
    seam_value,
)
from icage.kernels.compiled import compiled
from icage.kernels.storage import longer


class Seams(NamedTuple):
    """Seams of the whole graph: edges (e, 2) = from, to and levels (e,)."""

    edges: np.ndarray
    levels: np.ndarray


@compiled
def all_regions(space):
    """Regions (r, 4), nodes (r, 3) = least sigma, s, u, and where each region is (dictionary)."""
    known = Dict.empty(types.int64, types.int64)
    regions, nodes = np.empty((1024, 4), np.int64), np.empty((1024, 3))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    n, m = len(space.edge_x), len(space.ptr) - 1
    r = 0
    for i in range(3):
        for j in range(n):
            for k in range(n):
                for c in range(m):
                    count = region_corners(space, i, j, k, c, corners, spare)
                    if count == 0:
                        continue
                    if r == len(regions):
                        regions, nodes = longer(regions), longer(nodes)
                    low, s, u, s_too, u_too = least_of_region(space, i, j, k, corners, count)
                    known[region_key(space, i, j, k, c)] = r
                    regions[r, 0], regions[r, 1], regions[r, 2], regions[r, 3] = i, j, k, c
                    nodes[r, NODE_SIGMA] = low
                    nodes[r, NODE_S] = 0.5 * (s + s_too)
                    nodes[r, NODE_U] = 0.5 * (u + u_too)
                    r += 1
    return regions[:r], nodes[:r], known


@compiled
def all_seams(space, regions, known):
    """Seams of the whole graph."""
    edges, values = np.empty((1024, 2), np.int64), np.empty((1024, 1))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    targets = np.empty((2, 4), np.int64)
    e = 0
    for r in range(len(regions)):
        i, j, k, c = regions[r, 0], regions[r, 1], regions[r, 2], regions[r, 3]
        count = region_corners(space, i, j, k, c, corners, spare)
        for label in range(FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]):
            value, _, _ = seam_value(space, i, j, k, c, label, corners, count)
            if value == np.inf:
                continue
            for a in range(across(space, i, j, k, c, label, targets)):
                key = region_key(space, targets[a, 0], targets[a, 1], targets[a, 2], targets[a, 3])
                if key not in known:
                    continue
                if e == len(edges):
                    edges, values = longer(edges), longer(values)
                edges[e, 0], edges[e, 1], values[e, 0] = r, known[key], value
                e += 1
    return Seams(edges[:e], values[:e, 0].copy())


@compiled
def hands_at(space, regions, nodes):
    """Hands (r, 4) = d, w at the least nodes."""
    hands = np.empty((len(regions), 4))
    for r in range(len(regions)):
        configuration(
            space, regions[r, 0], regions[r, 1], regions[r, 2], nodes[r, NODE_S],
            nodes[r, NODE_U], hands[r], 0,
        )  # fmt: skip
    return hands
