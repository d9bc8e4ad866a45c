"""The sectors that show where three contact normals can meet. [Bunis2018, Sec. VII-A]

Edge: the half strip on its inner side. Vertex: the cone of its normals. A point in three
such sectors, projected onto the three edges or vertices, gives the contacts of a grasp that can
balance. Sufficient, not necessary: a point behind an edge serves too, since only the lines of force
must meet there, and neither test tells squeezing from stretching.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary

_CORNER = 1e-6
"""[perimeter] A contact this close to a vertex or an edge is on it."""

_HAIR, _FAR = 1e-9, 1e3
"""[hand's size] How much wider a cone is taken, how long a line."""


_PARALLEL = 1e-9
"""[1] Normals whose directions span no more than this are one line's."""


@dataclass(frozen=True, slots=True)
class Sector:
    """A sector of one contact, cut off at some distance.

    ``normals`` (1 or 2, 2) bound it; ``forward`` is it, ``backward`` its mirror image outside.
    A point finger on a ``convex`` vertex can be part of a puncture, never of a grasp that holds.
    """

    contact: FloatArray
    vertex: bool
    convex: bool
    normals: FloatArray
    forward: shapely.Polygon
    backward: shapely.Polygon


def sector_at(boundary: Boundary, contact: FloatArray, reach: float) -> Sector | None:
    """The sector of the edge or vertex at a contact (2,), ``reach`` [unit] long; None off both."""
    edge, s, gap = boundary.nearest(contact)
    near = _CORNER * boundary.perimeter
    if gap > near:
        return None
    n = len(boundary)
    inward = np.column_stack([-boundary.tangent[:, 1], boundary.tangent[:, 0]])
    along = s - boundary.s_0[edge]
    if min(along, boundary.length[edge] - along) > near:
        a = boundary.start[edge]
        b = a + boundary.length[edge] * boundary.tangent[edge]
        strip = [
            shapely.Polygon([a, b, b + h, a + h])
            for h in (reach * inward[edge], -reach * inward[edge])
        ]
        return Sector(contact, False, False, inward[[edge]], strip[0], strip[1])
    ahead = edge if along <= near else (edge + 1) % n
    before, after = inward[ahead - 1], inward[ahead]
    convex = bool(before[0] * after[1] - before[1] * after[0] >= 0.0)
    apex = boundary.start[ahead]
    middle = before + after
    fan = reach * np.array([after, middle / np.hypot(*middle), before])
    cones = [shapely.Polygon([apex, *(apex + h * fan)]) for h in (1.0, -1.0)]
    return Sector(apex, True, convex, np.array([after, before]), cones[0], cones[1])


def concurrency_point(sectors: list[Sector]) -> FloatArray | None:
    """A point (2,) on the lines of force of three contacts.

    An edge's line is fixed; a vertex leaves its line free within the cone. With two edges the
    point is where their lines cross; with one edge it is the middle of that line's part in the
    cones; with three vertices the middle of what the cones share. None if there is none.
    """
    lines = [s for s in sectors if not s.vertex]
    if len(lines) >= 2:
        n = np.array([s.normals[0] for s in lines])
        across = np.column_stack([-n[:, 1], n[:, 0]])
        rows = np.array([c @ s.contact for c, s in zip(across, lines, strict=True)])
        if np.linalg.matrix_rank(across, tol=_PARALLEL) < 2:
            return None
        return np.linalg.lstsq(across, rows, rcond=None)[0]
    vertices = [s for s in sectors if s.vertex]
    both = [shapely.union(s.forward, s.backward) for s in vertices]
    common = _shared([s.forward for s in sectors], lines, sectors)
    for cones in ([s.forward for s in vertices], both):
        if common.is_empty:
            common = _shared(cones, lines, sectors)
    if common.is_empty:
        return None
    part = max(shapely.get_parts(common), key=lambda g: g.length)
    inside = part.interpolate(0.5, normalized=True) if lines else part.representative_point()
    return np.array([inside.x, inside.y])


def common_area(sectors: list[Sector]) -> BaseGeometry:
    """Intersection of the forward sectors; empty where the paper's construction finds nothing."""
    shared: BaseGeometry = sectors[0].forward
    for sector in sectors[1:]:
        shared = shared.intersection(sector.forward)
    return shared


def _shared(
    cones: Sequence[BaseGeometry], lines: list[Sector], sectors: list[Sector]
) -> BaseGeometry:
    """What cones of vertices share, on the line of force of an edge if there is one.

    A hair wider than they are: the line may run along the rim of a cone.
    """
    size = _size(sectors)
    shared: BaseGeometry = cones[0].buffer(_HAIR * size)
    for cone in cones[1:]:
        shared = shared.intersection(cone.buffer(_HAIR * size))
    if lines:
        far = _FAR * size * lines[0].normals[0]
        line = shapely.LineString([lines[0].contact - far, lines[0].contact + far])
        shared = line.intersection(shared)
    return shared


def _size(sectors: list[Sector]) -> float:
    points = np.array([s.contact for s in sectors])
    return float(np.hypot(*np.ptp(points, axis=0)))
