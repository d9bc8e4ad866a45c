"""The merge tree of the cells that a search has visited: minima, merges, and who is joined when."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BIRTH_WY,
    BORN_FINGER,
    BORN_SLOT,
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_SLOT,
    EDGE_TO,
    LOW_DEPTH,
    LOW_LEVEL,
    MERGE_EDGE,
    MERGE_KEEP,
    MERGE_LOSE,
    MERGE_SIDE,
    NODE_EDGE,
    PASS_SIGMA,
    StartSide,
)
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.search import birth
from icage.kernels.compiled import compiled
from icage.kernels.storage import put_first, stable_order

NEITHER, SWALLOWED, SURVIVING = StartSide


class Births(NamedTuple):
    """Least sigma of cells: value (n, 3) = sigma, w_x, w_y and where (n, 2) = finger, slot."""

    value: np.ndarray
    where: np.ndarray


class Merges(NamedTuple):
    """The merge tree of a graph.

    ``stamp`` (n,) is the level at which a node was hung below its ``parent`` (n,). merges (m, 4) =
    surviving minimum, swallowed minimum (nodes), edge, ``StartSide``; lows (m, 2) = level, level -
    birth of the swallowed minimum.
    """

    parent: np.ndarray
    stamp: np.ndarray
    merges: np.ndarray
    lows: np.ndarray


class LowestCells(NamedTuple):
    """Cells (n, 3), and ``birth`` (n, 3) and ``birth_at`` (n, 2) of each as of ``Births``."""

    cells: np.ndarray
    birth: np.ndarray
    birth_at: np.ndarray


@compiled
def births(pieces, z, nodes, cap, worst):
    """Least sigma of every node, whose pieces are the first columns of ``nodes`` (n, 3 or more)."""
    room = new_room()
    value = np.empty((len(nodes), 3))
    where = np.empty((len(nodes), 2), np.int64)
    for k in range(len(nodes)):
        born = birth(pieces, z, nodes[k], cap, worst, room)
        value[k, BIRTH_SIGMA], value[k, BIRTH_WX], value[k, BIRTH_WY] = (
            born.sigma,
            born.w_x,
            born.w_y,
        )
        where[k, BORN_FINGER], where[k, BORN_SLOT] = born.finger, born.slot
    return Births(value, where)


@compiled
def visited_births(pieces, z, nodes, edges, edge_value, cap, worst):
    """Least sigma (n, 3) of cells that a search has visited, and where (n, 2), as of ``births``.

    All their passes are known to the search, so that only walls and edges of the box are left.
    """
    room = new_room()
    n = len(nodes)
    value = np.empty((n, 3))
    where = np.full((n, 2), -1, np.int64)
    value[:, BIRTH_SIGMA] = np.inf
    value[:, BIRTH_WX] = 0.0
    value[:, BIRTH_WY] = 0.0
    for e in range(len(edges)):
        a = edges[e, EDGE_FROM]
        b = edges[e, EDGE_TO]
        finger = edges[e, EDGE_FINGER]
        slot = edges[e, EDGE_SLOT]
        if a < n and edge_value[e, PASS_SIGMA] < value[a, BIRTH_SIGMA]:
            value[a] = edge_value[e]
            where[a, BORN_FINGER], where[a, BORN_SLOT] = finger, slot
        if 0 <= b < n and edge_value[e, PASS_SIGMA] < value[b, BIRTH_SIGMA]:
            value[b] = edge_value[e]
            where[b, BORN_FINGER] = finger
            where[b, BORN_SLOT] = _other_side(pieces, slot)
    for k in range(n):
        cell = nodes[k]
        if cell[0] == cell[1] and cell[1] == cell[2]:
            value[k] = 0.0
            where[k] = -1
            continue
        best = min(cap, value[k, BIRTH_SIGMA])
        for i in range(2):
            piece = cell[i]
            for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
                if pieces.slot_neighbour[s] >= 0:
                    continue
                sigma, wx, wy = pass_value(
                    pieces, z, facet_of(pieces, cell, i, s), best, worst, room
                )
                if sigma < value[k, BIRTH_SIGMA]:
                    best = sigma
                    value[k, BIRTH_SIGMA] = sigma
                    value[k, BIRTH_WX], value[k, BIRTH_WY] = wx, wy
                    where[k, BORN_FINGER], where[k, BORN_SLOT] = i, s
    return Births(value, where)


@compiled
def way_to(nodes, edges, node):
    """Edges from the first node, where a search began, to this one, in order."""
    count = 0
    at = node
    while nodes[at, NODE_EDGE] >= 0:
        count += 1
        at = edges[nodes[at, NODE_EDGE], EDGE_FROM]
    way = np.empty(count, np.int64)
    at = node
    for k in range(count - 1, -1, -1):
        way[k] = nodes[at, NODE_EDGE]
        at = edges[way[k], EDGE_FROM]
    return way


@compiled
def _other_side(pieces, slot):
    """The slot of the neighbouring piece that is the same edge, the other way round."""
    neighbour = pieces.slot_neighbour[slot]
    first, last = pieces.ptr[neighbour], pieces.ptr[neighbour + 1]
    for s in range(first, last):
        before = s - 1 if s > first else last - 1
        if pieces.slot_vertex[s] == pieces.slot_vertex[slot]:
            return before
    return -1


@compiled
def find_at(parent, stamp, node, level):
    """Representative of ``node``'s component among the cells joined at or below ``level``."""
    while parent[node] != node and stamp[node] <= level:
        node = parent[node]
    return node


@compiled
def merge(node_birth, edges, edge_value, below):
    """Kruskal's union over the passes below a level. [Kruskal1956]

    Union by size, no path compression, so that the tree answers for every level.
    """
    n = len(node_birth)
    parent = np.arange(n)
    stamp = np.full(n, np.inf)
    size = np.ones(n, np.int64)
    lowest = np.arange(n)
    merges = np.empty((n, 4), np.int64)
    lows = np.empty((n, 2))
    count = 0
    order = stable_order(edge_value)
    for e in order:
        if edge_value[e] >= below:
            break
        if edges[e, EDGE_TO] < 0:
            continue
        a = find_at(parent, stamp, edges[e, EDGE_FROM], np.inf)
        b = find_at(parent, stamp, edges[e, EDGE_TO], np.inf)
        if a == b:
            continue
        start = find_at(parent, stamp, 0, np.inf)
        low_a = lowest[a]
        low_b = lowest[b]
        swap = node_birth[low_a] > node_birth[low_b] or (
            node_birth[low_a] == node_birth[low_b] and low_a > low_b
        )
        keep, lose = (low_b, low_a) if swap else (low_a, low_b)
        merges[count, MERGE_KEEP], merges[count, MERGE_LOSE] = keep, lose
        merges[count, MERGE_EDGE] = e
        merges[count, MERGE_SIDE] = NEITHER
        if start == a or start == b:
            merges[count, MERGE_SIDE] = SWALLOWED if (start == a) == swap else SURVIVING
        lows[count, LOW_LEVEL] = edge_value[e]
        lows[count, LOW_DEPTH] = edge_value[e] - node_birth[lose]
        count += 1
        if size[a] < size[b]:
            a, b = b, a
        parent[b] = a
        stamp[b] = edge_value[e]
        size[a] += size[b]
        lowest[a] = keep
    return Merges(parent, stamp, merges[:count], lows[:count])


@compiled
def lowest_cells(pieces, z, cap, worst, tie, cut):
    """Cells of the whole free space whose least point no neighbour across a facet goes below.

    A necessary condition for a local minimum, tested facet by facet; cells that meet
    only at a vertex are left to the caller.
    Complexity: all m^3 cells, about 4 us each.
    """
    m = len(pieces.ptr) - 1
    room = new_room()
    low = np.empty((m, m, m))
    where = np.empty((m, m, m, 2), np.int64)
    at = np.empty((m, m, m, 2))
    cell = np.empty(3, np.int64)
    for a in range(m):
        for b in range(m):
            for c in range(m):
                cell[0], cell[1], cell[2] = a, b, c
                born = birth(pieces, z, cell, cap, worst, room)
                low[a, b, c] = born.sigma
                at[a, b, c, 0], at[a, b, c, 1] = born.w_x, born.w_y
                where[a, b, c, BORN_FINGER], where[a, b, c, BORN_SLOT] = born.finger, born.slot
    cells = np.empty((256, 3), np.int64)
    count = 0
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
                        put_first(other, cell, 3)
                        other[i] = pieces.slot_neighbour[s]
                        if low[other[0], other[1], other[2]] >= here - cut:
                            continue
                        facet = facet_of(pieces, cell, i, s)
                        found = pass_value(pieces, z, facet, here + 2.0 * tie, worst, room)
                        if found.sigma <= here + tie:
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
        births_out[n, BIRTH_SIGMA] = low[a, b, c]
        births_out[n, BIRTH_WX] = at[a, b, c, 0]
        births_out[n, BIRTH_WY] = at[a, b, c, 1]
        where_out[n] = where[a, b, c]
    return LowestCells(cells[:count], births_out, where_out)
