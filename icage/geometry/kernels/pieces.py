"""Convex pieces as flat arrays: vertices of the library's triangles, and slots of the pieces."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.geometry.kernels.merging import sign_of_turn
from icage.kernels.compiled import compiled, compiled_borrowing

_FIRST_MIX = np.uint64(0x9E3779B97F4A7C15)
_SECOND_MIX = np.uint64(0xC2B2AE3D27D4EB4F)
_HALF = np.uint64(29)

WALL = -1
"""Neighbour of a slot that is an edge of the object."""

BOX = -2
"""Neighbour of a slot that is an edge of the box."""

BOX_CORNERS = 4
"""The first vertices are those of the box."""


class Numbered(NamedTuple):
    """Triangles as indices of vertices.

    Attributes
    ----------
    origin:
        (3 m,) counterclockwise, three by three.
    unsure:
        Triangles whose orientation a float cannot tell: as they were given.
    known:
        Whether every corner is a vertex; else nothing of this holds.
    """

    origin: np.ndarray
    unsure: np.ndarray
    known: bool


class Slots(NamedTuple):
    """Edges of all pieces, piece by piece; of ``icage.geometry.exterior.Pieces``."""

    vertex: np.ndarray
    neighbour: np.ndarray
    normal_x: np.ndarray
    normal_y: np.ndarray
    wall_from: np.ndarray
    wall_to: np.ndarray


@compiled
def _mixed(x, y):
    """A number (n,) of each point, spread over all bits."""
    zero = 0.0  # -0.0 becomes 0.0
    mixed = (x + zero).view(np.uint64) * _FIRST_MIX
    mixed ^= mixed >> _HALF
    mixed += (y + zero).view(np.uint64)
    mixed *= _SECOND_MIX
    return mixed >> _HALF


@compiled_borrowing
def _place(table, x, y, point_x, point_y, mixed):
    """Index in the table of the vertex at a point, or of the free place where it belongs."""
    mask = len(table) - 1
    at = np.int64(mixed) & mask
    while table[at] >= 0 and not (x[table[at]] == point_x and y[table[at]] == point_y):
        at = (at + 1) & mask
    return at


@compiled
def numbered(x, y, rings):
    """Triangles, closed rings of four points each (4 m, 2), as indices of vertices: ``Numbered``.

    Of several vertices at one point the first is meant.
    """
    size = 4
    while size < 2 * len(x):
        size *= 2
    table = np.full(size, -1, np.int64)
    mixed = _mixed(x, y)
    for v in range(len(x)):
        at = _place(table, x, y, x[v], y[v], mixed[v])
        if table[at] < 0:
            table[at] = v
    count = len(rings) // 4
    origin = np.empty(3 * count, np.int64)
    unsure = np.empty(count, np.int64)
    n = 0
    corner_x, corner_y = np.empty(3 * count), np.empty(3 * count)
    for e in range(3 * count):
        corner_x[e] = rings[e + e // 3, 0]
        corner_y[e] = rings[e + e // 3, 1]
    mixed = _mixed(corner_x, corner_y)
    known = True
    for e in range(3 * count):
        origin[e] = table[_place(table, x, y, corner_x[e], corner_y[e], mixed[e])]
        if origin[e] < 0:
            known = False
    for t in range(count if known else 0):
        sign = sign_of_turn(x, y, origin[3 * t], origin[3 * t + 1], origin[3 * t + 2])
        if sign == -1:
            origin[3 * t + 1], origin[3 * t + 2] = origin[3 * t + 2], origin[3 * t + 1]
        elif sign != 1:
            unsure[n] = t
            n += 1
    return Numbered(origin, unsure[:n], known)


@compiled
def slots_of(x, y, origin, twin, edges, ptr):
    """The ``Slots`` of pieces whose half edges, ring by ring, are ``edges``."""
    count = len(edges)
    owner = np.empty(len(origin), np.int64)
    for piece in range(len(ptr) - 1):
        for s in range(ptr[piece], ptr[piece + 1]):
            owner[edges[s]] = piece
    vertex = np.empty(count, np.int64)
    neighbour = np.empty(count, np.int64)
    normal_x, normal_y = np.empty(count), np.empty(count)
    wall_from, wall_to = np.empty(count, np.int64), np.empty(count, np.int64)
    walls = 0
    for piece in range(len(ptr) - 1):
        for s in range(ptr[piece], ptr[piece + 1]):
            following = s + 1 if s + 1 < ptr[piece + 1] else ptr[piece]
            a, b = origin[edges[s]], origin[edges[following]]
            side_x, side_y = x[b] - x[a], y[b] - y[a]
            length = np.hypot(side_x, side_y)
            vertex[s] = a
            normal_x[s], normal_y[s] = -side_y / length, side_x / length
            other = twin[edges[s]]
            if other >= 0:
                neighbour[s] = owner[other]
            elif a < BOX_CORNERS and b < BOX_CORNERS:
                neighbour[s] = BOX
            else:
                neighbour[s] = WALL
                wall_from[walls], wall_to[walls] = a, b
                walls += 1
    return Slots(vertex, neighbour, normal_x, normal_y, wall_from[:walls], wall_to[:walls])
