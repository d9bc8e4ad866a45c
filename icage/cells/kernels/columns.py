"""What the columns of the arrays hold that kernels and their callers share, and what codes mean."""

from __future__ import annotations

from enum import IntEnum


class Ending(IntEnum):
    """How a search over the cells has ended."""

    GAVE_UP = -1
    CLOSED_IN = 0
    ESCAPED = 1
    MET = 2
    """Another basin was met that is as deep as was asked; the search went no further."""


class StartSide(IntEnum):
    """On which side of a merge the start (node 0) was."""

    NEITHER = 0
    SWALLOWED = 1
    SURVIVING = 2


NODE_EDGE = 3
"""nodes (k, 4): the pieces of the three fingers come first, then the edge that led here."""

EDGE_FROM, EDGE_TO, EDGE_FINGER, EDGE_SLOT, EDGE_KEY = range(5)
"""edges (e, 5), or (e, 4) without the key of the cell behind. ``EDGE_TO`` -1: never visited."""

PASS_SIGMA, PASS_WX, PASS_WY = range(3)
"""edge_value (e, 3): the least sigma on the facet of an edge, and w there."""

BIRTH_SIGMA, BIRTH_WX, BIRTH_WY = range(3)
"""birth (n, 3): the least sigma of a cell, and w there."""

BORN_FINGER, BORN_SLOT = range(2)
"""birth_at (n, 2): the finger that is on an edge of its piece there, and the edge (-1: none)."""

RECORD_LEVEL, RECORD_BIRTH, RECORD_NODE = range(3)
"""records (r, 3): level at the running maximum, birth of the basin behind it, its first node."""

MERGE_KEEP, MERGE_LOSE, MERGE_EDGE, MERGE_SIDE = range(4)
"""merges (m, 4): nodes of the surviving and the swallowed minimum, edge, ``StartSide``."""

LOW_LEVEL, LOW_DEPTH = range(2)
"""lows (m, 2): level of a merge, and its height above the birth of the swallowed minimum."""

NEAR_DX, NEAR_DY, NEAR_WX, NEAR_WY, NEAR_SIGMA, NEAR_MOVED, NEAR_TURNED = range(7)
"""near (n, 7): a least point of a cell near the contacts: d, w, sigma; how far it is from them
[diameter] and turned [rad]."""
