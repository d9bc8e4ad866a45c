"""The pieces of the plane with the object's edges moved: room for fingers a little thinner or thicker.

The pieces keep their names and neighbours, so that cells before and after are compared one by one.
Our own. [docs/theory.md, Sec. 2.8]
"""

from __future__ import annotations

from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.geometry.exterior import WALL, Pieces

_SHARP: Final = 1e-2
"""[1] Square of the sum of two unit normals at the tip of a spike of 11 degrees. A vertex that is
sharper moves by no more than that one's."""


def with_walls_moved(pieces: Pieces, by: float) -> Pieces:
    """The pieces with every edge of the object moved ``by`` [unit] to the free side.

    Vertices move to where the moved edges meet, and all edges keep their directions: between two
    vertices of which only one is the object's, or which move apart, an edge that is no edge of the
    object is then off by up to twice ``by``.
    """
    walls = np.flatnonzero(pieces.slot_neighbour == WALL)
    normal = np.column_stack([pieces.normal_x[walls], pieces.normal_y[walls]])
    after, before = np.zeros((2, len(pieces.x), 2))
    after[pieces.wall_from] = normal
    before[pieces.wall_to] = normal
    both: FloatArray = after + before
    square = (both * both).sum(axis=1)
    shift = (2.0 * by * both) / np.maximum(square, _SHARP)[:, None]
    return pieces._replace(x=pieces.x + shift[:, 0], y=pieces.y + shift[:, 1])
