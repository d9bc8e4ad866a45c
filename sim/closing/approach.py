"""Free travel in closed form: while no finger touches, only the hand moves, on straight lines.

A closing spends a third to a half of its time before the first touch, where nothing can be learned
from an engine: the object rests and finger k stands at p_k(sigma) = sigma L_k u_k. So the hand is
put ``LEAD`` before the first touch and the engine takes over there, from rest; it is at full speed
after a step or two.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray
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
    sigma = scene.sigma(qpos)
    cos, sin = np.cos(qpos[:, 5]), np.sin(qpos[:, 5])
    end_x, end_y = _turned_back(cos, sin, -qpos[:, 3], -qpos[:, 4])
    soonest = np.ones(len(qpos))
    for k in range(3):
        x, y = (scene.kinematics.directions[k] * scene.kinematics.lengths[k]).tolist()
        way_x, way_y = _turned_back(cos, sin, -sigma * x, -sigma * y)
        begin_x, begin_y = end_x - way_x, end_y - way_y
        hit = np.minimum(
            _edge_hits(vertices, radius, begin_x, begin_y, way_x, way_y),
            _vertex_hits(vertices, radius, begin_x, begin_y, way_x, way_y),
        )
        soonest = np.minimum(soonest, hit)
    return sigma * (1.0 - soonest)


def _turned_back(
    cos: FloatArray, sin: FloatArray, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Vectors of P in the object's axes."""
    return cos * x + sin * y, cos * y - sin * x


def _edge_hits(
    vertices: FloatArray,
    radius: float,
    begin_x: FloatArray,
    begin_y: FloatArray,
    way_x: FloatArray,
    way_y: FloatArray,
) -> FloatArray:
    """Share u in [0, 1] of the way at which a disc meets an edge from outside, else 1; (N,)."""
    following = np.roll(vertices, -1, axis=0)
    length = np.hypot(following[:, 0] - vertices[:, 0], following[:, 1] - vertices[:, 1])
    along_x = (following[:, 0] - vertices[:, 0]) / length
    along_y = (following[:, 1] - vertices[:, 1]) / length
    off_x = begin_x[:, None] - vertices[:, 0]
    off_y = begin_y[:, None] - vertices[:, 1]
    height = off_x * along_y - off_y * along_x  # outward: right of a counterclockwise edge
    sinking = -(way_x[:, None] * along_y - way_y[:, None] * along_x)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (height - radius) / sinking
    foot = off_x * along_x + off_y * along_y
    foot = foot + u * (way_x[:, None] * along_x + way_y[:, None] * along_y)
    hits = (sinking > 0.0) & (height > 0.0) & (foot >= 0.0) & (foot <= length) & (u <= 1.0)
    return np.where(hits & (u > -1.0), np.maximum(u, 0.0), 1.0).min(axis=1)


def _vertex_hits(
    vertices: FloatArray,
    radius: float,
    begin_x: FloatArray,
    begin_y: FloatArray,
    way_x: FloatArray,
    way_y: FloatArray,
) -> FloatArray:
    """Share u in [0, 1] of the way at which a disc meets a vertex, else 1; (N,)."""
    off_x = begin_x[:, None] - vertices[:, 0]
    off_y = begin_y[:, None] - vertices[:, 1]
    a = (way_x * way_x + way_y * way_y)[:, None]
    b = -(off_x * way_x[:, None] + off_y * way_y[:, None])  # positive: coming nearer
    c = off_x * off_x + off_y * off_y - radius * radius
    square = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        u = c / (b + np.sqrt(np.maximum(square, 0.0)))
    hits = (square >= 0.0) & (b > 0.0) & (u <= 1.0)
    return np.where(hits, np.maximum(u, 0.0), 1.0).min(axis=1)
