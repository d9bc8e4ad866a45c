"""How deep a disc is, from the few edges that can be nearest: the same bits as from all.

A grid over the object. What is nearest to any point of a cell is among the edges that are farther
from the cell's middle by at most its diagonal than the nearest one is: two or three, mostly. A
cell's are listed when a finger first stands in it, so the grid pays where many closings of one
object are looked at. Where a list would be long, where the outline runs through the cell (inside or
outside is then decided by all edges) and off the grid, all edges are asked.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.world.hand_in_object import depth_at, edge_square
from sim.world.machine_loops import borrowing, inlined

CELLS: Final = 256
"""In a row of the grid: a cell is some 4e-3 diameters wide."""

MANY: Final = 24
"""[closing] From this many on a grid is made. It takes up to 4 MB, and as many grids as there are
objects are kept at a time."""

_LISTED: Final = 7
"""Edges in a list at most: with its length they fill a line of the processor's cache."""

_UNKNOWN, _ALL = 0, _LISTED + 1
"""In place of a length: nobody has been here; no list. Inside the object it is negative."""

_MARGIN: Final = 0.02
"""[diameter] Around discs that touch the object, the grid goes on so far."""

_WIDER: Final = 1e-9
"""[diameter] A cell is taken to be wider, whatever the rounding."""


class NearEdges(NamedTuple):
    """``edges`` (m, m, 1 + _LISTED): how many are listed for a cell, and which; updated.

    ``low`` (2,) is the grid's corner, ``per`` [1 / diameter] its cells per length and ``half``
    [diameter] half a cell's diagonal. m = 0: no grid.
    """

    low: FloatArray
    per: float
    half: float
    edges: IntArray


def near_edges(vertices: FloatArray, radius: float, closings: int) -> NearEdges:
    """An empty grid over a polygon (n, 2), in diameters, for so many closings of it."""
    cells = CELLS if closings >= MANY else 0
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    room = radius + _MARGIN
    side = float((high - low).max()) + 2.0 * room
    half = math.sqrt(0.5) * side / CELLS + _WIDER
    return NearEdges(
        low - room, CELLS / side, half, np.zeros((cells, cells, 1 + _LISTED), np.int64)
    )


@borrowing
def _list_edges(
    vertices: FloatArray, near: NearEdges, column: int, row: int
) -> None:  # pragma: no cover - compiled
    """List the edges that can be nearest to a point of a cell."""
    x, y = near.low[0] + (column + 0.5) / near.per, near.low[1] + (row + 0.5) / near.per
    depth = depth_at(vertices, x, y, 0.0)
    away = abs(depth)
    if not away > near.half:
        near.edges[column, row, 0] = _ALL
        return
    far = away + 2.0 * near.half
    count = vertices.shape[0]
    listed = 0
    for j in range(count):
        i = j - 1 if j > 0 else count - 1
        ax, ay = vertices[i, 0] - x, vertices[i, 1] - y
        bx, by = vertices[j, 0] - x, vertices[j, 1] - y
        if edge_square(ax, ay, bx, by, math.inf) > far * far:
            continue
        if listed == _LISTED:
            near.edges[column, row, 0] = _ALL
            return
        listed += 1
        near.edges[column, row, listed] = j
    near.edges[column, row, 0] = -listed if depth > 0.0 else listed


@inlined
def depth_near(
    vertices: FloatArray, x: float, y: float, radius: float, near: NearEdges
) -> float:  # pragma: no cover - compiled
    """``depth_at`` of a disc with its centre at x, y, to the last bit."""
    cells = near.edges.shape[0]
    u, v = (x - near.low[0]) * near.per, (y - near.low[1]) * near.per
    if not (0.0 <= u < cells and 0.0 <= v < cells):
        return depth_at(vertices, x, y, radius)
    column, row = int(u), int(v)
    if near.edges[column, row, 0] == _UNKNOWN:
        _list_edges(vertices, near, column, row)
    listed = near.edges[column, row, 0]
    if listed == _ALL:
        return depth_at(vertices, x, y, radius)
    nearest = math.inf
    for k in range(1, abs(listed) + 1):
        j = near.edges[column, row, k]
        i = j - 1 if j > 0 else vertices.shape[0] - 1
        ax, ay = vertices[i, 0] - x, vertices[i, 1] - y
        bx, by = vertices[j, 0] - x, vertices[j, 1] - y
        nearest = min(nearest, edge_square(ax, ay, bx, by, nearest))
    signed = math.sqrt(nearest)
    return radius + signed if listed < 0 else radius - signed
