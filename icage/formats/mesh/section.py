"""A mesh cut by a plane across the axis: loops of the pieces of its triangles.

A corner on the plane counts as above it. So every triangle is cut in two points or not at all, the
cut of a closed mesh is closed, and a face that lies in the plane is cut just below it. A point is
computed from the same ends in the same order by both triangles at an edge, hence to the last digit.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.errors import FormatError
from icage.formats.drawings.curves import Polyline
from icage.formats.drawings.drawing import Drawing, Line, Ring, Shape

MAX_PIECES: Final = 100_000
"""Triangles cut."""


def section(triangles: FloatArray, height: float, axis: str) -> Drawing:
    """The drawing in which a plane cuts triangles (n, 3, 3), each corner (right, up, height).

    Raises
    ------
    FormatError:
        The plane misses the mesh, or cuts too many triangles.
    """
    above = triangles[:, :, 2] >= height
    cut = above.any(axis=1) & ~above.all(axis=1)
    count = int(cut.sum())
    if not count:
        low, high = triangles[:, :, 2].min(), triangles[:, :, 2].max()
        raise FormatError(
            f"section is {height:g}, but the mesh reaches from {low:g} to {high:g} along {axis}"
        )
    if count > MAX_PIECES:
        raise FormatError(
            f"the section cuts {count} triangles, at most {MAX_PIECES} are allowed; simplify it"
        )
    starts, ends = _pieces(triangles[cut], above[cut], height)
    points, numbers = np.unique(np.vstack([starts, ends]), axis=0, return_inverse=True)
    a, b = numbers.ravel()[:count], numbers.ravel()[count:]
    apart = a != b
    a, b = a[apart], b[apart]
    leaving, entering = np.bincount(a, minlength=len(points)), np.bincount(b, minlength=len(points))
    if (leaving == entering).all():
        return _closed(points, a, b, "nonzero", ())
    if ((leaving + entering) % 2 == 0).all():
        a, b = _directed(a, b)
        note = "triangles of the mesh face either way: what is solid was told by counting crossings"
        return _closed(points, a, b, "evenodd", (note,))
    odd = int(((leaving + entering) % 2 == 1).sum())
    note = f"the mesh is not closed: its section has {odd} loose ends, and encloses what it can"
    lines = tuple(
        Line((Polyline(points[[i, j]]),)) for i, j in zip(a.tolist(), b.tolist(), strict=True)
    )
    return Drawing(lines=lines, sure=False, edges=True, notes=(note,))


def _pieces(
    triangles: FloatArray, above: np.ndarray, height: float
) -> tuple[FloatArray, FloatArray]:
    """(k, 2) starts and ends; the solid is to the left if the triangles face outwards."""
    alone_above = above.sum(axis=1) == 1
    alone = np.where(alone_above, above.argmax(axis=1), (~above).argmax(axis=1))
    rows = np.arange(len(triangles))
    tip, second, third = (triangles[rows, (alone + k) % 3] for k in (0, 1, 2))  # of a triangle
    p, q = _crossing(tip, second, height), _crossing(tip, third, height)
    forward = alone_above[:, None]
    return np.where(forward, p, q), np.where(forward, q, p)


def _crossing(a: FloatArray, b: FloatArray, height: float) -> FloatArray:
    """(k, 2) points at the height between (k, 3) ends, the lower one first."""
    lower = (a[:, 2] < b[:, 2])[:, None]
    low, high = np.where(lower, a, b), np.where(lower, b, a)
    share = (height - low[:, 2]) / (high[:, 2] - low[:, 2])
    point = low[:, :2] + share[:, None] * (high[:, :2] - low[:, :2])
    # At the end itself, to the last digit: all edges that meet in a corner cross at one point.
    return np.where((share == 1.0)[:, None], high[:, :2], point)


def _closed(
    points: FloatArray, a: IntArray, b: IntArray, rule: str, notes: tuple[str, ...]
) -> Drawing:
    rings = _loops(points, a, b)
    if not rings:
        raise FormatError("the section has no area")
    assert rule in ("nonzero", "evenodd")
    return Drawing(shapes=(Shape(rings, (), rule),), sure=False, notes=notes)


def _loops(points: FloatArray, a: IntArray, b: IntArray) -> tuple[Ring, ...]:
    """Edges a -> b chained; where several leave a point, any will do: windings stay the same."""
    order = np.argsort(a, kind="stable")
    first = np.searchsorted(a[order], np.arange(len(points) + 1)).tolist()
    target = b[order].tolist()
    unused = first[:-1].copy()
    rings: list[Ring] = []
    for start in range(len(points)):
        while unused[start] < first[start + 1]:
            loop, at = [start], start
            while unused[at] < first[at + 1]:
                unused[at] += 1
                at = target[unused[at] - 1]
                loop.append(at)
            if len(loop) > 3:
                rings.append((Polyline(points[loop]),))
    return tuple(rings)


def _directed(a: IntArray, b: IntArray) -> tuple[IntArray, IntArray]:
    """The edges walked along in one direction each, whatever the direction they came in."""
    edges: dict[int, list[int]] = {}
    for k, (i, j) in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
        edges.setdefault(i, []).append(k)
        edges.setdefault(j, []).append(k)
    ends = np.column_stack([a, b]).tolist()
    used = [False] * len(ends)
    starts: list[int] = []
    stops: list[int] = []
    for start in list(edges):
        at = start
        while edges[at]:
            k = edges[at].pop()
            if used[k]:
                continue
            used[k] = True
            i, j = ends[k]
            other = j if i == at else i
            starts.append(at)
            stops.append(other)
            at = other
    return np.array(starts, dtype=np.int64), np.array(stops, dtype=np.int64)
