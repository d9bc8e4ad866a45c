"""The incremental best-first search for the escape path. [Bunis2018, Sec. VI]

The graph is the paper's with every clique of a region's nodes written as a star: the region's
least node in the middle, one node per seam round it (Eq. (5), clamped). By convexity the star has
the same sublevel sets as the clique and needs 14 edges instead of 91. Regions are expanded one by
one, not whole rectangles.
"""

# pyright: basic
from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np
from numba import types
from numba.typed import Dict

from icage.contact_space.kernels.columns import (
    EDGE_FROM,
    EDGE_KIND,
    EDGE_LABEL,
    EDGE_TO,
    END_LOWER,
    END_ROW,
    ENTRY_LABEL,
    ENTRY_REGION,
    HAND_LEVEL,
    NODE_LEVEL,
    NODE_S,
    NODE_SIGMA,
    NODE_U,
    REGION_EDGE,
    REGION_J,
    REGION_K,
    REGION_PAIR,
    REGION_PIECE,
    TUNNEL_BELOW,
    EdgeKind,
    Ending,
)
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    finger_at,
    least_of_region,
    region_corners,
    seam_value,
)  # fmt: skip
from icage.kernels.compiled import compiled
from icage.kernels.storage import longer

ESCAPED, CLOSED_IN, GAVE_UP = Ending

SEAM, TUNNEL, PINCH = EdgeKind

FIRST_END = -1
"""Labels from here downwards are ends of tunnel edges: end number FIRST_END - label."""


class Explored(NamedTuple):
    """What a search has found; the columns are named in ``icage.contact_space.kernels.columns``.

    Attributes
    ----------
    regions, nodes:
        (r, 5) = i, j, k, c, edge first reached by; (r, 4) = least sigma, s, u, level reached at.
    edges, hands:
        (e, 4) = from, to, label or row of the tunnel edge, kind (in a pinch, ``to`` is -1);
        (e, 9) = level, a hand (d, w) of least sigma, the hand at a tunnel's other end.
    entries, places, left:
        Open list: (p, 2) = region, label; (p, 2) = s, u; rows that were never closed.
    tunnels_used:
        Tunnel edges that first reached a region.
    """

    outcome: Ending
    level: float
    regions: np.ndarray
    nodes: np.ndarray
    edges: np.ndarray
    hands: np.ndarray
    entries: np.ndarray
    places: np.ndarray
    left: np.ndarray
    tunnels_used: int


@compiled
def region_key(space, i, j, k, c):
    """One integer per region."""
    n, m = len(space.edge_x), len(space.ptr) - 1
    return ((i * n + j) * n + k) * m + c


@compiled
def configuration(space, i, j, k, s, u, out, at):
    """Write the hand (d_x, d_y, w_x, w_y) whose pair i is at s, u on edges j, k to ``out[at:]``."""
    ax, ay = finger_at(space, j, s)
    bx, by = finger_at(space, k, u)
    re, im = space.unit_re[i], space.unit_im[i]  # w = (f_{i+1} - f_i) * unit_i
    wx, wy = (bx - ax) * re - (by - ay) * im, (bx - ax) * im + (by - ay) * re
    out[at] = ax - (wx * space.z_re[i] - wy * space.z_im[i])
    out[at + 1] = ay - (wx * space.z_im[i] + wy * space.z_re[i])
    out[at + 2], out[at + 3] = wx, wy


@compiled
def copy(values, out, first):
    """``out[first:first + len(values)] = values``; a slice would take seconds to compile."""
    for a in range(len(values)):
        out[first + a] = values[a]


@compiled
def add_region(space, region, parent, level, corners, count, ints, floats, r):
    """Write row r of the regions (``ints``) and of the nodes (``floats``)."""
    if r == len(ints):
        ints, floats = longer(ints), longer(floats)
    for a in range(4):
        ints[r, a] = region[a]
    ints[r, REGION_EDGE] = parent
    least = least_of_region(space, region[0], region[1], region[2], corners, count)
    # the middle of a valley, where the third finger is least likely to touch
    floats[r, NODE_SIGMA] = least.sigma
    floats[r, NODE_S] = 0.5 * (least.s + least.s_too)
    floats[r, NODE_U] = 0.5 * (least.u + least.u_too)
    floats[r, NODE_LEVEL] = max(level, least.sigma) if r == 0 else level
    return ints, floats


@compiled
def open_seams(space, region, r, corners, count, ints, floats, p, heap):
    """Put the seams of region r on the open list."""
    i, j = region[REGION_PAIR], region[REGION_J]
    k, c = region[REGION_K], region[REGION_PIECE]
    for label in range(FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]):
        value, s, u = seam_value(space, i, j, k, c, label, corners, count)
        if value == np.inf:
            continue
        if p == len(ints):
            ints, floats = longer(ints), longer(floats)
        ints[p, ENTRY_REGION], ints[p, ENTRY_LABEL] = r, label
        floats[p, 0], floats[p, 1] = s, u
        heapq.heappush(heap, (value, p))
        p += 1
    return ints, floats, p


@compiled
def open_tunnels(key, r, end_keys, ends, hands, ints, floats, p, heap):
    """Put the tunnel edges that end in region r on the open list."""
    e = np.searchsorted(end_keys, key)
    while e < len(end_keys) and end_keys[e] == key:
        if p == len(ints):
            ints, floats = longer(ints), longer(floats)
        ints[p, ENTRY_REGION], ints[p, ENTRY_LABEL] = r, FIRST_END - e
        floats[p, 0], floats[p, 1] = 0.0, 0.0
        heapq.heappush(heap, (hands[ends[e, END_ROW], HAND_LEVEL], p))
        p += 1
        e += 1
    return ints, floats, p


@compiled
def explore(space, start, end_keys, ends, tunnels, tunnel_hands, stop_above, limit):
    """Search from region ``start`` (4,) for a pinched hand.

    ``tunnels`` (t, 9) and ``tunnel_hands`` (t, 9) are as of ``all_tunnels``; ``ends`` (e, 2) = row
    of a tunnel edge, 1 if it is taken from below, by ``end_keys`` (e,), ascending, the keys of the
    regions where the search may enter it.
    """
    known = Dict.empty(types.int64, types.int64)
    regions, nodes = np.empty((256, 5), np.int64), np.empty((256, 4))
    edges, hands = np.empty((512, 4), np.int64), np.empty((512, 9))
    entries, places = np.empty((1024, 2), np.int64), np.empty((1024, 2))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    targets = np.empty((2, 4), np.int64)
    hand = np.zeros(9)
    used = 0
    heap = [(0.0, -1)]
    heap.pop()
    r, e, p = 0, 0, 0
    level, outcome = 0.0, CLOSED_IN
    copy(start, targets[0], 0)
    queue, origin, via, kind = 1, -1, -1, SEAM
    while True:
        for a in range(queue):
            pinched = kind == PINCH
            key = np.int64(-1)
            new = False
            count = 0
            if not pinched:
                key = region_key(space, targets[a, 0], targets[a, 1], targets[a, 2], targets[a, 3])
                new = key not in known
                if new:
                    count = region_corners(
                        space, targets[a, 0], targets[a, 1], targets[a, 2], targets[a, 3],
                        corners, spare,
                    )  # fmt: skip
                    if count == 0:
                        continue
            if origin >= 0:
                if e == len(edges):
                    edges, hands = longer(edges), longer(hands)
                edges[e, EDGE_FROM], edges[e, EDGE_LABEL], edges[e, EDGE_KIND] = origin, via, kind
                edges[e, EDGE_TO] = -1 if pinched else (r if new else known[key])
                copy(hand, hands[e], 0)
                e += 1
            if pinched or (new and kind == TUNNEL):
                used += 1
            if pinched:
                outcome = ESCAPED
            if not new:
                continue
            known[key] = r
            regions, nodes = add_region(
                space, targets[a], e - 1, level, corners, count, regions, nodes, r
            )
            level = nodes[r, NODE_LEVEL]
            if nodes[r, NODE_SIGMA] <= space.pinch:
                outcome = ESCAPED
            else:
                entries, places, p = open_seams(
                    space, targets[a], r, corners, count, entries, places, p, heap
                )  # fmt: skip
                entries, places, p = open_tunnels(
                    key, r, end_keys, ends, tunnel_hands, entries, places, p, heap
                )
            r += 1
            if outcome == ESCAPED:
                break
        if outcome == ESCAPED:
            break
        if r > limit:
            outcome = GAVE_UP
            break
        if len(heap) == 0 or heap[0][0] > stop_above:
            level = np.inf
            break
        value, entry = heapq.heappop(heap)
        origin, via = entries[entry, ENTRY_REGION], entries[entry, ENTRY_LABEL]
        i, j = regions[origin, REGION_PAIR], regions[origin, REGION_J]
        k = regions[origin, REGION_K]
        level = max(level, value)
        hand[HAND_LEVEL] = value
        if via >= 0:
            kind = SEAM
            queue = across(space, i, j, k, regions[origin, REGION_PIECE], via, targets)
            configuration(space, i, j, k, places[entry, 0], places[entry, 1], hand, 1)
            copy(hand[1:5], hand, 5)
            continue
        end = FIRST_END - via
        via, upwards = ends[end, END_ROW], ends[end, END_LOWER]
        kind, queue = TUNNEL, 1
        if tunnels[via, TUNNEL_BELOW] < 0:
            kind = PINCH
        for b in range(4):
            targets[0, b] = tunnels[via, b if upwards else 4 + b]
            hand[1 + b] = tunnel_hands[via, 5 + b if upwards else 1 + b]
            hand[5 + b] = tunnel_hands[via, 1 + b if upwards else 5 + b]
    left = np.array([entry for _, entry in heap], np.int64)
    return Explored(
        outcome, level, regions[:r], nodes[:r], edges[:e], hands[:e], entries[:p], places[:p],
        left, used,
    )  # fmt: skip
