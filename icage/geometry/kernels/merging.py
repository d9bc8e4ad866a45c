"""Joining triangles across their diagonals while the pieces stay convex, in doubles with a filter.

Half edge 3 t + k starts at corner k of triangle t. Where a float cannot tell the sign of an
orientation the kernel says so, and the caller does it again in exact arithmetic.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import stable_order
from icage.kernels.union_find import root_of

FILTER = (3.0 + 16.0 * 2.0**-53) * 2.0**-53
"""[1] Relative error bound of the float orientation determinant. [Shewchuk1997, ccwerrboundA]"""

UNSURE = 2
"""In place of a sign that a float cannot tell."""

GONE = -1
"""What follows a half edge that has been removed."""


class Mesh(NamedTuple):
    """Half edges, as a triangulation has them.

    Attributes
    ----------
    twin:
        The half edge that runs the other way, -1 where there is none.
    ranked:
        All half edges by the vertex where they start, then by the one where they end.
    diagonals:
        Those that two triangles share, longest first, each by its half edge of smaller number.
    simple:
        Whether no two half edges run from one vertex to the same other one; else no diagonals.
    """

    twin: np.ndarray
    ranked: np.ndarray
    diagonals: np.ndarray
    simple: bool


@compiled_borrowing
def sign_of_turn(x, y, a, b, c):
    """Sign of the area of three vertices, or ``UNSURE``."""
    left = (x[a] - x[c]) * (y[b] - y[c])
    right = (y[a] - y[c]) * (x[b] - x[c])
    det = left - right
    if abs(det) > FILTER * (abs(left) + abs(right)):
        return 1 if det > 0.0 else -1
    # a factor that is 0 is so exactly: edges along an axis need no exact arithmetic
    if (x[a] == x[c] or y[b] == y[c]) and (y[a] == y[c] or x[b] == x[c]):
        return 0
    return UNSURE


@compiled_borrowing
def _corner(x, y, before, at, after):
    """1 if the corner turns left or goes straight on, 0 if not, or ``UNSURE``."""
    sign = sign_of_turn(x, y, before, at, after)
    if sign == UNSURE:
        return UNSURE
    if sign != 0:
        return 1 if sign > 0 else 0
    if x[before] != x[at]:
        return 1 if (x[before] < x[at]) == (x[at] < x[after]) else 0
    return 1 if (y[before] < y[at]) == (y[at] < y[after]) else 0


@compiled_borrowing
def next_of(edge):
    """The half edge that follows in the same triangle."""
    return edge + 1 if edge % 3 < 2 else edge - 2


@compiled
def _sorted_by(key, items, keys):
    """Items (half edges) by their keys, from 0 to below ``keys``; equal ones stay as they are."""
    begin = np.zeros(keys + 1, np.int64)
    for e in items:
        begin[key[e] + 1] += 1
    for k in range(keys):
        begin[k + 1] += begin[k]
    found = np.empty(len(items), np.int64)
    for e in items:
        found[begin[key[e]]] = e
        begin[key[e]] += 1
    return found


@compiled
def half_edges(x, y, origin, fixed):
    """The ``Mesh`` of triangles whose corners are ``origin``, three by three.

    No half edge from ``fixed`` on is a diagonal's.
    """
    count = len(origin)
    total = len(x)
    end = np.empty(count, np.int64)
    for e in range(count):
        end[e] = origin[next_of(e)]
    numbers = np.arange(count)
    forth = _sorted_by(origin, _sorted_by(end, numbers, total), total)
    back = _sorted_by(end, _sorted_by(origin, numbers, total), total)
    twin = np.full(count, -1, np.int64)
    simple = True
    for k in range(1, count):
        e, other = forth[k - 1], forth[k]
        if origin[e] == origin[other] and end[e] == end[other]:
            simple = False
    at = 0
    for e in forth:
        # of all the edges that end where this one starts, those in front start too early
        while at < count and (
            end[back[at]] < origin[e] or (end[back[at]] == origin[e] and origin[back[at]] < end[e])
        ):
            at += 1
        if at < count and end[back[at]] == origin[e] and origin[back[at]] == end[e]:
            twin[e] = back[at]
    shared = np.empty(count, np.int64)
    length = np.empty(count)
    n = 0
    for e in range(fixed if simple else 0):
        if e < twin[e] < fixed:
            side_x = x[origin[e]] - x[end[e]]
            side_y = y[origin[e]] - y[end[e]]
            shared[n] = e
            length[n] = -(side_x * side_x) - side_y * side_y
            n += 1
    order = stable_order(length[:n])
    diagonals = np.empty(n, np.int64)
    for k in range(n):
        diagonals[k] = shared[order[k]]
    return Mesh(twin, forth, diagonals, simple)


@compiled
def join_triangles(x, y, origin, mesh, max_edges):
    """What follows each half edge once no diagonal is left that can go; whether all was certain."""
    count = len(origin)
    after = np.empty(count, np.int64)
    before = np.empty(count, np.int64)
    for e in range(count):
        after[e] = next_of(e)
        before[after[e]] = e
    parent = np.arange(count // 3)
    edges = np.full(count // 3, 3)
    for edge in mesh.diagonals:
        other = mesh.twin[edge]
        mine, yours = root_of(parent, edge // 3), root_of(parent, other // 3)
        total = edges[mine] + edges[yours] - 2
        if mine == yours or total > max_edges:
            continue
        convex = 1
        here, there = edge, other
        for _ in range(2):
            turn = _corner(x, y, origin[before[here]], origin[here], origin[after[after[there]]])
            if turn == UNSURE:
                return after, False
            if turn == 0:
                convex = 0
                break
            here, there = there, here
        if convex == 0:
            continue
        for _ in range(2):
            into, out = before[here], after[there]
            after[into], before[out] = out, into
            here, there = there, here
        after[edge], after[other] = GONE, GONE
        parent[yours] = mine
        edges[mine] = total
    return after, True


@compiled
def ring_by_ring(after, ranked, fixed):
    """Half edges of all pieces, ring by ring, and where rings begin (one more: the end).

    Each ring from its smallest vertex, rings in ascending order; from ``fixed`` on as they are.
    """
    count = len(after)
    edges = np.empty(count, np.int64)
    ptr = np.empty(count // 3 + 1, np.int64)
    done = np.zeros(count, np.bool_)
    n = 0
    rings = 0
    # the first half edge met of a ring is the one at its smallest vertex
    for first in ranked:
        if first >= fixed or done[first] or after[first] == GONE:
            continue
        ptr[rings] = n
        rings += 1
        edge = first
        while not done[edge]:
            done[edge] = True
            edges[n] = edge
            n += 1
            edge = after[edge]
    for edge in range(fixed, count):
        if edge % 3 == 0:
            ptr[rings] = n
            rings += 1
        edges[n] = edge
        n += 1
    ptr[rings] = n
    return edges[:n], ptr[: rings + 1]
