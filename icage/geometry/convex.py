"""Convex pieces of a triangulated region, vertex to vertex, with exact orientation signs.

Serves the exterior of the object (the planner's pieces) and its interior (the simulator's collision
geometry) alike. The signs are exact, so that slivers of finely split arcs are never judged by a
tolerance: a float filter first [Shewchuk1997, ccwerrboundA], rational arithmetic where it fails.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray, IntArray
from icage.errors import GeometryError
from icage.geometry.kernels.merging import FILTER, merge_rings

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
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    keys, wanted = vertices @ [1.0, 1.0j], corners @ [1.0, 1.0j]
    order = np.argsort(keys, kind="stable")
    place = np.searchsorted(keys[order], wanted).clip(max=len(keys) - 1)
    triangles = order[place]
    if (keys[triangles] != wanted).any():
        raise GeometryError("the triangulation moved or invented a vertex")
    if len(triangles) != len(vertices) + 2 * len(polygon.interiors) - 2:
        raise GeometryError(
            f"{len(triangles)} triangles for {len(vertices)} vertices and "
            f"{len(polygon.interiors)} holes"
        )
    return vertices, _counterclockwise(vertices, triangles)


def _counterclockwise(vertices: FloatArray, triangles: IntArray) -> IntArray:
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    det = left - right
    sign = np.sign(det)
    for t in np.flatnonzero(np.abs(det) <= FILTER * (np.abs(left) + np.abs(right))):
        p, q, r = vertices[triangles[t]].tolist()
        sign[t] = orientation((p[0], p[1]), (q[0], q[1]), (r[0], r[1]))
        if sign[t] == 0.0:
            i, j, k = triangles[t]
            raise GeometryError(f"the triangle on vertices {i}, {j}, {k} has no area")
    return np.where((sign > 0.0)[:, None], triangles, triangles[:, [0, 2, 1]])


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
    corners = np.ascontiguousarray(triangles, dtype=np.int64)
    places = np.asarray(vertices, dtype=np.float64)
    origin = corners.ravel()
    twin = twins(origin, corners[:, [1, 2, 0]].ravel(), len(places))
    order = _longest_first(places, origin, twin)
    x, y = np.ascontiguousarray(places[:, 0]), np.ascontiguousarray(places[:, 1])
    merged, ends, certain = merge_rings(x, y, origin, twin, order, max_edges)
    if certain:
        numbers, last = merged.tolist(), ends.tolist()
        return sorted(numbers[a:b] for a, b in zip([0, *last[:-1]], last, strict=True))
    points: list[Point] = [(x, y) for x, y in places.tolist()]
    mesh = _HalfEdges(origin, twin)
    for edge in order.tolist():
        mesh.remove_if_convex(edge, points, max_edges)
    return mesh.rings()


def twins(start: IntArray, end: IntArray, vertices: int) -> IntArray:
    """The half edge that runs the other way, -1 where there is none."""
    key, back = start * vertices + end, end * vertices + start
    order = np.argsort(key)
    ordered = key[order]
    if bool((ordered[1:] == ordered[:-1]).any()):
        raise GeometryError("two triangles use one edge in the same direction")
    place = np.searchsorted(ordered, back).clip(max=len(key) - 1)
    return np.where(ordered[place] == back, order[place], -1).astype(np.int64)


def _longest_first(vertices: FloatArray, origin: IntArray, twin: IntArray) -> IntArray:
    """Every diagonal once, by its half edge of smaller number."""
    edges = np.flatnonzero(np.arange(len(twin)) < twin)
    side = vertices[origin[edges]] - vertices[origin[twin[edges]]]
    return edges[np.argsort(-(side[:, 0] ** 2) - side[:, 1] ** 2, kind="stable")]


def _stays_convex(before: Point, corner: Point, after: Point) -> bool:
    """Whether the corner turns left or goes straight on (and not straight back)."""
    sign = orientation(before, corner, after)
    if sign != 0:
        return sign > 0
    axis = 0 if before[0] != corner[0] else 1
    return (before[axis] < corner[axis]) == (corner[axis] < after[axis])


class _HalfEdges:
    """Half edges of a triangulation, merged in exact arithmetic: ``merge_rings`` once more."""

    def __init__(self, origin: IntArray, twin: IntArray) -> None:
        count = len(origin)
        self.origin: list[int] = origin.tolist()
        self.next: list[int] = [e + 1 if e % 3 < 2 else e - 2 for e in range(count)]
        self.prev: list[int] = [e - 1 if e % 3 > 0 else e + 2 for e in range(count)]
        self.twin: list[int] = twin.tolist()
        self._alive = [True] * count
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
            self._alive[here] = False
        self._parent[other] = mine
        self._edges[mine] = edges

    def rings(self) -> list[list[int]]:
        seen = [not alive for alive in self._alive]
        rings: list[list[int]] = []
        for start, done in enumerate(seen):
            if done:
                continue
            ring: list[int] = []
            edge = start
            while not seen[edge]:
                seen[edge] = True
                ring.append(self.origin[edge])
                edge = self.next[edge]
            first = ring.index(min(ring))
            rings.append(ring[first:] + ring[:first])
        return sorted(rings)
