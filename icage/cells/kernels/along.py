"""The passes along a way that is known, and whether the hand has escaped at its end. Our own."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import EDGE_FINGER, EDGE_SLOT
from icage.cells.kernels.facet import facet_of, finger_on_segment
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.search import SIGHT
from icage.cells.kernels.shrink import pivot
from icage.kernels.compiled import compiled

_OUT = 1e-10
"""[diameter] A finger this little outside its piece is in it: rounding."""


class Way(NamedTuple):
    """The passes (k, 3) = sigma, w_x, w_y of a way and the middles (k, 4) = d, w of where they are.

    ``begins`` says whether the hand is in the first cell, ``standing`` which finger the others can
    shrink to at the end (3: all are in one piece, -1: none).
    """

    passes: np.ndarray
    hands: np.ndarray
    begins: bool
    standing: int


@compiled
def way_through(pieces, z, hand, cells, edges, last, cap, worst):
    """The way of a hand (4,) over edges (k, 5) that leave cells (k, 3), to the cell ``last``."""
    room = new_room()
    passes = np.empty((len(edges), 3))
    hands = np.empty((len(edges), 4))
    begins = True
    for i in range(3):
        x = hand[0] + hand[2] * z[i, 0] - hand[3] * z[i, 1]
        y = hand[1] + hand[2] * z[i, 1] + hand[3] * z[i, 0]
        for s in range(pieces.ptr[cells[0, i]], pieces.ptr[cells[0, i] + 1]):
            a = pieces.slot_vertex[s]
            gap = pieces.normal_x[s] * (x - pieces.x[a]) + pieces.normal_y[s] * (y - pieces.y[a])
            if gap < -_OUT * pieces.scale:
                begins = False
    for k in range(len(edges)):
        finger = edges[k, EDGE_FINGER]
        facet = facet_of(pieces, cells[k], finger, edges[k, EDGE_SLOT])
        sigma, wx, wy = pass_value(pieces, z, facet, cap, worst, room)
        passes[k, 0], passes[k, 1], passes[k, 2] = sigma, wx, wy
        if sigma == np.inf:
            return Way(passes[: k + 1], hands[: k + 1], begins, -1)
        ends = finger_on_segment(pieces, z, facet, wx, wy, room.base)
        hands[k, 0] = 0.5 * (ends.x_lo + ends.x_hi) - (wx * z[finger, 0] - wy * z[finger, 1])
        hands[k, 1] = 0.5 * (ends.y_lo + ends.y_hi) - (wx * z[finger, 1] + wy * z[finger, 0])
        hands[k, 2], hands[k, 3] = wx, wy
    if last[0] == last[1] and last[1] == last[2]:
        return Way(passes, hands, begins, 3)
    dx, dy, wx, wy = hands[len(edges) - 1]
    barred = np.zeros(3, np.int64)
    standing = pivot(pieces, z, dx, dy, wx, wy, SIGHT * pieces.scale, barred)
    return Way(passes, hands, begins, standing)
