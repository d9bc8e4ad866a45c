"""The incremental best-first search for the escape path. [Bunis2018, Sec. VI]

The graph is the paper's with every clique of a region's nodes written as a star: the region's
least node in the middle, one node per seam round it (Eq. (5), clamped). By convexity the star has
the same sublevel sets as the clique and needs 14 edges instead of 91. Regions are expanded one by
one, not whole rectangles.
"""

# pyright: basic
from __future__ import annotations

import heapq

import numpy as np
from numba import types
from numba.typed import Dict

from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    finger_at,
    least_of_region,
    region_corners,
    seam_value,
    third_finger,
)  # fmt: skip
from icage.contact_space.kernels.shooting import (
    LANDED,
    NO_TUNNEL,
    piece_of,
    shoot,
    touches,
)
from icage.kernels.compiled import compiled

ESCAPED, CLOSED_IN, GAVE_UP = 0, 1, 2

SEAM, TUNNEL, PINCH = 0, 1, 2
"""Kinds of graph edges; a pinch is a tunnel edge that ends with all fingers in one point."""

CHECK = -1
"""Label of an open entry that asks whether a region's least node needs a tunnel edge."""

UPWARDS = -2
"""Labels from here downwards are tunnel edges that land in the region: number UPWARDS - label."""


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
def longer(array):
    """A copy with room for twice as many rows."""
    rows, columns = array.shape
    larger = np.empty((2 * rows, columns), array.dtype)
    for a in range(rows):
        for b in range(columns):
            larger[a, b] = array[a, b]
    return larger


@compiled
def copy(values, out, first):
    """``out[first:first + len(values)] = values``; a slice would take seconds to compile."""
    for a in range(len(values)):
        out[first + a] = values[a]


@compiled
def needs_tunnel(space, region, node, known, nodes, corners, spare):
    """Whether a region's least node may be a minimum of contact space with the third finger free.

    Not if a seam at its level leads to a deeper region, nor if the third finger touches: then two
    of the three contacts can be kept while the hand closes.
    """
    i, j, k, c = region[0], region[1], region[2], region[3]
    low = node[0]
    x, y = third_finger(space, i, j, k, node[1], node[2])
    if touches(space, x, y):
        return False
    out = np.empty((2, 4), np.int64)
    count = region_corners(space, i, j, k, c, corners, spare)
    for label in range(FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]):
        value, _, _ = seam_value(space, i, j, k, c, label, corners, count)
        if value > low + space.tie:
            continue
        for a in range(across(space, i, j, k, c, label, out)):
            key = region_key(space, out[a, 0], out[a, 1], out[a, 2], out[a, 3])
            if key in known and nodes[known[key], 0] < low - space.tie:
                return False
    return True


@compiled
def add_region(space, region, parent, level, corners, count, ints, floats, r):
    """Write row r: ints = i, j, k, c, parent edge; floats = birth, s, u, level."""
    if r == len(ints):
        ints, floats = longer(ints), longer(floats)
    for a in range(4):
        ints[r, a] = region[a]
    ints[r, 4] = parent
    low, s, u, s_too, u_too = least_of_region(
        space, region[0], region[1], region[2], corners, count
    )
    # the middle of a valley, where the third finger is least likely to touch
    floats[r, 0], floats[r, 1], floats[r, 2] = low, 0.5 * (s + s_too), 0.5 * (u + u_too)
    floats[r, 3] = max(level, low) if r == 0 else level
    return ints, floats


@compiled
def open_seams(space, region, r, tunnels, low, corners, count, ints, floats, p, heap):
    """Put the seams of region r on the open list, and its least node for a tunnel edge."""
    i, j, k, c = region[0], region[1], region[2], region[3]
    labels = FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]
    for label in range(labels + 1):
        if label == labels:
            if not tunnels:
                break
            # after everything at the same level has been met
            value, s, u, name = low + 2.0 * space.tie, 0.0, 0.0, CHECK
        else:
            name = label
            value, s, u = seam_value(space, i, j, k, c, label, corners, count)
            if value == np.inf:
                continue
        if p == len(ints):
            ints, floats = longer(ints), longer(floats)
        ints[p, 0], ints[p, 1] = r, name
        floats[p, 0], floats[p, 1] = s, u
        heapq.heappush(heap, (value, p))
        p += 1
    return ints, floats, p


@compiled
def find_tunnel(space, region, s, u, target, where):
    """The tunnel edge of a least node: NO_TUNNEL, PINCHED or LANDED, and the finger kept.

    Landed: ``target`` (4,) is the region, ``where`` (4,) as of ``shoot``.
    """
    i, j, k = region[0], region[1], region[2]
    for keep in range(2):
        ended = shoot(space, i, j, k, s, u, keep, target, where)
        if ended == LANDED:
            target[3] = piece_of(space, target[0], target[1], target[2], where[2], where[3])
            if target[3] < 0:
                continue
        if ended != NO_TUNNEL:
            return ended, keep
    return NO_TUNNEL, 0


@compiled
def open_tunnels(key, r, above_keys, above_hands, ints, floats, p, heap):
    """Put the tunnel edges that land in region r on the open list, to be taken upwards."""
    t = np.searchsorted(above_keys, key)
    while t < len(above_keys) and above_keys[t] == key:
        if p == len(ints):
            ints, floats = longer(ints), longer(floats)
        ints[p, 0], ints[p, 1] = r, UPWARDS - t
        floats[p, 0], floats[p, 1] = 0.0, 0.0
        heapq.heappush(heap, (above_hands[t, 0], p))
        p += 1
        t += 1
    return ints, floats, p


@compiled
def explore(space, start, tunnels, above_keys, above, above_hands, stop_above, limit):
    """Search from region ``start`` (4,) for a pinched hand.

    ``above_keys`` (t,) ascending, ``above`` (t, 9) and ``above_hands`` (t, 9) are tunnel edges by
    the key of the region in which they land, as of ``all_tunnels``: taken from below.

    Returns (outcome, level, regions (r, 5) = i, j, k, c, parent edge, nodes (r, 4) = birth, s, u,
    level reached at; edges (e, 4) = from, to, label or finger kept, kind; hands (e, 9) = level, a
    hand (d, w) of least sigma on the edge, the hand where a tunnel lands; entries (p, 2) = region,
    label, places (p, 2), open entries, tally (2,) = tunnel edges tried, used). In an edge that
    pinches, ``to`` is -1.
    """
    known = Dict.empty(types.int64, types.int64)
    regions, nodes = np.empty((256, 5), np.int64), np.empty((256, 4))
    edges, hands = np.empty((512, 4), np.int64), np.empty((512, 9))
    entries, places = np.empty((1024, 2), np.int64), np.empty((1024, 2))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    targets = np.empty((2, 4), np.int64)
    hand, where = np.zeros(9), np.empty(4)
    tally = np.zeros(2, np.int64)
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
                edges[e, 0], edges[e, 2], edges[e, 3] = origin, via, kind
                edges[e, 1] = -1 if pinched else (r if new else known[key])
                copy(hand, hands[e], 0)
                e += 1
            if pinched or (new and kind == TUNNEL):
                tally[1] += 1
            if pinched:
                outcome = ESCAPED
            if not new:
                continue
            known[key] = r
            regions, nodes = add_region(
                space, targets[a], e - 1, level, corners, count, regions, nodes, r
            )
            level = nodes[r, 3]
            if nodes[r, 0] <= space.pinch:
                outcome = ESCAPED
            else:
                entries, places, p = open_seams(
                    space, targets[a], r, tunnels, nodes[r, 0], corners, count, entries, places,
                    p, heap,
                )  # fmt: skip
                entries, places, p = open_tunnels(
                    key, r, above_keys, above_hands, entries, places, p, heap
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
        origin, via = entries[entry, 0], entries[entry, 1]
        i, j, k = regions[origin, 0], regions[origin, 1], regions[origin, 2]
        queue = 0
        if via <= UPWARDS:
            level = max(level, value)
            t = UPWARDS - via
            kind, via, queue = TUNNEL, above[t, 8], 1
            for b in range(4):
                targets[0, b] = above[t, b]
                hand[1 + b], hand[5 + b] = above_hands[t, 5 + b], above_hands[t, 1 + b]
            hand[0] = value
        elif via != CHECK:
            level = max(level, value)
            kind, hand[0] = SEAM, value
            queue = across(space, i, j, k, regions[origin, 3], via, targets)
            configuration(space, i, j, k, places[entry, 0], places[entry, 1], hand, 1)
            copy(hand[1:5], hand, 5)
        elif needs_tunnel(space, regions[origin], nodes[origin], known, nodes, corners, spare):
            tally[0] += 1
            s, u = nodes[origin, 1], nodes[origin, 2]
            ended, via = find_tunnel(space, regions[origin], s, u, targets[0], where)
            if ended != NO_TUNNEL:
                hand[0] = nodes[origin, 0]
                configuration(space, i, j, k, s, u, hand, 1)
                queue, kind = 1, PINCH
                if ended == LANDED:
                    kind = TUNNEL
                    configuration(
                        space, targets[0, 0], targets[0, 1], targets[0, 2], where[0], where[1],
                        hand, 5,
                    )  # fmt: skip
    left = np.array([entry for _, entry in heap], np.int64)
    return (
        outcome, level, regions[:r], nodes[:r], edges[:e], hands[:e], entries[:p], places[:p],
        left, tally,
    )  # fmt: skip
