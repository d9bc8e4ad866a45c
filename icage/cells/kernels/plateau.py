"""The translations of a hand that cost nothing: along opposing parallel edges. Our own."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import BIRTH_SIGMA
from icage.cells.kernels.near import Hand, cells_near
from icage.cells.kernels.tree import births
from icage.kernels.compiled import compiled
from icage.kernels.tips import RIGHT, tip_at
from icage.tolerance import DEPTH_CUT, PLATEAU, SAME_POINT, SLIDE_GIVE

_STEPS = 10
"""[piece] Cells that are gone through at most, from the middle of a plateau to its end."""


class Plateau(NamedTuple):
    """Both ends d of the translations at constant sigma; ``long`` if they are more than a point."""

    long: bool
    a_x: float
    a_y: float
    b_x: float
    b_y: float


@compiled
def _cut(corners, count, ax, ay, nx, ny, give, out):
    """The part of a convex polygon on the free side of a line, or ``give`` beyond; its corners."""
    kept = 0
    for k in range(count):
        h = k + 1 if k + 1 < count else 0
        u = (corners[k, 0] - ax) * nx + (corners[k, 1] - ay) * ny + give
        v = (corners[h, 0] - ax) * nx + (corners[h, 1] - ay) * ny + give
        if u >= 0.0:
            out[kept, 0], out[kept, 1] = corners[k, 0], corners[k, 1]
            kept += 1
        if (u > 0.0 > v) or (v > 0.0 > u):
            t = u / (u - v)
            out[kept, 0] = corners[k, 0] + t * (corners[h, 0] - corners[k, 0])
            out[kept, 1] = corners[k, 1] + t * (corners[h, 1] - corners[k, 1])
            kept += 1
    return kept


@compiled
def translations(pieces, z, cell, wx, wy):
    """Corners d (n, 2) of the convex set of hands in a cell that have this very w.

    Every finger may be a little outside its piece, but not further beyond a tip than elsewhere.
    """
    room = 4
    for f in range(len(z)):
        room += 3 * (pieces.ptr[cell[f] + 1] - pieces.ptr[cell[f]])
    corners = np.empty((room, 2))
    other = np.empty((room, 2))
    give = SLIDE_GIVE * pieces.diameter
    count = 0
    for f in range(len(z)):
        fx = wx * z[f, 0] - wy * z[f, 1]
        fy = wx * z[f, 1] + wy * z[f, 0]
        before = pieces.ptr[cell[f] + 1] - 1
        for s in range(pieces.ptr[cell[f]], pieces.ptr[cell[f] + 1]):
            v = pieces.slot_vertex[s]
            if f == 0:
                corners[count, 0], corners[count, 1] = pieces.x[v] - fx, pieces.y[v] - fy
                count += 1
                continue
            count = _cut(
                corners, count, pieces.x[v] - fx, pieces.y[v] - fy,
                pieces.normal_x[s], pieces.normal_y[s], give, other,
            )  # fmt: skip
            corners, other = other, corners
            tip = tip_at(pieces, before, s, RIGHT)
            if tip.sharp:
                count = _cut(
                    corners,
                    count,
                    pieces.x[v] - fx,
                    pieces.y[v] - fy,
                    tip.n_x,
                    tip.n_y,
                    give,
                    other,
                )
                corners, other = other, corners
            before = s
    return corners[:count].copy()


@compiled
def _is_further(hx, hy, ox, oy, bx, by, dx, dy, reach):
    """Whether d lies further from ``h`` than the best b, on the side away from the other end o."""
    if np.hypot(dx - hx, dy - hy) <= np.hypot(bx - hx, by - hy) + reach:
        return False
    return (dx - hx) * (ox - hx) + (dy - hy) * (oy - hy) <= 0.0


@compiled
def slid_further(pieces, z, here, other, best, cells, low, sigma):
    """The end of a plateau through a minimum ``here`` that lies further off than the ``best`` yet.

    Looked for in ``cells`` (n, fingers) that meet at the best one, of least sigma ``low`` (n,), on
    the side away from the ``other`` end; all ends are d (2,). And whether there is one.
    """
    size = pieces.diameter
    bx, by = best
    moved = False
    for k in range(len(cells)):
        if abs(low[k] - sigma) > DEPTH_CUT * size:
            continue
        corners = translations(pieces, z, cells[k], here.w_x, here.w_y)
        for c in range(len(corners)):
            if _is_further(
                here.d_x, here.d_y, other[0], other[1], bx, by,
                corners[c, 0], corners[c, 1], PLATEAU * size,
            ):  # fmt: skip
                bx, by = corners[c, 0], corners[c, 1]
                moved = True
    return bx, by, moved


@compiled
def plateau_through(pieces, z, here, sigma, cap, worst, most):
    """Ends of the translations at constant sigma through a minimum (opposing parallel edges).

    The hand keeps w, so the set is a segment of d; it is followed from cell to cell. Beyond the
    end of a plateau the hand may close further: such cells are not a part of it.
    """
    size = pieces.diameter
    ends = np.empty((2, 2))
    ends[:, 0], ends[:, 1] = here.d_x, here.d_y
    for side in range(2):
        for _ in range(_STEPS * (len(pieces.ptr) - 1)):
            at = Hand(ends[side, 0], ends[side, 1], here.w_x, here.w_y)
            cells, _ = cells_near(pieces, z, at, SAME_POINT * size, most)
            low = births(pieces, z, cells, cap, worst).value[:, BIRTH_SIGMA]
            bx, by, moved = slid_further(
                pieces, z, here, ends[1 - side], ends[side], cells, low, sigma
            )
            if not moved:
                break
            ends[side, 0], ends[side, 1] = bx, by
    length = np.hypot(ends[0, 0] - ends[1, 0], ends[0, 1] - ends[1, 1])
    return Plateau(length > PLATEAU * size, ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1])
