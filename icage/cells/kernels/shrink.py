"""Can a hand shrink to a point at once, one finger standing still? Then it has escaped.

The other two fingers move straight to the one that stands, and sigma only falls. Asking this of
every configuration that the search passes spares it the long way down to a pinched hand outside:
sigma_max is the same, for the search never lifts its level while anything lower is open. The test
is conservative: what it cannot decide to within ``tol`` it leaves to the search. Our own.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled_borrowing


@compiled_borrowing
def _blocks(pieces, k, ux, uy, vx, vy, length, tol):
    """Whether wall k bars the segment from u to v, of this length."""
    sx = vx - ux
    sy = vy - uy
    clear = 2.0 * tol * length
    p = pieces.wall_from[k]
    q = pieces.wall_to[k]
    px = pieces.x[p]
    py = pieces.y[p]
    # most walls lie clearly on one side of the segment's line: seen without a root or division
    cp = sx * (py - uy) - sy * (px - ux)
    cq = sx * (pieces.y[q] - uy) - sy * (pieces.x[q] - ux)
    if (cp > clear and cq > clear) or (cp < -clear and cq < -clear):
        return False
    ex = pieces.x[q] - px
    ey = pieces.y[q] - py
    edge = np.hypot(ex, ey)
    # the free side of a wall is on its left
    du = (ex * (uy - py) - ey * (ux - px)) / edge
    dv = (ex * (vy - py) - ey * (vx - px)) / edge
    if (du > tol and dv > tol) or (du < -tol and dv < -tol):
        return False
    sp = cp / length
    sq = cq / length
    if (sp > tol and sq > tol) or (sp < -tol and sq < -tol):
        return False
    if abs(du) <= tol:
        along = ((ux - px) * ex + (uy - py) * ey) / edge
        if -tol <= along <= edge + tol and dv >= -tol:
            return False
    if abs(dv) <= tol:
        along = ((vx - px) * ex + (vy - py) * ey) / edge
        if -tol <= along <= edge + tol and du >= -tol:
            return False
    return True


@compiled_borrowing
def sees(pieces, ux, uy, vx, vy, tol, barred, pair):
    """Whether the open segment from u to v stays outside the object (both ends are outside).

    ``barred[pair]`` is the wall that barred the last such segment: hands asked about one after the
    other are mostly neighbours, and the same wall bars the next one.
    """
    length = np.hypot(vx - ux, vy - uy)
    if length <= tol:
        return True
    if _blocks(pieces, barred[pair], ux, uy, vx, vy, length, tol):
        return False
    for k in range(len(pieces.wall_from)):
        if _blocks(pieces, k, ux, uy, vx, vy, length, tol):
            barred[pair] = k
            return False
    return True


@compiled_borrowing
def pivot(pieces, z, dx, dy, wx, wy, tol, barred):
    """A finger (0..2) that sees both others from where the hand stands, or -1.

    ``barred`` (3,) is memory that the calls of one search share, see ``sees``; zeros at first.
    """
    x0 = dx
    y0 = dy
    x1 = dx + wx * z[1, 0] - wy * z[1, 1]
    y1 = dy + wx * z[1, 1] + wy * z[1, 0]
    x2 = dx + wx * z[2, 0] - wy * z[2, 1]
    y2 = dy + wx * z[2, 1] + wy * z[2, 0]
    a = sees(pieces, x0, y0, x1, y1, tol, barred, 0)
    b = sees(pieces, x1, y1, x2, y2, tol, barred, 1)
    if a and b:
        return 1
    if not a and not b:
        return -1
    if not sees(pieces, x2, y2, x0, y0, tol, barred, 2):
        return -1
    return 0 if a else 2
