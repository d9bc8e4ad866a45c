"""Convex polygons of configurations, flat in R^4: corners (n, 4) = d_x, d_y, w_x, w_y.

A half space is a row of five numbers: it holds q where row[:4] . q + row[4] >= 0.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.tips import SHARP, tip_at


@compiled
def finger_row(row, n_x, n_y, z_x, z_y):
    """Fill in the half space of the hands whose finger at z has n . finger >= 0."""
    row[0] = n_x
    row[1] = n_y
    row[2] = n_x * z_x + n_y * z_y
    row[3] = n_y * z_x - n_x * z_y
    row[4] = 0.0


@compiled
def clip(corners, n, row, kept):
    """Write what lies in the half space into ``kept``; returns its number of corners.

    A polygon that rounding has crumpled beyond the room in ``kept`` stays whole: too large, which
    is the safe side.
    """
    m = 0
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        here = row[4]
        there = row[4]
        for c in range(4):
            here += row[c] * corners[a, c]
            there += row[c] * corners[b, c]
        if m + 2 > len(kept):
            kept[:n] = corners[:n]
            return n
        if here >= 0.0:
            kept[m] = corners[a]
            m += 1
        if (here >= 0.0) != (there >= 0.0):
            t = here / (here - there)
            for c in range(4):
                kept[m, c] = corners[a, c] + t * (corners[b, c] - corners[a, c])
            m += 1
    return m


@compiled
def least(corners, n, point):
    """The least sigma = |w| on a polygon without a pinched hand; its place goes to ``point``."""
    best = np.inf
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        ex = corners[b, 2] - corners[a, 2]
        ey = corners[b, 3] - corners[a, 3]
        square = ex * ex + ey * ey
        t = 0.0
        if square > 0.0:
            t = -(corners[a, 2] * ex + corners[a, 3] * ey) / square
            t = min(1.0, max(0.0, t))
        sigma = np.hypot(corners[a, 2] + t * ex, corners[a, 3] + t * ey)
        if sigma < best:
            best = sigma
            for c in range(4):
                point[c] = corners[a, c] + t * (corners[b, c] - corners[a, c])
    return best


@compiled
def keep(polygon, n, row, spare):
    """Clip a polygon where it is."""
    m = clip(polygon, n, row, spare)
    polygon[:m] = spare[:m]
    return m


@compiled
def keep_near(place, z, loose, row, polygon, n, spare):
    """Keep the hands whose finger at z is within ``loose`` of a point and the side from it.

    ``place`` (4,) is the point and the side, which may have no length.
    """
    length = np.hypot(place[2], place[3])
    t_x = 1.0
    t_y = 0.0
    if length > 0.0:
        t_x = place[2] / length
        t_y = place[3] / length
    for k in range(4):
        # along the edge, back from its end, and to both sides of it
        n_x = t_x if k == 0 else -t_x if k == 1 else -t_y if k == 2 else t_y
        n_y = t_y if k == 0 else -t_y if k == 1 else t_x if k == 2 else -t_x
        finger_row(row, n_x, n_y, z[0], z[1])
        row[4] = loose - n_x * place[0] - n_y * place[1]
        if k == 1:
            row[4] += length
        n = keep(polygon, n, row, spare)
    return n


@compiled
def keep_in_piece(pieces, piece, z, loose, row, polygon, n, spare):
    """Keep the hands whose finger at z is in a piece, or ``loose`` off, beyond sharp tips too."""
    before = pieces.ptr[piece + 1] - 1
    for slot in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
        v = pieces.slot_vertex[slot]
        n_x, n_y = pieces.normal_x[slot], pieces.normal_y[slot]
        finger_row(row, n_x, n_y, z[0], z[1])
        row[4] = loose - n_x * pieces.x[v] - n_y * pieces.y[v]
        n = keep(polygon, n, row, spare)
        tip = tip_at(pieces, before, slot, SHARP)
        if n and tip.sharp:
            finger_row(row, tip.n_x, tip.n_y, z[0], z[1])
            row[4] = loose - tip.n_x * pieces.x[v] - tip.n_y * pieces.y[v]
            n = keep(polygon, n, row, spare)
        if n == 0:
            return 0
        before = slot
    return n


@compiled
def put_hands_of_two(p, q, z_i, z_j, polygon):
    """Fill in the four corners of the hands with a finger on each of two sides, p and q (4,)."""
    side_x = z_j[0] - z_i[0]
    side_y = z_j[1] - z_i[1]
    square = side_x * side_x + side_y * side_y
    for k in range(4):
        s = 1.0 if k == 1 or k == 2 else 0.0
        u = 1.0 if k >= 2 else 0.0
        x = p[0] + s * p[2]
        y = p[1] + s * p[3]
        gap_x = q[0] + u * q[2] - x
        gap_y = q[1] + u * q[3] - y
        w_x = (gap_x * side_x + gap_y * side_y) / square
        w_y = (gap_y * side_x - gap_x * side_y) / square
        polygon[k, 0] = x - (w_x * z_i[0] - w_y * z_i[1])
        polygon[k, 1] = y - (w_x * z_i[1] + w_y * z_i[0])
        polygon[k, 2] = w_x
        polygon[k, 3] = w_y
