"""What the columns of the arrays hold that kernels and their callers share, and what codes mean."""

from __future__ import annotations

from enum import IntEnum


class Ending(IntEnum):
    """How a search through the contact space has ended."""

    ESCAPED = 0
    CLOSED_IN = 1
    GAVE_UP = 2


class EdgeKind(IntEnum):
    """Kinds of graph edges; a pinch is a tunnel edge that ends with all fingers in one point."""

    SEAM = 0
    TUNNEL = 1
    PINCH = 2


class Shot(IntEnum):
    """What stops a hand that shrinks about a finger: nothing moves, a wall, itself."""

    NO_TUNNEL = 0
    LANDED = 1
    PINCHED = 2


REGION_PAIR, REGION_J, REGION_K, REGION_PIECE, REGION_EDGE = range(5)
"""regions (r, 5): pair i, edges j and k, piece c, edge it was first reached by (-1: the start)."""

NODE_SIGMA, NODE_S, NODE_U, NODE_LEVEL = range(4)
"""nodes (r, 4): least sigma of a region, its s and u, level at which it was reached."""

EDGE_FROM, EDGE_TO, EDGE_LABEL, EDGE_KIND = range(4)
"""edges (e, 4): from and to (-1: a pinch), label or row of the tunnel edge, ``EdgeKind``."""

HAND_LEVEL = 0
HAND = slice(1, 5)
HAND_TOO = slice(5, 9)
"""hands (e, 9): level, a hand (d, w) of least sigma on the edge, the hand at a tunnel's other end.
In the list of all tunnel edges: the hand above, the hand below."""

ENTRY_REGION, ENTRY_LABEL = range(2)
"""entries (p, 2): a region, and the label by which the search may leave it."""

ABOVE = slice(0, 4)
BELOW = slice(4, 8)
TUNNEL_PAIR, TUNNEL_BELOW, TUNNEL_KEPT = 0, 4, 8
"""Tunnel edges (t, 9): the region above, the region below (``TUNNEL_BELOW`` -1: a pinch), which
finger of the pair stays."""

END_ROW, END_LOWER = range(2)
"""ends (e, 2): row of a tunnel edge, 1 for its lower end."""

MERGE_ELDER, MERGE_YOUNGER, MERGE_EDGE = range(3)
"""merges (m, 3): nodes of the elder and the younger minimum, edge."""
