"""Two-finger equilibrium grasps of the polygon, and names for all kinds. [Bunis2018, Lemma 4.3]"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary

PairKind: TypeAlias = Literal["vertex and edge", "two vertices", "parallel edges"]

_ANGLE = 1e-9
"""[1] Sine below which directions are parallel."""


@dataclass(frozen=True, slots=True)
class PairGrasp:
    """Two points (2, 2) of the boundary that squeeze it, and what they touch."""

    kind: PairKind
    contacts: FloatArray

    @property
    def width(self) -> float:
        """Distance of the contacts, [unit]."""
        return float(np.hypot(*(self.contacts[1] - self.contacts[0])))


def pair_grasps(boundary: Boundary) -> list[PairGrasp]:
    """All squeezing two-finger equilibrium grasps, by kind, then by width. [Bunis2018, Lemma 4.3]

    Forces are equal and opposite along the line of the contacts: normal to an edge, within the
    normals of a vertex. Parallel edges give a family; its middle stands for it.
    """
    found = [*_vertex_edge(boundary), *_vertex_vertex(boundary), *_edge_edge(boundary)]
    order = ("vertex and edge", "two vertices", "parallel edges")
    return sorted(found, key=lambda g: (order.index(g.kind), g.width))


def _inward(boundary: Boundary) -> FloatArray:
    return np.column_stack([-boundary.tangent[:, 1], boundary.tangent[:, 0]])


def _pushes(boundary: Boundary, vertex: int, force: FloatArray) -> bool:
    """Whether a force (2,) is a sum of both inward normals at a vertex, strictly."""
    n = _inward(boundary)
    a, b = n[vertex - 1], n[vertex]
    det = a[0] * b[1] - a[1] * b[0]
    if abs(det) < _ANGLE:
        return False
    x = (force[0] * b[1] - force[1] * b[0]) / det
    y = (a[0] * force[1] - a[1] * force[0]) / det
    return bool(x > _ANGLE and y > _ANGLE)


def _vertex_edge(boundary: Boundary) -> list[PairGrasp]:
    inward = _inward(boundary)
    found: list[PairGrasp] = []
    n = len(boundary)
    for edge in range(n):
        along = (boundary.start - boundary.start[edge]) @ boundary.tangent[edge]
        height = (boundary.start - boundary.start[edge]) @ inward[edge]
        inside = (along > 0.0) & (along < boundary.length[edge]) & (height > 0.0)
        for vertex in np.flatnonzero(inside).tolist():
            if vertex not in (edge, (edge + 1) % n) and _pushes(boundary, vertex, -inward[edge]):
                foot = boundary.start[edge] + along[vertex] * boundary.tangent[edge]
                pair = np.array([foot, boundary.start[vertex]])
                found.append(PairGrasp("vertex and edge", pair))
    return found


def _vertex_vertex(boundary: Boundary) -> list[PairGrasp]:
    found: list[PairGrasp] = []
    for a in range(len(boundary)):
        for b in range(a):
            way = boundary.start[a] - boundary.start[b]
            if _pushes(boundary, b, way) and _pushes(boundary, a, -way):
                found.append(PairGrasp("two vertices", boundary.start[[b, a]]))
    return found


def _edge_edge(boundary: Boundary) -> list[PairGrasp]:
    inward = _inward(boundary)
    found: list[PairGrasp] = []
    for a in range(len(boundary)):
        t = boundary.tangent[a]
        for b in range(a):
            if abs(t @ inward[b]) > _ANGLE or inward[a] @ inward[b] > 0.0:
                continue
            height = float((boundary.start[b] - boundary.start[a]) @ inward[a])
            far = float((boundary.start[b] - boundary.start[a]) @ t)
            low, high = max(0.0, far - boundary.length[b]), min(boundary.length[a], far)
            if height > 0.0 and low < high:
                foot = boundary.start[a] + 0.5 * (low + high) * t
                found.append(
                    PairGrasp("parallel edges", np.array([foot, foot + height * inward[a]]))
                )
    return found


def three_finger_kind(boundary: Boundary, contacts: FloatArray, near: float) -> str | None:
    """What three contacts (3, 2) touch, within ``near`` [unit]: "three edges", "one vertex", ...

    None if a finger is free.
    """
    corners = 0
    for point in contacts:
        edge, s, gap = boundary.nearest(point)
        if gap > near:
            return None
        along = s - boundary.s_0[edge]
        corners += min(along, boundary.length[edge] - along) <= near
    return ("three edges", "one vertex", "two vertices", "three vertices")[corners]
