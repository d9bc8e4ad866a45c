"""Best-first search over cells, keyed by the pass value: the sublevel structure around a cell.

A cell "finger 1 in piece a, finger 2 in b, finger 3 in c" is one convex set of R^4 on which
sigma = |w| is convex, so its sublevel sets are connected; two cells that differ by one step of one
finger across a shared edge join exactly at the least sigma on that facet. Taking passes in
ascending order [Prim1957] visits everything that is reachable below a level before anything above
it. Our own. [docs/theory.md, Sec. 3.2, Sec. 3.4]
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import (
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_KEY,
    EDGE_SLOT,
    EDGE_TO,
    NODE_EDGE,
    PASS_SIGMA,
    PASS_WX,
    PASS_WY,
    RECORD_BIRTH,
    RECORD_LEVEL,
    RECORD_NODE,
    Ending,
)
from icage.cells.kernels.facet import facet_of, finger_on_segment
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.shrink import pivot
from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import (
    hash_slot,
    heap_pop,
    heap_push,
    longer,
    put_first,
    rehashed,
)

GAVE_UP, CLOSED_IN, ESCAPED, MET = Ending

SIGHT = 1e-11
"""[diameter] What two fingers see of each other is decided with this much to spare."""

TIE = 1e-12
"""[diameter] Passes this close to the running maximum are looked at as if they were it: pass
values are good to about this, and a pass through a vertex has several facets of one value."""

DEEP = 1e-5
"""[diameter] A basin known to be this deep is followed no further: above every depth cut in use."""


class Birth(NamedTuple):
    """Least sigma of a cell, w there, and a finger that is on an edge of its piece (-1: none)."""

    sigma: float
    w_x: float
    w_y: float
    finger: int
    slot: int


class Explored(NamedTuple):
    """What a search has found; the columns are named in ``icage.cells.kernels.columns``.

    Attributes
    ----------
    standing:
        The finger that the others shrink to (-1: none needed).
    nodes:
        (k, 4) = pieces a, b, c and the edge that led here (-1 at the start).
    node_level:
        (k,) running maximum at entry.
    edges:
        (e, 5) = from node, to node (-1 never visited), finger, slot, key of the cell it leads to.
    edge_value:
        (e, 3) = sigma, w_x, w_y.
    records:
        (r, 3) = level at the running maximum, birth of the cell behind it, its node.
    tally:
        (2,) = passes computed, those in double-double.
    keys, values:
        The hash table from cell key to node.
    """

    outcome: Ending
    level: float
    standing: int
    nodes: np.ndarray
    node_level: np.ndarray
    edges: np.ndarray
    edge_value: np.ndarray
    records: np.ndarray
    tally: np.ndarray
    keys: np.ndarray
    values: np.ndarray


@compiled_borrowing
def birth(pieces, z, cell, cap, worst, room):
    """Least sigma of a cell (3,) and where.

    At a positive minimum at least two fingers are held by an edge of their piece, so finger 1 or
    finger 2 is: the minimum over the cell is the least pass value over the edges of these two.
    """
    if cell[0] == cell[1] and cell[1] == cell[2]:
        return Birth(0.0, 0.0, 0.0, -1, -1)
    best = cap
    wx = 0.0
    wy = 0.0
    found = False
    at_finger = -1
    at_slot = -1
    for i in range(2):
        piece = cell[i]
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            value, vx, vy = pass_value(pieces, z, facet_of(pieces, cell, i, s), best, worst, room)
            if value < best or (not found and value <= best):
                best, wx, wy = value, vx, vy
                at_finger, at_slot = i, s
                found = True
    if not found:
        return Birth(np.inf, 0.0, 0.0, -1, -1)
    return Birth(best, wx, wy, at_finger, at_slot)


@compiled_borrowing
def _least_on_walls(pieces, z, cell, least, worst, room):
    """Least sigma with finger 1 or 2 on an edge that leads nowhere, or ``least`` if that is less.

    What else could be the least sigma of the cell (see ``birth``) are passes, which the search
    computes when it opens them.
    """
    if cell[0] == cell[1] and cell[1] == cell[2]:
        return 0.0
    for i in range(2):
        piece = cell[i]
        for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
            if pieces.slot_neighbour[s] < 0:
                facet = facet_of(pieces, cell, i, s)
                least = min(least, pass_value(pieces, z, facet, least, worst, room).sigma)
    return least


@compiled
def explore(pieces, z, start, floor, cap, worst, stop_above, node_limit, enough):
    """Search from the cell ``start`` (3,), born at ``floor``, until the hand escapes.

    It has escaped when all fingers are in one piece, or when it can shrink to a point at once.
    ``stop_above`` ends the search when every open pass is above that level, ``node_limit`` when
    so many cells were entered, ``enough`` when a basin is known to be deeper than that.
    """
    m = len(pieces.ptr) - 1
    room = new_room()
    barred = np.zeros(3, np.int64)
    nodes = np.empty((256, 4), np.int64)
    node_level = np.empty((256, 1))
    edges = np.empty((1024, 5), np.int64)
    edge_value = np.empty((1024, 3))
    records = np.empty((64, 3))
    keys = np.full(1024, -1, np.int64)
    values = np.empty(1024, np.int64)
    heap_value = np.empty((1024, 1))
    heap_item = np.empty((1024, 1), np.int64)
    n_nodes = 0
    n_edges = 0
    n_records = 0
    n_heap = 0
    level = floor
    tie = max(TIE * pieces.scale, worst)
    outcome = CLOSED_IN
    standing = -1
    cell = np.empty(3, np.int64)
    put_first(cell, start, 3)
    via = -1
    while True:
        # enter the cell
        key = (cell[0] * m + cell[1]) * m + cell[2]
        at = hash_slot(keys, key)
        keys[at] = key
        values[at] = n_nodes
        here = n_nodes
        nodes[here, 0], nodes[here, 1], nodes[here, 2] = cell[0], cell[1], cell[2]
        nodes[here, NODE_EDGE] = via
        node_level[here, 0] = level
        if via >= 0:
            edges[via, EDGE_TO] = here
        n_nodes += 1
        if 2 * n_nodes > len(keys):
            keys, values = rehashed(keys, values)
        if n_nodes == nodes.shape[0]:
            nodes = longer(nodes)
            node_level = longer(node_level)
        if cell[0] == cell[1] and cell[1] == cell[2]:
            outcome = ESCAPED
            break
        if via >= 0:
            finger, slot = edges[via, EDGE_FINGER], edges[via, EDGE_SLOT]
            facet = facet_of(pieces, nodes[edges[via, EDGE_FROM]], finger, slot)
            wx, wy = edge_value[via, PASS_WX], edge_value[via, PASS_WY]
            ends = finger_on_segment(pieces, z, facet, wx, wy, room.base)
            dx = 0.5 * (ends.x_lo + ends.x_hi) - wx * z[finger, 0] + wy * z[finger, 1]
            dy = 0.5 * (ends.y_lo + ends.y_hi) - wx * z[finger, 1] - wy * z[finger, 0]
            standing = pivot(pieces, z, dx, dy, wx, wy, SIGHT * pieces.scale, barred)
            if standing >= 0:
                outcome = ESCAPED
                break
        if n_nodes > node_limit:
            outcome = GAVE_UP
            break
        # open its passes
        for i in range(3):
            piece = cell[i]
            for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
                other = pieces.slot_neighbour[s]
                if other < 0:
                    continue
                step = other - piece
                if i == 0:
                    to_key = key + step * m * m
                elif i == 1:
                    to_key = key + step * m
                else:
                    to_key = key + step
                at = hash_slot(keys, to_key)
                if keys[at] != -1:
                    continue
                value, wx, wy = pass_value(
                    pieces, z, facet_of(pieces, cell, i, s), cap, worst, room
                )
                if value == np.inf:
                    continue
                if n_records > 0 and value < records[n_records - 1, RECORD_BIRTH]:
                    records[n_records - 1, RECORD_BIRTH] = value
                if n_edges == edges.shape[0]:
                    edges = longer(edges)
                    edge_value = longer(edge_value)
                edges[n_edges, EDGE_FROM], edges[n_edges, EDGE_TO] = here, -1
                edges[n_edges, EDGE_FINGER], edges[n_edges, EDGE_SLOT] = i, s
                edges[n_edges, EDGE_KEY] = to_key
                edge_value[n_edges, PASS_SIGMA] = value
                edge_value[n_edges, PASS_WX], edge_value[n_edges, PASS_WY] = wx, wy
                if n_heap == heap_value.shape[0]:
                    heap_value = longer(heap_value)
                    heap_item = longer(heap_item)
                heap_push(heap_value[:, 0], heap_item[:, 0], n_heap, value, n_edges)
                n_heap += 1
                n_edges += 1
        if n_records > 0:
            last = n_records - 1
            if records[last, RECORD_LEVEL] - records[last, RECORD_BIRTH] > enough:
                outcome = MET
                break
        # the lowest pass to a cell not seen yet
        found = False
        while n_heap > 0 and not found:
            value = heap_value[0, 0]
            via = heap_item[0, 0]
            heap_pop(heap_value[:, 0], heap_item[:, 0], n_heap)
            n_heap -= 1
            at = hash_slot(keys, edges[via, EDGE_KEY])
            if keys[at] == -1:
                found = True
            else:
                edges[via, EDGE_TO] = values[at]
        if not found:
            level = np.inf
            break
        if value > stop_above:
            level = value
            break
        source = edges[via, EDGE_FROM]
        cell[0], cell[1], cell[2] = nodes[source, 0], nodes[source, 1], nodes[source, 2]
        cell[edges[via, EDGE_FINGER]] = pieces.slot_neighbour[edges[via, EDGE_SLOT]]
        if value >= level - tie:
            # entered for the first time at the running maximum, so what lies lower behind this
            # pass was not reachable below it; ties (several facets through one vertex) included
            level = max(level, value)
            if n_records == records.shape[0]:
                records = longer(records)
            records[n_records, RECORD_LEVEL] = level
            records[n_records, RECORD_BIRTH] = _least_on_walls(pieces, z, cell, level, worst, room)
            records[n_records, RECORD_NODE] = n_nodes
            n_records += 1
        elif n_records > 0:
            # further into the basin behind the last record: its depth is not that of the cell it
            # was entered by, which may be a sliver
            last = n_records - 1
            if records[last, RECORD_LEVEL] - records[last, RECORD_BIRTH] < DEEP * pieces.scale:
                records[last, RECORD_BIRTH] = _least_on_walls(
                    pieces, z, cell, records[last, RECORD_BIRTH], worst, room
                )
    # passes left open may still lead between two visited cells
    for e in range(n_edges):
        if edges[e, EDGE_TO] == -1:
            at = hash_slot(keys, edges[e, EDGE_KEY])
            if keys[at] != -1:
                edges[e, EDGE_TO] = values[at]
    return Explored(
        outcome,
        level,
        standing,
        nodes[:n_nodes],
        node_level[:n_nodes, 0],
        edges[:n_edges],
        edge_value[:n_edges],
        records[:n_records],
        room.tally,
        keys,
        values,
    )
