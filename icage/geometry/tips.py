"""Sharp tips of the convex pieces: where half planes alone do not say how far a point is. Our own.

Whoever takes a point for a point of a piece if it is within a tolerance of all of its half planes
takes a point for one that lies the tolerance over the sine of half the angle beyond a tip: a
million tolerances beyond that of a sliver of 1e-6 rad. One more half plane for each sharp tip,
through it and across its bisector, leaves the piece as it is and nothing far beyond it.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.exterior import Pieces

SHARP: Final = 0.1
"""[rad] Beyond a tip that is blunter a point is at most twenty times the tolerance away."""


class Tips(NamedTuple):
    """The sharp tips of all pieces, those of piece k at ``tip_ptr[k]:tip_ptr[k + 1]``.

    (x, y) the tips, (nx, ny) unit vectors along their bisectors, into the pieces.
    """

    tip_ptr: IntArray
    tip_x: FloatArray
    tip_y: FloatArray
    tip_nx: FloatArray
    tip_ny: FloatArray


def sharp_tips(pieces: Pieces) -> Tips:
    """The tips of pieces that are sharper than ``SHARP``; no piece has more than two."""
    slots = len(pieces.slot_vertex)
    before = np.arange(-1, slots - 1)
    before[pieces.ptr[:-1]] = pieces.ptr[1:] - 1
    # of an inward normal n the edge runs along (n_y, -n_x)
    way = np.column_stack([pieces.normal_y, -pieces.normal_x])
    back = way[before]
    sharp = (way * back).sum(axis=1) < -np.cos(SHARP)
    into = (way - back)[sharp]
    into /= np.hypot(into[:, 0], into[:, 1])[:, None]
    at = pieces.slot_vertex[sharp]
    ptr = np.concatenate([[0], sharp.cumsum()])[pieces.ptr]
    return Tips(
        ptr, pieces.x[at], pieces.y[at],
        np.ascontiguousarray(into[:, 0]), np.ascontiguousarray(into[:, 1]),
    )  # fmt: skip
