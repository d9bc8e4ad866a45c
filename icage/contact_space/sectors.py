"""The sectors that show where three contact normals can meet. [Bunis2018, Sec. VII-A]

Edge: the half strip on its inner side. Concave vertex: the cone of its normals. A point in three
such sectors, projected onto the three edges or vertices, gives the contacts of a grasp that can
balance. Sufficient, not necessary: a point behind an edge serves too, since only the lines of force
must meet there, and neither test tells squeezing from stretching.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary

_CORNER = 1e-6
"""[diameter] A contact this close to a vertex is on it."""


@dataclass(frozen=True, slots=True)
class Sector:
    """A sector of one contact, cut off at some distance.

    ``normals`` (1 or 2, 2) bound it; ``forward`` is it, ``backward`` its mirror image outside.
    """

    contact: FloatArray
    vertex: bool
    normals: FloatArray
    forward: shapely.Polygon
    backward: shapely.Polygon


def sector_at(boundary: Boundary, contact: FloatArray, reach: float) -> Sector | None:
    """The sector of the edge or concave vertex at a contact (2,), ``reach`` [unit] long.

    None at a convex vertex: a point finger there balances nothing that holds.
    """
    edge, s, _ = boundary.nearest(contact)
    near = _CORNER * boundary.perimeter
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
        return Sector(contact, False, inward[[edge]], strip[0], strip[1])
    ahead = edge if along <= near else (edge + 1) % n
    before, after = inward[ahead - 1], inward[ahead]
    if before[0] * after[1] - before[1] * after[0] >= 0.0:
        return None
    apex = boundary.start[ahead]
    middle = before + after
    fan = reach * np.array([after, middle / np.hypot(*middle), before])
    cones = [shapely.Polygon([apex, *(apex + h * fan)]) for h in (1.0, -1.0)]
    return Sector(apex, True, np.array([after, before]), cones[0], cones[1])


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
        if np.linalg.matrix_rank(across, tol=1e-9) < 2:
            return None
        return np.linalg.lstsq(across, rows, rcond=None)[0]
    cones = [shapely.union(s.forward, s.backward) for s in sectors if s.vertex]
    common = cones[0]
    for cone in cones[1:]:
        common = shapely.intersection(common, cone)
    if lines:
        ends = [lines[0].contact + h * 1e3 * _size(sectors) * lines[0].normals[0] for h in (-1, 1)]
        common = shapely.intersection(shapely.LineString(ends), common)
    if common.is_empty:
        return None
    part = max(shapely.get_parts(common), key=lambda g: g.length)
    inside = part.interpolate(0.5, normalized=True) if lines else part.representative_point()
    return np.array([inside.x, inside.y])


def common_area(sectors: list[Sector]) -> shapely.Geometry:
    """Intersection of the forward sectors; empty where the paper's construction finds nothing."""
    shared: shapely.Geometry = sectors[0].forward
    for sector in sectors[1:]:
        shared = shapely.intersection(shared, sector.forward)
    return shared


def _size(sectors: list[Sector]) -> float:
    points = np.array([s.contact for s in sectors])
    return float(np.hypot(*np.ptp(points, axis=0)))
