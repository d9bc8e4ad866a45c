"""Convex polygons of configurations, flat in R^4: corners (n, 4) = d_x, d_y, w_x, w_y.

A half space is a row of five numbers: it holds q where row[:4] . q + row[4] >= 0.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.kernels.compiled import compiled


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
