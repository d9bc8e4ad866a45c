"""The merge tree of the cells that a search has visited: minima, merges, and who is joined when."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.cells.kernels.facet import MAX_BASE, MAX_ROWS, pass_value
from icage.cells.kernels.search import birth
from icage.kernels.compiled import compiled


@compiled
def births(pieces, z, nodes, cap, worst):
    """Least sigma of every node: (n, 3) = sigma, w_x, w_y and (n, 2) = finger, slot."""
    base = np.empty((MAX_BASE, 5))
    rows = np.empty((MAX_ROWS, 4))
    tally = np.zeros(2, np.int64)
    value = np.empty((len(nodes), 3))
    where = np.empty((len(nodes), 2), np.int64)
    for k in range(len(nodes)):
        value[k, 0], value[k, 1], value[k, 2], where[k, 0], where[k, 1] = birth(
            pieces, z, nodes[k, 0], nodes[k, 1], nodes[k, 2], cap, worst, base, rows, tally
        )
    return value, where


@compiled
def find_at(parent, stamp, node, level):
    """Representative of ``node``'s component among the cells joined at or below ``level``."""
    while parent[node] != node and stamp[node] <= level:
        node = parent[node]
    return node


@compiled
def merge(node_birth, edges, edge_value, below):
    """Kruskal's union over the passes below a level. [Kruskal1956]

    Union by size, no path compression: ``stamp`` is the level at which a node was hung below its
    parent, so that the tree answers for every level. Returns (parent, stamp, merges, lows):
    merges (m, 4) ints = surviving minimum, swallowed minimum (nodes), edge, 1 if the start (node
    0) was on the swallowed side or 2 if on the surviving one, 0 if on neither; lows (m, 2) =
    level, level - birth of the swallowed minimum.
    """
    n = len(node_birth)
    parent = np.arange(n)
    stamp = np.full(n, np.inf)
    size = np.ones(n, np.int64)
    lowest = np.arange(n)
    merges = np.empty((n, 4), np.int64)
    lows = np.empty((n, 2))
    count = 0
    order = np.argsort(edge_value, kind="mergesort")
    for e in order:
        if edge_value[e] >= below:
            break
        if edges[e, 1] < 0:
            continue
        a = find_at(parent, stamp, edges[e, 0], np.inf)
        b = find_at(parent, stamp, edges[e, 1], np.inf)
        if a == b:
            continue
        start = find_at(parent, stamp, 0, np.inf)
        low_a = lowest[a]
        low_b = lowest[b]
        swap = node_birth[low_a] > node_birth[low_b] or (
            node_birth[low_a] == node_birth[low_b] and low_a > low_b
        )
        keep, lose = (low_b, low_a) if swap else (low_a, low_b)
        merges[count, 0], merges[count, 1], merges[count, 2] = keep, lose, e
        merges[count, 3] = 0
        if start == a or start == b:
            merges[count, 3] = 1 if (start == a) == swap else 2
        lows[count, 0] = edge_value[e]
        lows[count, 1] = edge_value[e] - node_birth[lose]
        count += 1
        if size[a] < size[b]:
            a, b = b, a
        parent[b] = a
        stamp[b] = edge_value[e]
        size[a] += size[b]
        lowest[a] = keep
    return parent, stamp, merges[:count], lows[:count]


@compiled
def lowest_cells(pieces, z, cap, worst, tie, cut):
    """Cells of the whole free space whose least point no neighbour across a facet goes below.

    Returns (cells (n, 3), birth (n, 3), birth_at (n, 2)). A necessary condition for a local
    minimum, tested facet by facet; cells that meet only at a vertex are left to the caller.
    Complexity: all m^3 cells, about 4 us each.
    """
    m = len(pieces.ptr) - 1
    base = np.empty((MAX_BASE, 5))
    rows = np.empty((MAX_ROWS, 4))
    tally = np.zeros(2, np.int64)
    low = np.empty((m, m, m))
    where = np.empty((m, m, m, 2), np.int64)
    at = np.empty((m, m, m, 2))
    for a in range(m):
        for b in range(m):
            for c in range(m):
                low[a, b, c], at[a, b, c, 0], at[a, b, c, 1], f, s = birth(
                    pieces, z, a, b, c, cap, worst, base, rows, tally
                )
                where[a, b, c, 0] = f
                where[a, b, c, 1] = s
    cells = np.empty((256, 3), np.int64)
    count = 0
    cell = np.empty(3, np.int64)
    other = np.empty(3, np.int64)
    for a in range(m):
        for b in range(m):
            for c in range(m):
                here = low[a, b, c]
                if not 0.0 < here < np.inf:
                    continue
                cell[0], cell[1], cell[2] = a, b, c
                lowest = True
                for i in range(3):
                    for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
                        if pieces.slot_neighbour[s] < 0:
                            continue
                        other[:] = cell
                        other[i] = pieces.slot_neighbour[s]
                        if low[other[0], other[1], other[2]] >= here - cut:
                            continue
                        t = s + 1 if s + 1 < pieces.ptr[cell[i] + 1] else pieces.ptr[cell[i]]
                        j = (i + 1) % 3
                        k = (i + 2) % 3
                        value, _, _ = pass_value(
                            pieces, z, i, pieces.slot_vertex[s], pieces.slot_vertex[t],
                            j, cell[j], k, cell[k], here + 2.0 * tie, worst, base, rows, tally,
                        )  # fmt: skip
                        if value <= here + tie:
                            lowest = False
                            break
                    if not lowest:
                        break
                if lowest:
                    if count == len(cells):
                        cells = np.concatenate((cells, np.empty_like(cells)))
                    cells[count] = cell
                    count += 1
    births_out = np.empty((count, 3))
    where_out = np.empty((count, 2), np.int64)
    for n in range(count):
        a, b, c = cells[n, 0], cells[n, 1], cells[n, 2]
        births_out[n, 0] = low[a, b, c]
        births_out[n, 1] = at[a, b, c, 0]
        births_out[n, 2] = at[a, b, c, 1]
        where_out[n] = where[a, b, c]
    return cells[:count], births_out, where_out


@compiled
def all_passes(pieces, z, cap, worst):
    """Births (m^3,) of all cells and all passes: edges (e, 4), as ``merge`` wants them, and values.

    Cell (a, b, c) has the number (a m + b) m + c. Complexity: m^3 cells, some 10 passes each.
    """
    m = len(pieces.ptr) - 1
    base = np.empty((MAX_BASE, 5))
    rows = np.empty((MAX_ROWS, 4))
    tally = np.zeros(2, np.int64)
    low = np.empty(m * m * m)
    edges = np.empty((3 * m * m * len(pieces.slot_vertex) // 2 + 1, 4), np.int64)
    values = np.empty(len(edges))
    cell = np.empty(3, np.int64)
    step = np.array([m * m, m, 1])
    e = 0
    for number in range(m * m * m):
        cell[0], cell[1], cell[2] = number // (m * m), number // m % m, number % m
        low[number], _, _, _, _ = birth(
            pieces, z, cell[0], cell[1], cell[2], cap, worst, base, rows, tally
        )
        if low[number] == np.inf:
            continue
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            for s in range(pieces.ptr[cell[i]], pieces.ptr[cell[i] + 1]):
                if pieces.slot_neighbour[s] <= cell[i]:
                    continue
                t = s + 1 if s + 1 < pieces.ptr[cell[i] + 1] else pieces.ptr[cell[i]]
                value, _, _ = pass_value(
                    pieces, z, i, pieces.slot_vertex[s], pieces.slot_vertex[t],
                    j, cell[j], k, cell[k], cap, worst, base, rows, tally,
                )  # fmt: skip
                if value == np.inf:
                    continue
                edges[e, 0] = number
                edges[e, 1] = number + (pieces.slot_neighbour[s] - cell[i]) * step[i]
                edges[e, 2], edges[e, 3] = i, s
                values[e] = value
                e += 1
    return low, edges[:e], values[:e]
