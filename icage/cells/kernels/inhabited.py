"""Which cells hold a hand at all, and which of their facets do: a few of every thousand.

Two fingers say where the third one is: f_i = alpha f_j + beta f_k with alpha + beta = 1 for any
hand of one shape. So a cell is empty if and only if an edge normal of one of its pieces separates
that piece from the sum of the other two [Ericson2005]. How far every piece reaches along every
normal is tabulated once; then a cell costs a few additions. Our own.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled

GIVE = 1e-6
"""[diameter] Cells that are empty by no more than this are kept: what rounding can move a corner of
a piece by, and the careful pass values can open, is far less, and a cell too many costs little."""


class Extents(NamedTuple):
    """How far pieces reach along the inward edge normals of others.

    Attributes
    ----------
    most:
        (fingers, 2, slots, m) the most of n . (factor * p) over the points p of a piece, with n the
        inward normal of a slot of finger i's piece; second index: which of the other fingers.
    least:
        (slots,) n . v at the corner v where the slot begins: finger i's piece is where n . p is
        this or more.
    """

    most: np.ndarray
    least: np.ndarray


@compiled
def extents_of(pieces, z):
    """The table of all pieces along all edge normals. Complexity: corners times edges."""
    m = len(pieces.ptr) - 1
    slots = len(pieces.slot_vertex)
    fingers = len(z)
    most = np.full((fingers, 2, slots, m), -np.inf)
    least = np.empty(slots)
    for s in range(slots):
        v = pieces.slot_vertex[s]
        least[s] = pieces.normal_x[s] * pieces.x[v] + pieces.normal_y[s] * pieces.y[v]
    for i in range(fingers):
        for other in range(2):
            j = (i + 1 + other) % fingers
            k = (i + 2 - other) % fingers
            # f_i - f_k = factor (f_j - f_k)
            ux, uy = z[i, 0] - z[k, 0], z[i, 1] - z[k, 1]
            vx, vy = z[j, 0] - z[k, 0], z[j, 1] - z[k, 1]
            norm = vx * vx + vy * vy
            fx, fy = (ux * vx + uy * vy) / norm, (uy * vx - ux * vy) / norm
            for s in range(slots):
                # n . (factor p) is the normal, turned back, with p
                gx = pieces.normal_x[s] * fx + pieces.normal_y[s] * fy
                gy = pieces.normal_y[s] * fx - pieces.normal_x[s] * fy
                for piece in range(m):
                    top = -np.inf
                    for t in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
                        v = pieces.slot_vertex[t]
                        top = max(top, gx * pieces.x[v] + gy * pieces.y[v])
                    most[i, other, s, piece] = top
    return Extents(most, least)


@compiled
def _apart(pieces, extents, i, piece, one, two, give):
    """Whether an edge of finger i's piece keeps it from where the others can put the finger."""
    for s in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        if extents.most[i, 0, s, one] + extents.most[i, 1, s, two] < extents.least[s] - give:
            return True
    return False


@compiled
def inhabited_cells(pieces, extents, first, last):
    """Cells (n, 3) whose first finger is in the pieces ``first`` to ``last``, not included.

    In ascending order. Complexity: m^2 cells for each piece, some nanoseconds each.
    """
    m = len(pieces.ptr) - 1
    give = GIVE * pieces.scale
    cells = np.empty((1024, 3), np.int32)
    count = 0
    for a in range(first, last):
        for b in range(m):
            for c in range(m):
                if (
                    _apart(pieces, extents, 2, c, a, b, give)
                    or _apart(pieces, extents, 0, a, b, c, give)
                    or _apart(pieces, extents, 1, b, c, a, give)
                ):
                    continue
                if count == len(cells):
                    cells = np.concatenate((cells, np.empty_like(cells)))
                cells[count, 0], cells[count, 1], cells[count, 2] = a, b, c
                count += 1
    return cells[:count]
