"""The whole caging graph of one hand: all regions of all rectangles. [Bunis2018, Def. 7]"""

# pyright: basic
from __future__ import annotations

import numpy as np
from numba import types
from numba.typed import Dict

from icage.contact_space.kernels.explore import configuration, find_tunnel, longer, region_key
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    least_of_region,
    region_corners,
    seam_value,
    third_finger,
)
from icage.contact_space.kernels.shooting import LANDED, NO_TUNNEL, touches
from icage.kernels.compiled import compiled


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
                    nodes[r, 0], nodes[r, 1], nodes[r, 2] = (
                        low,
                        0.5 * (s + s_too),
                        0.5 * (u + u_too),
                    )
                    r += 1
    return regions[:r], nodes[:r], known


@compiled
def all_edges(space, regions, nodes, known, tunnels):
    """Edges (e, 3) = from, to (-1: a pinch), kind and levels (e,) of the whole graph.

    Kind 0 is a seam, 1 a tunnel edge. As in the search, tunnels start only where no seam at the
    level of a least node leads deeper and the third finger is free. [Bunis2018, Sec. V-B]
    """
    edges, values = np.empty((1024, 3), np.int64), np.empty((1024, 1))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    targets = np.empty((2, 4), np.int64)
    where = np.empty(4)
    e = 0
    for r in range(len(regions)):
        i, j, k, c = regions[r, 0], regions[r, 1], regions[r, 2], regions[r, 3]
        count = region_corners(space, i, j, k, c, corners, spare)
        lowest = True
        for label in range(FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]):
            value, _, _ = seam_value(space, i, j, k, c, label, corners, count)
            if value == np.inf:
                continue
            for a in range(across(space, i, j, k, c, label, targets)):
                key = region_key(space, targets[a, 0], targets[a, 1], targets[a, 2], targets[a, 3])
                if key not in known:
                    continue
                other = known[key]
                if value <= nodes[r, 0] + space.tie and nodes[other, 0] < nodes[r, 0] - space.tie:
                    lowest = False
                if e == len(edges):
                    edges, values = longer(edges), longer(values)
                edges[e, 0], edges[e, 1], edges[e, 2], values[e, 0] = r, other, 0, value
                e += 1
        if not (tunnels and lowest) or nodes[r, 0] <= space.pinch:
            continue
        s, u = nodes[r, 1], nodes[r, 2]
        x, y = third_finger(space, i, j, k, s, u)
        if touches(space, x, y):
            continue
        ended, _ = find_tunnel(space, regions[r], s, u, targets[0], where)
        if ended == NO_TUNNEL:
            continue
        to = np.int64(-1)
        if ended == LANDED:
            to = known[
                region_key(space, targets[0, 0], targets[0, 1], targets[0, 2], targets[0, 3])
            ]
        if e == len(edges):
            edges, values = longer(edges), longer(values)
        edges[e, 0], edges[e, 1], edges[e, 2], values[e, 0] = r, to, 1, nodes[r, 0]
        e += 1
    return edges[:e], values[:e, 0].copy()


@compiled
def hands_at(space, regions, nodes):
    """Hands (r, 4) = d, w at the least nodes."""
    hands = np.empty((len(regions), 4))
    for r in range(len(regions)):
        configuration(
            space, regions[r, 0], regions[r, 1], regions[r, 2], nodes[r, 1], nodes[r, 2],
            hands[r], 0,
        )  # fmt: skip
    return hands
