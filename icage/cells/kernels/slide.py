"""Can a hand at a minimum be moved at constant w? Asked of every grasp; only a plateau says yes."""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.cells.kernels.columns import BIRTH_SIGMA
from icage.cells.kernels.facet import MAX_EDGES
from icage.cells.kernels.tree import births
from icage.kernels.compiled import compiled

_ROOM = 4 * MAX_EDGES
"""Corners that are left of a piece cut by two others, at most."""


@compiled
def _gap(pieces, k, x, y):
    """How far a point is outside of piece k: 0 inside."""
    nearest = np.inf
    inside = True
    first, last = pieces.ptr[k], pieces.ptr[k + 1]
    for s in range(first, last):
        a = pieces.slot_vertex[s]
        b = pieces.slot_vertex[s + 1 if s + 1 < last else first]
        ax, ay = x - pieces.x[a], y - pieces.y[a]
        if pieces.normal_x[s] * ax + pieces.normal_y[s] * ay < 0.0:
            inside = False
        sx, sy = pieces.x[b] - pieces.x[a], pieces.y[b] - pieces.y[a]
        t = min(1.0, max(0.0, (ax * sx + ay * sy) / (sx * sx + sy * sy)))
        nearest = min(nearest, np.hypot(ax - t * sx, ay - t * sy))
    return 0.0 if inside else nearest


@compiled
def pieces_within(pieces, x, y, reach):
    """Pieces (k,) that have a point within ``reach`` of (x, y)."""
    m = len(pieces.ptr) - 1
    found = np.empty(m, np.int64)
    count = 0
    for k in range(m):
        near = True
        for s in range(pieces.ptr[k], pieces.ptr[k + 1]):
            a = pieces.slot_vertex[s]
            gap = pieces.normal_x[s] * (x - pieces.x[a]) + pieces.normal_y[s] * (y - pieces.y[a])
            if gap < -reach:
                near = False
                break
        if near and _gap(pieces, k, x, y) <= reach:
            found[count] = k
            count += 1
    return found[:count]


@compiled
def _cut(px, py, n, pieces, slot, shift_x, shift_y, give, qx, qy):
    """Keep what of a convex polygon is within ``give`` of the free side of a shifted edge."""
    a = pieces.slot_vertex[slot]
    ax, ay = pieces.x[a] - shift_x, pieces.y[a] - shift_y
    nx, ny = pieces.normal_x[slot], pieces.normal_y[slot]
    m = 0
    for k in range(n):
        j = k + 1 if k + 1 < n else 0
        u = nx * (px[k] - ax) + ny * (py[k] - ay) + give
        v = nx * (px[j] - ax) + ny * (py[j] - ay) + give
        if u >= 0.0:
            qx[m], qy[m] = px[k], py[k]
            m += 1
        if (u > 0.0 > v) or (v > 0.0 > u):
            t = u / (u - v)
            qx[m], qy[m] = px[k] + t * (px[j] - px[k]), py[k] + t * (py[j] - py[k])
            m += 1
    px[:m] = qx[:m]
    py[:m] = qy[:m]
    return m


@compiled
def _furthest(pieces, z, cell, dx, dy, wx, wy, give, room):
    """How far from (d_x, d_y) a hand of this w can be translated inside its cell, to ``give``."""
    px, py, qx, qy = room[0], room[1], room[2], room[3]
    n = 0
    for finger in range(len(cell)):
        shift_x = wx * z[finger, 0] - wy * z[finger, 1]
        shift_y = wx * z[finger, 1] + wy * z[finger, 0]
        for s in range(pieces.ptr[cell[finger]], pieces.ptr[cell[finger] + 1]):
            if finger == 0:
                a = pieces.slot_vertex[s]
                px[n], py[n] = pieces.x[a] - shift_x, pieces.y[a] - shift_y
                n += 1
            else:
                n = _cut(px, py, n, pieces, s, shift_x, shift_y, give, qx, qy)
    furthest = 0.0
    for k in range(n):
        furthest = max(furthest, np.hypot(px[k] - dx, py[k] - dy))
    return furthest


@compiled
def can_slide(pieces, z, hand, sigma, cap, worst, same, far, give, cut):
    """Whether cells of this least sigma hold the hand (d_x, d_y, w_x, w_y) moved at constant w.

    ``same``: how near a finger is to its pieces; ``far``: a shift that counts; ``give``: how far
    into a wall; ``cut``: the depth within which a cell has the least sigma ``sigma``.
    """
    dx, dy, wx, wy = hand[0], hand[1], hand[2], hand[3]
    room = np.empty((4, _ROOM))
    x1, y1 = dx + wx * z[1, 0] - wy * z[1, 1], dy + wx * z[1, 1] + wy * z[1, 0]
    x2, y2 = dx + wx * z[2, 0] - wy * z[2, 1], dy + wx * z[2, 1] + wy * z[2, 0]
    near_0 = _near(pieces, dx, dy, same)
    near_1 = _near(pieces, x1, y1, same)
    near_2 = _near(pieces, x2, y2, same)
    cell = np.empty((1, 3), np.int64)
    for a in near_0:
        for b in near_1:
            for c in near_2:
                cell[0, 0], cell[0, 1], cell[0, 2] = a, b, c
                if _furthest(pieces, z, cell[0], dx, dy, wx, wy, give, room) <= far:
                    continue
                born = births(pieces, z, cell, cap, worst)
                if abs(born.value[0, BIRTH_SIGMA] - sigma) <= cut:
                    return True
    return False


@compiled
def which_slide(pieces, z, hands, sigma, cap, worst, same, far, give, cut):
    """``can_slide`` of hands (k, 4) with least sigma (k,)."""
    slide = np.zeros(len(hands), np.bool_)
    for k in range(len(hands)):
        slide[k] = can_slide(pieces, z, hands[k], sigma[k], cap, worst, same, far, give, cut)
    return slide


@compiled
def _near(pieces, x, y, reach):
    """Pieces at a point; a hand solved in doubles may sit a little inside a wall."""
    found = pieces_within(pieces, x, y, reach)
    if len(found) == 0:
        found = pieces_within(pieces, x, y, 100.0 * reach)
    return found
