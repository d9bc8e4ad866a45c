"""Convex regions of a rectangle: where the third finger is in one piece of the plane. [V-A]"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary
from icage.contact_space.exploration import Plane
from icage.contact_space.third_finger import Parallelogram


def exterior_rings(plane: Plane) -> list[FloatArray]:
    """The convex pieces (k, 2) of the plane round the object, counterclockwise, by number."""
    space = plane.space
    bounds = zip(space.ptr[:-1], space.ptr[1:], strict=True)
    x, y = space.slot_x + plane.origin[0], space.slot_y + plane.origin[1]
    return [_ring(x[a:b], y[a:b]) for a, b in bounds]


def regions_of_rectangle(
    plane: Plane, boundary: Boundary, pair: int, j: int, k: int
) -> list[tuple[int, FloatArray]]:
    """Piece and corners (m, 2) in (s_i, s_{i+1}) of every region with an area.

    [Bunis2018, Sec. V-A]. The pieces of the plane, pulled back by Eq. (4): what no obstacle
    covers, cut into convex parts.
    """
    finger = Parallelogram.over(boundary, plane.hand, pair, j, k)
    low, high = finger.corners.min(axis=0), finger.corners.max(axis=0)
    found: list[tuple[int, FloatArray]] = []
    for c, ring in enumerate(exterior_rings(plane)):
        if (ring.max(axis=0) < low).any() or (ring.min(axis=0) > high).any():
            continue
        part = finger.clipped(ring)
        if len(part) >= 3:
            found.append((c, part))
    return found


def _ring(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.column_stack([x, y])
