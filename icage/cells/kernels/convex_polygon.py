"""Convex polygons as arrays of corners, counterclockwise: clip, hull, area, middle. Our own."""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled
from icage.kernels.storage import put_first


class Corners(NamedTuple):
    """Room for a convex polygon; ``done`` marks corners that need no more work."""

    x: np.ndarray
    y: np.ndarray
    done: np.ndarray


class Line(NamedTuple):
    """The half plane e + g . (q - c) <= 0; ``weight`` sums the multipliers that prove it."""

    e: float
    g_x: float
    g_y: float
    c_x: float
    c_y: float
    weight: float


class Point(NamedTuple):
    """A point of the plane."""

    x: float
    y: float


@compiled
def new_corners(most):
    """Room for ``most`` corners."""
    return Corners(np.empty(most), np.empty(most), np.zeros(most, np.bool_))


@compiled
def clip(polygon, n, line, spare, room):
    """Keep the part of a convex polygon on a line's side; returns its corner count.

    New corners are not done; ``room`` is for as many corners as ``polygon`` has.
    """
    px, py, done = polygon.x, polygon.y, polygon.done
    qx, qy, qdone = room.x, room.y, room.done
    gx, gy, cx, cy = line.g_x, line.g_y, line.c_x, line.c_y
    m = 0
    e = line.e - spare  # rounding of a line from multipliers that large
    for a in range(n):
        if m > len(px) - 3:
            break
        b = a + 1 if a + 1 < n else 0
        va = e + gx * (px[a] - cx) + gy * (py[a] - cy)
        vb = e + gx * (px[b] - cx) + gy * (py[b] - cy)
        if va <= 0.0:
            qx[m], qy[m], qdone[m] = px[a], py[a], done[a]
            m += 1
        if (va < 0.0 < vb) or (vb < 0.0 < va):
            t = va / (va - vb)
            qx[m] = px[a] + t * (px[b] - px[a])
            qy[m] = py[a] + t * (py[b] - py[a])
            qdone[m] = False
            m += 1
    put_first(px, qx, m)
    put_first(py, qy, m)
    put_first(done, qdone, m)
    return m


@compiled
def hull(hx, hy, n, ox, oy):
    """Convex hull of n points, counterclockwise (monotone chain); returns its size."""
    order = np.argsort(hx[:n])
    for a in range(1, n):  # equal x by y: few points, insertion will do
        b = a
        while b > 0 and hx[order[b - 1]] == hx[order[b]] and hy[order[b - 1]] > hy[order[b]]:
            order[b - 1], order[b] = order[b], order[b - 1]
            b -= 1
    m = 0
    bottom = 2
    for turn in range(2):
        for a in range(n):
            k = order[a] if turn == 0 else order[n - 1 - a]
            if turn == 1 and a == 0:
                continue
            while m >= bottom:
                cross = (ox[m - 1] - ox[m - 2]) * (hy[k] - oy[m - 2]) - (oy[m - 1] - oy[m - 2]) * (
                    hx[k] - ox[m - 2]
                )
                if cross > 0.0:
                    break
                m -= 1
            ox[m] = hx[k]
            oy[m] = hy[k]
            m += 1
        bottom = m + 1
    return max(1, m - 1)


@compiled
def area(x, y, n):
    """Area of a counterclockwise polygon."""
    total = 0.0
    for a in range(1, n - 1):
        total += (x[a] - x[0]) * (y[a + 1] - y[0]) - (x[a + 1] - x[0]) * (y[a] - y[0])
    return 0.5 * total


@compiled
def mean(values, n):
    """Mean of the first n, added one after the other: numpy would add them in another order."""
    total = 0.0
    for a in range(n):
        total += values[a]
    return total / n


@compiled
def centroid(x, y, n):
    """Area centroid of a polygon, or the mean of its corners if it has no area."""
    total = 0.0
    cx = 0.0
    cy = 0.0
    for a in range(1, n - 1):
        part = (x[a] - x[0]) * (y[a + 1] - y[0]) - (x[a + 1] - x[0]) * (y[a] - y[0])
        total += part
        cx += part * (x[a] + x[a + 1] - 2.0 * x[0])
        cy += part * (y[a] + y[a + 1] - 2.0 * y[0])
    if total <= 0.0:
        return Point(mean(x, n), mean(y, n))
    return Point(x[0] + cx / (3.0 * total), y[0] + cy / (3.0 * total))


@compiled
def beyond(x, y, hx, hy, n):
    """Area that a point adds to the hull (hx, hy)."""
    total = 0.0
    for a in range(n):
        b = a + 1 if a + 1 < n else 0
        cross = (hx[b] - hx[a]) * (y - hy[a]) - (hy[b] - hy[a]) * (x - hx[a])
        if cross < 0.0:
            total -= 0.5 * cross
    return total
