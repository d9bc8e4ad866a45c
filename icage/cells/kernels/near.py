"""Which pieces and cells meet round a point: few, and found without a descent."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import put_first

_WIDER = 100.0
"""[1] A configuration solved in doubles may sit a little inside a wall: where a finger is near no
piece, those this many times as far off are taken."""


class Hand(NamedTuple):
    """A hand in the plane: finger k at d + w z_k, complex numbers as pairs."""

    d_x: float
    d_y: float
    w_x: float
    w_y: float


@compiled_borrowing
def _gap_to(pieces, k, x, y):
    """Distance of a point from the nearest edge of piece k."""
    nearest = np.inf
    first, end = pieces.ptr[k], pieces.ptr[k + 1]
    for s in range(first, end):
        a = pieces.slot_vertex[s]
        b = pieces.slot_vertex[s + 1 if s + 1 < end else first]
        sx = pieces.x[b] - pieces.x[a]
        sy = pieces.y[b] - pieces.y[a]
        t = ((x - pieces.x[a]) * sx + (y - pieces.y[a]) * sy) / (sx * sx + sy * sy)
        t = min(1.0, max(0.0, t))
        nearest = min(nearest, np.hypot(pieces.x[a] + t * sx - x, pieces.y[a] + t * sy - y))
    return nearest


@compiled_borrowing
def _is_near(pieces, k, x, y, reach):
    """Whether piece k has a point within about ``reach`` of the given one.

    Half planes alone accept far too much beyond the tip of a sliver: outside them the true
    distance is taken.
    """
    worst = np.inf
    for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
        a = pieces.slot_vertex[s]
        inside = pieces.normal_x[s] * (x - pieces.x[a]) + pieces.normal_y[s] * (y - pieces.y[a])
        worst = min(worst, inside)
        if worst < -reach:
            return False
    return worst >= 0.0 or _gap_to(pieces, k, x, y) <= reach


@compiled
def pieces_near(pieces, x, y, reach):
    """Pieces that have a point within about ``reach`` of the given one (relative coordinates)."""
    total = len(pieces.ptr) - 1
    found = np.empty(total, np.int64)
    count = 0
    for k in range(total):
        if _is_near(pieces, k, x, y, reach):
            found[count] = k
            count += 1
    return found[:count]


@compiled
def cells_near(pieces, z, hand, reach, most):
    """All cells (n, fingers) whose pieces come within ``reach`` of the fingers, in order.

    And their number, which is all there is if it is more than ``most``.
    """
    fingers = len(z)
    near = np.empty((fingers, len(pieces.ptr) - 1), np.int64)
    counts = np.empty(fingers, np.int64)
    total = 1
    for f in range(fingers):
        x = hand.d_x + hand.w_x * z[f, 0] - hand.w_y * z[f, 1]
        y = hand.d_y + hand.w_x * z[f, 1] + hand.w_y * z[f, 0]
        found = pieces_near(pieces, x, y, reach)
        if len(found) == 0:
            found = pieces_near(pieces, x, y, _WIDER * reach)
        put_first(near[f], found, len(found))
        counts[f] = len(found)
        total *= len(found)
    if total > most:
        return np.empty((0, fingers), np.int64), total
    cells = np.empty((total, fingers), np.int64)
    for row in range(total):
        rest = row
        for f in range(fingers - 1, -1, -1):
            cells[row, f] = near[f, rest % counts[f]]
            rest //= counts[f]
    return cells, total
