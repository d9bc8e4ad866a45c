"""Edges of the outline that disc fingers touch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.geometry.round_chains import turns


class Edges(NamedTuple):
    """Edges of a counterclockwise ring without straight vertices; edge k starts at vertex k.

    Attributes
    ----------
    start, end:
        (n, 2).
    length:
        (n,).
    way, out:
        Unit vectors (n, 2) along the edges and out of the object.
    turn:
        Angle (n,) [rad] from edge k - 1 to edge k, positive at a convex vertex.
    """

    start: FloatArray
    end: FloatArray
    length: FloatArray
    way: FloatArray
    out: FloatArray
    turn: FloatArray

    @classmethod
    def of(cls, ring: FloatArray) -> Edges:
        """The edges of a ring (n, 2).

        Examples
        --------
        >>> edges = Edges.of(np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]))
        >>> edges.way[0].tolist(), edges.out[0].tolist(), edges.convex.tolist()
        ([1.0, 0.0], [0.0, -1.0], [True, True, True])
        """
        end = np.roll(ring, -1, axis=0)
        side = end - ring
        length = np.hypot(side[:, 0], side[:, 1])
        way = side / length[:, None]
        out = np.column_stack([way[:, 1], -way[:, 0]])
        return cls(ring, end, length, way, out, turns(ring))

    @property
    def convex(self) -> BoolArray:
        """Which vertices (n,) are convex."""
        return self.turn > 0.0
