"""Sharp tips of the convex pieces: where half planes alone do not say how far a point is. Our own.

Whoever takes a point for a point of a piece if it is within a tolerance of all of its half planes
takes a point for one that lies the tolerance over the sine of half the angle beyond a tip: a
million tolerances beyond that of a sliver of 1e-6 rad. One more half plane for each sharp tip,
through it and across its bisector, leaves the piece as it is and nothing far beyond it.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

RIGHT = 2.0
"""[1] For ``tip_at``, of a right angle: beyond a tip no further than 1.5 times the tolerance."""

SHARP = 2.0 + 2.0 * math.cos(0.1)
"""[1] For ``tip_at``, of 0.1 rad: beyond a tip no further than twenty times the tolerance. For half
planes that a search has to bear often."""

MOST_TIPS = 3
"""Tips that a convex piece has at most, even if all below a right angle count."""


class Tip(NamedTuple):
    """Whether a corner is a sharp tip, and if so the unit bisector into the piece."""

    sharp: bool
    n_x: float
    n_y: float


class Tips(NamedTuple):
    """The sharp tips of all pieces, those of piece k at ``tip_ptr[k]:tip_ptr[k + 1]``.

    (x, y) the tips, (nx, ny) unit vectors along their bisectors, into the pieces.
    """

    tip_ptr: np.ndarray
    tip_x: np.ndarray
    tip_y: np.ndarray
    tip_nx: np.ndarray
    tip_ny: np.ndarray


@compiled_borrowing
def tip_at(pieces, before, s, sharp):
    """Whether the slots ``before`` and ``s`` of a piece meet in a tip sharper than ``sharp``.

    The square of the sum of the unit vectors along both edges, away from the corner they share, is
    2 + 2 cos(angle): ``sharp`` is its least value, ``RIGHT`` or ``SHARP``.
    """
    # of an inward normal n the edge runs along (n_y, -n_x)
    x = pieces.normal_y[s] - pieces.normal_y[before]
    y = pieces.normal_x[before] - pieces.normal_x[s]
    square = x * x + y * y
    if square <= sharp:
        return Tip(False, 0.0, 0.0)
    length = math.sqrt(square)
    return Tip(True, x / length, y / length)


@compiled
def tips_of(pieces, sharp):
    """All tips sharper than ``sharp`` (see ``tip_at``), piece by piece."""
    total = len(pieces.ptr) - 1
    room = len(pieces.slot_vertex)
    ptr = np.zeros(total + 1, np.int64)
    x, y = np.empty(room), np.empty(room)
    nx, ny = np.empty(room), np.empty(room)
    n = 0
    for k in range(total):
        before = pieces.ptr[k + 1] - 1
        for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
            tip = tip_at(pieces, before, s, sharp)
            if tip.sharp:
                v = pieces.slot_vertex[s]
                x[n], y[n], nx[n], ny[n] = pieces.x[v], pieces.y[v], tip.n_x, tip.n_y
                n += 1
            before = s
        ptr[k + 1] = n
    return Tips(ptr, x[:n].copy(), y[:n].copy(), nx[:n].copy(), ny[:n].copy())
