"""Which triples of contact features can balance and squeeze, and from where."""

# pyright: basic
from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled

_CORNERS = 16
"""Room for the corners of a set of points of concurrency: a square cut by six planes."""

_LEAST_SHARE = 1e-6
"""[1] A finger whose share of the force is no larger than this carries none."""

_NO_TRIANGLE = 1e-3
"""[1] Contacts on a triangle flatter than this (twice its area over the square of its shortest
side) make no hand."""

_NOTHING = 1e-300
"""[unit] What is divided by instead of a distance 0."""


class FeatureKind(IntEnum):
    """Where a finger carries force: on an edge, or at a concave vertex."""

    EDGE = 0
    VERTEX = 1


EDGE, VERTEX = FeatureKind


class ContactPoint(NamedTuple):
    """A finger position and its unit inward force."""

    x: float
    y: float
    f_x: float
    f_y: float


class Triples(NamedTuple):
    """Triples (n, 3) of features, counterclockwise, and a point (n, 2) of concurrency for each."""

    triples: np.ndarray
    points: np.ndarray


@compiled
def contact_at(kind, point, normal, px, py):
    """Finger position and unit inward force for lines of force through P."""
    dx = px - point[0]
    dy = py - point[1]
    along = normal[0] * dx + normal[1] * dy
    if kind == EDGE:  # the foot of P
        return ContactPoint(px - along * normal[0], py - along * normal[1], normal[0], normal[1])
    size = max(math.hypot(dx, dy), _NOTHING)
    side = 1.0 if along > 0.0 else -1.0
    return ContactPoint(point[0], point[1], side * dx / size, side * dy / size)


@compiled
def squeezes(x, y, fx, fy):
    """Whether unit forces balance with positive shares and closing does positive work.

    Positive lambda with sum lambda_i f_i = 0, and sum lambda_i (f_i . p_i) < 0.
    [docs/theory.md, Sec. 2.6]
    """
    a = fx[1] * fy[2] - fy[1] * fx[2]
    b = fx[2] * fy[0] - fy[2] * fx[0]
    c = fx[0] * fy[1] - fy[0] * fx[1]
    if a + b + c < 0.0:
        a, b, c = -a, -b, -c
    if min(a, b, c) <= _LEAST_SHARE:
        return False
    work = (
        a * (fx[0] * x[0] + fy[0] * y[0])
        + b * (fx[1] * x[1] + fy[1] * y[1])
        + c * (fx[2] * x[2] + fy[2] * y[2])
    )
    return work < 0.0


@compiled
def _clip(qx, qy, n, a, b, c, ox, oy):
    m = 0
    for k in range(n):
        h = k + 1 if k + 1 < n else 0
        u = a * qx[k] + b * qy[k] - c
        v = a * qx[h] + b * qy[h] - c
        if u >= 0.0:
            ox[m] = qx[k]
            oy[m] = qy[k]
            m += 1
        if (u > 0.0 > v) or (v > 0.0 > u):
            t = u / (u - v)
            ox[m] = qx[k] + t * (qx[h] - qx[k])
            oy[m] = qy[k] + t * (qy[h] - qy[k])
            m += 1
    return m


@compiled
def _cut(planes, f, qx, qy, n, ox, oy):
    """Clip by both planes of feature f; the result is in q again."""
    for s in range(2):
        n = _clip(qx, qy, n, planes[f, s, 0], planes[f, s, 1], planes[f, s, 2], ox, oy)
        qx[:n] = ox[:n]
        qy[:n] = oy[:n]
        if n < 3:
            return 0
    return n


@compiled
def feasible_triples(kind, point, normal, planes, middle, reach, apart):
    """All unordered triples with a concurrency point P that balances and squeezes.

    The features are in counterclockwise order of their contacts, and P is well inside the set of
    possible ones. ``apart`` is the least finger distance.
    """
    n = len(kind)
    triples = np.empty((1024, 3), np.int64)
    points = np.empty((1024, 2))
    count = 0
    q1x = np.empty(_CORNERS)
    q1y = np.empty(_CORNERS)
    q2x = np.empty(_CORNERS)
    q2y = np.empty(_CORNERS)
    q3x = np.empty(_CORNERS)
    q3y = np.empty(_CORNERS)
    ox = np.empty(_CORNERS)
    oy = np.empty(_CORNERS)
    x = np.empty(3)
    y = np.empty(3)
    fx = np.empty(3)
    fy = np.empty(3)
    for a in range(n):
        q1x[0], q1y[0] = middle[0] - reach, middle[1] - reach
        q1x[1], q1y[1] = middle[0] + reach, middle[1] - reach
        q1x[2], q1y[2] = middle[0] + reach, middle[1] + reach
        q1x[3], q1y[3] = middle[0] - reach, middle[1] + reach
        m1 = _cut(planes, a, q1x, q1y, 4, ox, oy)
        if m1 == 0:
            continue
        for b in range(a + 1, n):
            q2x[:m1] = q1x[:m1]
            q2y[:m1] = q1y[:m1]
            m2 = _cut(planes, b, q2x, q2y, m1, ox, oy)
            if m2 == 0:
                continue
            for c in range(b + 1, n):
                q3x[:m2] = q2x[:m2]
                q3y[:m2] = q2y[:m2]
                m3 = _cut(planes, c, q3x, q3y, m2, ox, oy)
                if m3 == 0:
                    continue
                cx = 0.0
                cy = 0.0
                for k in range(m3):
                    cx += q3x[k] / m3
                    cy += q3y[k] / m3
                for k in range(m3 + 1):
                    px = cx if k == 0 else 0.5 * (cx + q3x[k - 1])
                    py = cy if k == 0 else 0.5 * (cy + q3y[k - 1])
                    for s in range(3):
                        f = a if s == 0 else (b if s == 1 else c)
                        x[s], y[s], fx[s], fy[s] = contact_at(kind[f], point[f], normal[f], px, py)
                    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
                    near = min(
                        math.hypot(x[1] - x[0], y[1] - y[0]),
                        math.hypot(x[2] - x[1], y[2] - y[1]),
                        math.hypot(x[0] - x[2], y[0] - y[2]),
                    )
                    if near < apart or abs(area) < _NO_TRIANGLE * near * near:
                        continue
                    if not squeezes(x, y, fx, fy):
                        continue
                    if count == len(triples):
                        triples = np.concatenate((triples, np.empty_like(triples)))
                        points = np.concatenate((points, np.empty_like(points)))
                    triples[count, 0] = a
                    triples[count, 1] = b if area > 0.0 else c
                    triples[count, 2] = c if area > 0.0 else b
                    points[count, 0], points[count, 1] = px, py
                    count += 1
                    break
    return Triples(triples[:count], points[:count])
