"""Convex pieces of a triangulated region, vertex to vertex, with exact orientation signs.

Serves the exterior of the object (the planner's pieces) and its interior (the simulator's collision
geometry) alike. The signs are exact, so that slivers of finely split arcs are never judged by a
tolerance: a float filter first [Shewchuk1997, ccwerrboundA], rational arithmetic where it fails.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.errors import GeometryError
from icage.geometry.kernels.merging import (
    FILTER,
    GONE,
    Mesh,
    half_edges,
    join_triangles,
    ring_by_ring,
)
from icage.geometry.kernels.pieces import numbered

MAX_EDGES: Final = 10
"""Cap on edges per piece: larger ones are fewer, but cost more each. [docs/theory.md, Sec. 3.1]"""

Point = tuple[float, float]


def orientation(a: Point, b: Point, c: Point) -> int:
    """Exact sign of the area of the triangle a, b, c: +1 counterclockwise, 0 collinear, -1.

    Examples
    --------
    >>> orientation((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    1
    >>> orientation((0.1, 0.1), (0.3, 0.3), (0.7, 0.7))
    0
    """
    left = (a[0] - c[0]) * (b[1] - c[1])
    right = (a[1] - c[1]) * (b[0] - c[0])
    det = left - right
    if abs(det) > FILTER * (abs(left) + abs(right)):
        return 1 if det > 0.0 else -1
    ax, ay, bx, by, cx, cy = (Fraction(v) for v in (*a, *b, *c))
    exact = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return (exact > 0) - (exact < 0)


def triangulate(polygon: shapely.Polygon) -> tuple[FloatArray, IntArray]:
    """Constrained Delaunay triangles of a polygon (holes allowed), without new vertices.

    Returns
    -------
    vertices:
        (n, 2), the exterior ring, then the holes, bit for bit.
    triangles:
        (n + 2 holes - 2, 3) indices into ``vertices``, counterclockwise.
    """
    rings = [polygon.exterior, *polygon.interiors]
    vertices = np.concatenate([shapely.get_coordinates(ring)[:-1] for ring in rings])
    return vertices, triangles_on(vertices, polygon)


def triangles_on(vertices: FloatArray, polygon: shapely.Polygon) -> IntArray:
    """The triangles of ``triangulate``, for a polygon whose vertices (n, 2) are known."""
    corners = shapely.get_coordinates(shapely.constrained_delaunay_triangles(polygon))
    x, y = columns(vertices)
    origin, unsure, known = numbered(x, y, corners)
    if not known:
        raise GeometryError("the triangulation moved or invented a vertex")
    triangles = origin.reshape(-1, 3)
    holes = shapely.get_num_interior_rings(polygon)
    if len(triangles) != len(vertices) + 2 * holes - 2:
        raise GeometryError(
            f"{len(triangles)} triangles for {len(vertices)} vertices and {holes} holes"
        )
    for t in unsure.tolist():
        p, q, r = vertices[triangles[t]].tolist()
        sign = orientation((p[0], p[1]), (q[0], q[1]), (r[0], r[1]))
        if sign == 0:
            i, j, k = triangles[t]
            raise GeometryError(f"the triangle on vertices {i}, {j}, {k} has no area")
        if sign < 0:
            triangles[t] = triangles[t, [0, 2, 1]]
    return triangles


class Joined(NamedTuple):
    """Convex pieces as half edges: ``origin`` of each, its ``twin``, and the pieces' own.

    ``edges`` has the half edges of the pieces ring by ring, piece k those in ptr[k]:ptr[k + 1].
    """

    origin: IntArray
    twin: IntArray
    edges: IntArray
    ptr: IntArray


def merge_convex(
    vertices: FloatArray, triangles: IntArray, max_edges: int = MAX_EDGES
) -> list[list[int]]:
    """Join triangles across shared diagonals while the pieces stay convex. [Hertel1983]

    Greedy, longest diagonal first. One pass is enough: pieces only grow and corners only open, so
    a diagonal that cannot go now can never go later. Straight corners are kept as vertices, so the
    pieces meet vertex to vertex. At most four times as many pieces as the optimum, without the cap.

    Parameters
    ----------
    vertices:
        (n, 2).
    triangles:
        (m, 3) indices, counterclockwise, meeting edge to edge.
    max_edges:
        Largest number of edges of a piece, at least 3.

    Returns
    -------
    Rings of vertex indices, counterclockwise, each from its smallest index; in ascending order.
    """
    x, y = columns(vertices)
    pieces = join_convex(x, y, triangles, len(triangles), max_edges)
    numbers, ptr = pieces.origin[pieces.edges].tolist(), pieces.ptr.tolist()
    return [numbers[a:b] for a, b in pairwise(ptr)]


def join_convex(
    x: FloatArray, y: FloatArray, triangles: IntArray, joined: int, max_edges: int = MAX_EDGES
) -> Joined:
    """The pieces of ``merge_convex`` with their neighbours; only the first triangles are joined.

    Those from ``joined`` on come last, in their order, each from its first corner.
    """
    origin = np.ascontiguousarray(triangles, dtype=np.int64).ravel()
    mesh = half_edges(x, y, origin, 3 * joined)
    if not mesh.simple:
        raise GeometryError("two triangles use one edge in the same direction")
    after, certain = join_triangles(x, y, origin, mesh, max_edges)
    if not certain:
        after = _joined_exactly(x, y, origin, mesh, max_edges)
    return Joined(origin, mesh.twin, *ring_by_ring(after, mesh.ranked, 3 * joined))


def columns(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The coordinates of points (n, 2) as two arrays (n,)."""
    x, y = np.array(np.transpose(points), dtype=np.float64, order="C")
    return x, y


def _stays_convex(before: Point, corner: Point, after: Point) -> bool:
    """Whether the corner turns left or goes straight on (and not straight back)."""
    sign = orientation(before, corner, after)
    if sign != 0:
        return sign > 0
    axis = 0 if before[0] != corner[0] else 1
    return (before[axis] < corner[axis]) == (corner[axis] < after[axis])


def _joined_exactly(
    x: FloatArray, y: FloatArray, origin: IntArray, mesh: Mesh, max_edges: int
) -> IntArray:
    """``join_triangles`` once more, in exact arithmetic."""
    points: list[Point] = list(zip(x.tolist(), y.tolist(), strict=True))
    edges = _HalfEdges(origin, mesh.twin)
    for edge in mesh.diagonals.tolist():
        edges.remove_if_convex(edge, points, max_edges)
    return np.array(edges.next, dtype=np.int64)


class _HalfEdges:
    """Half edges of a triangulation, merged in exact arithmetic."""

    def __init__(self, origin: IntArray, twin: IntArray) -> None:
        count = len(origin)
        self.origin: list[int] = origin.tolist()
        self.next: list[int] = [e + 1 if e % 3 < 2 else e - 2 for e in range(count)]
        self.prev: list[int] = [e - 1 if e % 3 > 0 else e + 2 for e in range(count)]
        self.twin: list[int] = twin.tolist()
        self._piece = [e // 3 for e in range(count)]
        self._parent = list(range(count // 3))
        self._edges = [3] * (count // 3)

    def _find(self, piece: int) -> int:
        while self._parent[piece] != piece:
            self._parent[piece] = self._parent[self._parent[piece]]
            piece = self._parent[piece]
        return piece

    def remove_if_convex(self, edge: int, points: list[Point], max_edges: int) -> None:
        twin = self.twin[edge]
        mine, other = self._find(self._piece[edge]), self._find(self._piece[twin])
        edges = self._edges[mine] + self._edges[other] - 2
        if mine == other or edges > max_edges:
            return
        for here, there in ((edge, twin), (twin, edge)):
            before = points[self.origin[self.prev[here]]]
            after = points[self.origin[self.next[self.next[there]]]]
            if not _stays_convex(before, points[self.origin[here]], after):
                return
        for here, there in ((edge, twin), (twin, edge)):
            into, out = self.prev[here], self.next[there]
            self.next[into], self.prev[out] = out, into
        self.next[edge] = self.next[twin] = GONE
        self._parent[other] = mine
        self._edges[mine] = edges
