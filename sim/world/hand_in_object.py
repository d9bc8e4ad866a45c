"""The hand as the object sees it: finger centres in its axes, how deep each disc is, who is apart.

All in diameters, from poses and the true outline alone; nothing is asked of the engine.
"""

from __future__ import annotations

import math

import numpy as np
import shapely

from icage.arrays import FloatArray
from sim.world.machine_loops import borrowing, inlined

_NO_SIDE = 1e-12
"""[diameter] A side shorter than this (of a shut hand) has no direction."""


_FARTHER = 1.0 + 1e-9
"""[1] Of a square of a distance: farther for certain, whatever the rounding."""


@borrowing
def turn_back(
    points: FloatArray, x: float, y: float, turn: float
) -> None:  # pragma: no cover - compiled
    """Points (m, 2) of the palm's frame, in place, in the axes of an object at x, y and ``turn``.

    R(turn)^T (p - (x, y)); ``turn`` in [rad].
    """
    cos, sin = math.cos(turn), math.sin(turn)
    for k in range(points.shape[0]):
        u, v = points[k, 0] - x, points[k, 1] - y
        points[k, 0], points[k, 1] = cos * u + sin * v, cos * v - sin * u


@inlined
def fingers_turned(
    directions: FloatArray, qpos: FloatArray, cos: float, sin: float, out: FloatArray
) -> None:  # pragma: no cover - compiled
    """``fingers_seen`` of an object whose turn has this cosine and sine."""
    x, y = qpos[3], qpos[4]
    for k in range(3):
        u, v = directions[k, 0] * qpos[k] - x, directions[k, 1] * qpos[k] - y
        out[k, 0], out[k, 1] = cos * u + sin * v, cos * v - sin * u


@borrowing
def fingers_seen(
    directions: FloatArray, qpos: FloatArray, out: FloatArray
) -> None:  # pragma: no cover - compiled
    """``out`` (3, 2) = finger centres in the object's axes, from its centroid.

    ``directions`` (3, 2) of the slides, ``qpos`` (6,) = three slides, object's x, y, turn.
    """
    fingers_turned(directions, qpos, math.cos(qpos[5]), math.sin(qpos[5]), out)


@borrowing
def edge_square(
    ax: float, ay: float, bx: float, by: float, nearest: float
) -> float:  # pragma: no cover - compiled
    """Square of the distance of the origin from the edge from a to b; inf if above ``nearest``."""
    ex, ey = bx - ax, by - ay
    along = -(ax * ex + ay * ey)
    square = ex * ex + ey * ey
    if along <= 0.0:
        distance = ax * ax + ay * ay
    elif along >= square:
        distance = bx * bx + by * by
    else:
        cross = ax * ey - ay * ex
        distance = cross * cross
        # most edges are farther than one met before: that needs no division
        distance = math.inf if distance > _FARTHER * nearest * square else distance / square
    return distance


@borrowing
def depth_at(
    vertices: FloatArray, x: float, y: float, radius: float
) -> float:  # pragma: no cover - compiled
    """How deep a disc with its centre at x, y reaches into the polygon; negative: its distance.

    ``vertices`` (n, 2), one unit. Depth = radius - signed distance of the centre from the outline,
    positive outside.
    """
    count = vertices.shape[0]
    nearest = math.inf
    inside = False
    ax, ay = vertices[count - 1, 0] - x, vertices[count - 1, 1] - y
    for j in range(count):
        bx, by = vertices[j, 0] - x, vertices[j, 1] - y
        nearest = min(nearest, edge_square(ax, ay, bx, by, nearest))
        if (ay > 0.0) != (by > 0.0) and ((ax * by - ay * bx > 0.0) == (by > ay)):
            inside = not inside
        ax, ay = bx, by
    signed = math.sqrt(nearest)
    return radius + signed if inside else radius - signed


@borrowing
def depths(
    vertices: FloatArray, fingers: FloatArray, radius: float, out: FloatArray
) -> None:  # pragma: no cover - compiled
    """out[k] = ``depth_at`` of disc k, whose centre is fingers[k] (m, 2)."""
    for k in range(fingers.shape[0]):
        out[k] = depth_at(vertices, fingers[k, 0], fingers[k, 1], radius)


def hull_of(vertices: FloatArray) -> FloatArray:
    """Convex hull (h, 2) of a polygon (n, 2), counterclockwise."""
    hull = shapely.MultiPoint(vertices).convex_hull
    return np.array(shapely.get_coordinates(hull.normalize())[:-1][::-1])


@borrowing
def separated(
    hull: FloatArray, fingers: FloatArray, radius: float
) -> bool:  # pragma: no cover - compiled
    """Whether a line parallel to a side of either has the hull (h, 2) and all discs apart.

    Sides of the hull and of the triangle of fingers (3, 2); sufficient, not necessary, for discs.
    """
    count = hull.shape[0]
    for j in range(count + 3):
        if j < count:
            a, b = hull[j], hull[(j + 1) % count]
        else:
            a, b = fingers[j - count], fingers[(j - count + 1) % 3]
        nx, ny = b[1] - a[1], a[0] - b[0]
        length = math.hypot(nx, ny)
        if length < _NO_SIDE:
            continue
        nx, ny = nx / length, ny / length
        low_h, high_h = math.inf, -math.inf
        for i in range(count):
            along = nx * hull[i, 0] + ny * hull[i, 1]
            low_h, high_h = min(low_h, along), max(high_h, along)
        low_f, high_f = math.inf, -math.inf
        for k in range(3):
            along = nx * fingers[k, 0] + ny * fingers[k, 1]
            low_f, high_f = min(low_f, along), max(high_f, along)
        if low_f - radius > high_h or low_h > high_f + radius:
            return True
    return False
