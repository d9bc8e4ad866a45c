"""The true outline as convex pieces, vertex to vertex: what the fingers collide with."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.geometry.convex import merge_convex, triangulate
from icage.outline import Outline

MAX_PIECE_EDGES = 24
"""Collision cost grows slowly with the edges of a hull, fast with the number of hulls."""


def convex_pieces(outline: Outline) -> tuple[FloatArray, ...]:
    """Convex polygons (k, 2), counterclockwise, that tile the outline exactly.

    Only vertices of the outline are used, bit for bit, and neighbours share whole edges.

    Examples
    --------
    >>> corner = Outline([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])
    >>> [len(piece) for piece in convex_pieces(corner)]
    [4, 4]
    """
    vertices, triangles = triangulate(outline.polygon)
    rings = merge_convex(vertices, triangles, MAX_PIECE_EDGES)
    return tuple(vertices[np.array(ring)] for ring in rings)
