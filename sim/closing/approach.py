"""Free travel in closed form: while no finger touches, only the hand moves, on straight lines.

A closing spends a third to a half of its time before the first touch, where nothing can be learned
from an engine: the object rests and finger k stands at p_k(sigma) = sigma L_k u_k. So the hand is
put ``LEAD`` before the first touch and the engine takes over there, from rest; it is at full speed
after a step or two.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from sim.world.machine_loops import borrowing
from sim.world.scene import Scene

LEAD: Final = 2e-3
"""[diameter] Travel left to the fastest finger: five steps or more, the speed settles in two."""


def approached(scene: Scene, qpos: FloatArray) -> FloatArray:
    """Positions (N, 6) with the hand closed to ``LEAD`` before its first touch; never opened."""
    kinematics = scene.kinematics
    sigma = scene.sigma(qpos)
    reach = first_touch(scene, qpos) + LEAD / float(kinematics.lengths.max())
    nearer = np.array(qpos)
    skip = reach < sigma
    nearer[skip, :3] = np.minimum(reach, sigma)[skip, None] * kinematics.lengths
    return nearer


def first_touch(scene: Scene, qpos: FloatArray) -> FloatArray:
    """[diameter] sigma (N,) at which a disc first touches the outline; 0: the hand shuts freely.

    The start must be clear of the object; rows that are not get their own sigma back.
    """
    vertices = scene.object.vertices
    radius = scene.finger_radius / scene.object.diameter
    following = np.roll(vertices, -1, axis=0)
    length = np.hypot(following[:, 0] - vertices[:, 0], following[:, 1] - vertices[:, 1])
    along = (following - vertices) / length[:, None]
    sigma = scene.sigma(qpos)
    cos, sin = np.cos(qpos[:, 5]), np.sin(qpos[:, 5])
    end_x, end_y = _turned_back(cos, sin, -qpos[:, 3], -qpos[:, 4])
    soonest = np.ones(len(qpos))
    for k in range(3):
        x, y = (scene.kinematics.directions[k] * scene.kinematics.lengths[k]).tolist()
        way_x, way_y = _turned_back(cos, sin, -sigma * x, -sigma * y)
        begin_x, begin_y = end_x - way_x, end_y - way_y
        _hits(vertices, along, length, radius, begin_x, begin_y, way_x, way_y, soonest)
    return sigma * (1.0 - soonest)


def _turned_back(
    cos: FloatArray, sin: FloatArray, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Vectors of P in the object's axes."""
    return cos * x + sin * y, cos * y - sin * x


@borrowing
def _hits(
    vertices: FloatArray,
    along: FloatArray,
    length: FloatArray,
    radius: float,
    begin_x: FloatArray,
    begin_y: FloatArray,
    way_x: FloatArray,
    way_y: FloatArray,
    soonest: FloatArray,
) -> None:  # pragma: no cover - compiled
    """Lower ``soonest`` (N,) to the share in [0, 1] of each way at which a disc meets the outline.

    It meets an edge from outside, or a vertex.
    """
    for n in range(len(soonest)):
        wx, wy = way_x[n], way_y[n]
        a = wx * wx + wy * wy
        for i in range(len(length)):
            off_x, off_y = begin_x[n] - vertices[i, 0], begin_y[n] - vertices[i, 1]
            ex, ey = along[i, 0], along[i, 1]
            height = off_x * ey - off_y * ex  # outward: right of a counterclockwise edge
            sinking = -(wx * ey - wy * ex)
            if sinking > 0.0 and height > 0.0:
                u = (height - radius) / sinking
                if -1.0 < u <= 1.0 and u < soonest[n]:
                    foot = off_x * ex + off_y * ey
                    foot = foot + u * (wx * ex + wy * ey)
                    if 0.0 <= foot <= length[i]:
                        soonest[n] = max(u, 0.0)
            b = -(off_x * wx + off_y * wy)  # positive: coming nearer
            if b > 0.0:
                c = off_x * off_x + off_y * off_y - radius * radius
                square = b * b - a * c
                if square >= 0.0:
                    soonest[n] = min(soonest[n], max(c / (b + math.sqrt(square)), 0.0))
