"""The pieces of the plane with the object's edges moved a hair, as if the fingers were thinner.

The pieces keep their names and neighbours, so that cells before and after are compared one by one.
Our own. [docs/theory.md, Sec. 2.8]
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.exterior import Pieces
from icage.geometry.kernels.pieces import WALL

_BLUNT: Final = 0.1
"""[1] Sine of the turn at a vertex below which it moves along the mean of both edges' normals."""

_FURTHEST: Final = 10.0
"""[1] How much further than its edges the tip of a spike moves at most."""

_STRAIGHT: Final = 1e-12
"""[1] Sine of what a corner may turn the wrong way: rounding."""


def with_walls_moved(pieces: Pieces, by: FloatArray) -> Pieces:
    """The pieces with the edges of the object moved to the free side, ``by`` (walls,) [unit].

    Vertices move to where the moved edges meet, and the pieces' other edges go with them. A piece
    that would no longer be convex, as three of its corners all but lie on a line, keeps the
    directions of its edges instead: those that are no edges of the object are then off by up to
    twice the change. The edges of the object are in the order of ``Pieces.wall_from``.
    """
    walls = np.flatnonzero(pieces.slot_neighbour == WALL)
    n_x, n_y = pieces.normal_x[walls], pieces.normal_y[walls]
    # of each vertex, the edge that begins there and the one that ends there
    begins, ends = np.full((2, len(pieces.x)), -1)
    begins[pieces.wall_from] = ends[pieces.wall_to] = np.arange(len(walls))
    at = np.flatnonzero((begins >= 0) & (ends >= 0))
    i, j = ends[at], begins[at]
    turn = n_x[i] * n_y[j] - n_y[i] * n_x[j]
    blunt = (np.abs(turn) < _BLUNT) & (n_x[i] * n_x[j] + n_y[i] * n_y[j] > 0.0)
    safe = np.where(np.abs(turn) < 1e-9, np.inf, turn)
    mean = 0.5 * (by[i] + by[j])
    shift_x = np.where(blunt, mean * n_x[j], (by[i] * n_y[j] - by[j] * n_y[i]) / safe)
    shift_y = np.where(blunt, mean * n_y[j], (by[j] * n_x[i] - by[i] * n_x[j]) / safe)
    far = np.hypot(shift_x, shift_y) / (_FURTHEST * np.abs(by).max(initial=1e-300))
    x, y = pieces.x.copy(), pieces.y.copy()
    x[at] += shift_x / np.maximum(far, 1.0)
    y[at] += shift_y / np.maximum(far, 1.0)
    return _with_normals(pieces._replace(x=x, y=y), walls)


def _with_normals(pieces: Pieces, walls: IntArray) -> Pieces:
    """The pieces with the normals of their moved corners, where these are convex."""
    first, last = pieces.ptr[:-1], pieces.ptr[1:] - 1
    slots = np.arange(len(pieces.slot_vertex))
    following, preceding = slots + 1, slots - 1
    following[last], preceding[first] = first, last
    start, end = pieces.slot_vertex, pieces.slot_vertex[following]
    side_x, side_y = pieces.x[end] - pieces.x[start], pieces.y[end] - pieces.y[start]
    length = np.hypot(side_x, side_y)
    normal_x, normal_y = -side_y / length, side_x / length
    normal_x[walls], normal_y[walls] = pieces.normal_x[walls], pieces.normal_y[walls]
    turn = normal_x[preceding] * normal_y - normal_y[preceding] * normal_x
    owner = np.repeat(np.arange(pieces.total), np.diff(pieces.ptr))
    bent = np.zeros(pieces.total, dtype=np.bool_)
    bent[owner[turn < -_STRAIGHT]] = True
    kept = bent[owner]
    return pieces._replace(
        normal_x=np.where(kept, pieces.normal_x, normal_x),
        normal_y=np.where(kept, pieces.normal_y, normal_y),
    )
