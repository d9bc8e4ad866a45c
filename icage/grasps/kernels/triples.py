"""Which triples of contact features can balance and squeeze, and from where."""

# pyright: basic
from __future__ import annotations

import math
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from icage.grasps.kernels.hands import first_finger
from icage.kernels.compiled import compiled
from icage.kernels.storage import put_first

_CORNERS = 16
"""Room for the corners of a set of points of concurrency: a square cut by six planes."""

_LEAST_SHARE = 1e-6
"""[1] A finger whose share of the force is no larger than this carries none."""

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


class TriplePoints(NamedTuple):
    """Points (n, 2) of concurrency of a triple; ``turns`` (n,) of its contacts, 1 or -1."""

    points: np.ndarray
    turns: np.ndarray


_PARTS = 16
"""Most parts into which a side of a triangle of the admissible set is cut."""


@compiled
def contact_at(kind, point, normal, px, py):
    """Finger position and unit inward force for lines of force through P."""
    dx = px - point[0]
    dy = py - point[1]
    along = normal[0] * dx + normal[1] * dy
    if kind == EDGE:  # the foot of P
        return ContactPoint(px - along * normal[0], py - along * normal[1], normal[0], normal[1])
    size = max(np.hypot(dx, dy), _NOTHING)
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
        put_first(qx, ox, n)
        put_first(qy, oy, n)
        if n < 3:
            return 0
    return n


@compiled
def _squeezing_area(kind, point, normal, planes, a, b, c, px, py, limits, x, y, fx, fy):
    """Twice the signed area of the contacts for lines of force through P, 0 if they are no grasp.

    ``limits`` are those of the hand on them. Fills in contacts and forces, (3,) each.
    """
    for s in range(3):
        f = a if s == 0 else (b if s == 1 else c)
        x[s], y[s], fx[s], fy[s] = contact_at(kind[f], point[f], normal[f], px, py)
    for s in range(3):
        f = a if s == 0 else (b if s == 1 else c)
        for side in range(2):
            if planes[f, side, 0] * px + planes[f, side, 1] * py < planes[f, side, 2]:
                return 0.0  # in a set of no width, by rounding
    if not squeezes(x, y, fx, fy):
        return 0.0
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    if area < 0.0:  # the other way round, for the hand
        x[1], y[1], x[2], y[2] = x[2], y[2], x[1], y[1]
        fx[1], fy[1], fx[2], fy[2] = fx[2], fy[2], fx[1], fy[1]
    return area if first_finger(x, y, limits) >= 0 else 0.0


@compiled
def _spread(qx, qy, n, step):
    """Points inside a convex polygon, (k, 2), about ``step`` apart; a few in a small one too."""
    cx = 0.0
    cy = 0.0
    for k in range(n):
        cx += qx[k] / n
        cy += qy[k] / n
    found = np.empty((n * _PARTS * (_PARTS + 1) // 2, 2))
    count = 0
    for k in range(n):
        h = k + 1 if k + 1 < n else 0
        ux, uy, vx, vy = qx[k] - cx, qy[k] - cy, qx[h] - cx, qy[h] - cy
        size = max(np.hypot(ux, uy), np.hypot(vx, vy))
        parts = min(_PARTS, max(3, int(math.ceil(size / step))))
        for i in range(parts):
            for j in range(parts - i):
                s, t = (i + 1.0 / 3.0) / parts, (j + 1.0 / 3.0) / parts
                found[count, 0] = cx + s * ux + t * vx
                found[count, 1] = cy + s * uy + t * vy
                count += 1
    return found[:count]


@compiled
def _near_part(qx, qy, n, middle, near, ox, oy):
    """Clip a polygon to the square of half side ``near`` about the middle; its new count."""
    for s in range(4):
        a = 1.0 if s == 0 else (-1.0 if s == 1 else 0.0)
        b = 1.0 if s == 2 else (-1.0 if s == 3 else 0.0)
        n = _clip(qx, qy, n, a, b, a * middle[0] + b * middle[1] - near, ox, oy)
        put_first(qx, ox, n)
        put_first(qy, oy, n)
        if n < 3:
            return 0
    return n


@compiled
def points_of_triple(kind, point, normal, planes, middle, reach, near, step, limits, triple):
    """Points of concurrency spread over all that a triple has: (n, 2), and (n,) orientations.

    Those that balance and squeeze and give a hand within the limits: ``step`` apart within ``near``
    of the middle, a few beyond, up to ``reach``. Orientation 1: the contacts are counterclockwise
    in the order of the triple; -1: clockwise.
    """
    qx = np.empty(_CORNERS)
    qy = np.empty(_CORNERS)
    ox = np.empty(_CORNERS)
    oy = np.empty(_CORNERS)
    x = np.empty(3)
    y = np.empty(3)
    fx = np.empty(3)
    fy = np.empty(3)
    qx[0], qy[0] = middle[0] - reach, middle[1] - reach
    qx[1], qy[1] = middle[0] + reach, middle[1] - reach
    qx[2], qy[2] = middle[0] + reach, middle[1] + reach
    qx[3], qy[3] = middle[0] - reach, middle[1] + reach
    m = 4
    for k in range(3):
        if m:
            m = _cut(planes, triple[k], qx, qy, m, ox, oy)
    if m == 0:
        return TriplePoints(np.empty((0, 2)), np.empty(0, np.int64))
    # a step longer than the whole square: few points to a corner
    tried = _spread(qx, qy, m, 4.0 * reach)
    m = _near_part(qx, qy, m, middle, near, ox, oy)
    if m:
        tried = np.concatenate((tried, _spread(qx, qy, m, step)))
    points = np.empty_like(tried)
    turns = np.empty(len(tried), np.int64)
    count = 0
    for k in range(len(tried)):
        area = _squeezing_area(
            kind, point, normal, planes, triple[0], triple[1], triple[2], tried[k, 0], tried[k, 1],
            limits, x, y, fx, fy,
        )  # fmt: skip
        if area != 0.0:
            points[count] = tried[k]
            turns[count] = 1 if area > 0.0 else -1
            count += 1
    return TriplePoints(points[:count], turns[:count])


@compiled
def feasible_triples(kind, point, normal, planes, middle, reach, near, step, limits, part, parts):
    """All unordered triples with a concurrency point P that balances and squeezes.

    Returns (triples (n, 3), points (n, 2)): features in counterclockwise order of their contacts,
    and one P each, well inside the set of possible ones where that will do, else the first of
    those ``step`` apart within ``near`` of the middle. ``limits`` are those of the hand on them.
    Only those whose least feature is ``part`` modulo ``parts``: a share for one of several threads.
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
    for a in range(part, n, parts):
        q1x[0], q1y[0] = middle[0] - reach, middle[1] - reach
        q1x[1], q1y[1] = middle[0] + reach, middle[1] - reach
        q1x[2], q1y[2] = middle[0] + reach, middle[1] + reach
        q1x[3], q1y[3] = middle[0] - reach, middle[1] + reach
        m1 = _cut(planes, a, q1x, q1y, 4, ox, oy)
        if m1 == 0:
            continue
        for b in range(a + 1, n):
            put_first(q2x, q1x, m1)
            put_first(q2y, q1y, m1)
            m2 = _cut(planes, b, q2x, q2y, m1, ox, oy)
            if m2 == 0:
                continue
            for c in range(b + 1, n):
                put_first(q3x, q2x, m2)
                put_first(q3y, q2y, m2)
                m3 = _cut(planes, c, q3x, q3y, m2, ox, oy)
                if m3 == 0:
                    continue
                cx = 0.0
                cy = 0.0
                for k in range(m3):
                    cx += q3x[k] / m3
                    cy += q3y[k] / m3
                area = 0.0
                px = cx
                py = cy
                for k in range(m3 + 1):
                    px = cx if k == 0 else 0.5 * (cx + q3x[k - 1])
                    py = cy if k == 0 else 0.5 * (cy + q3y[k - 1])
                    area = _squeezing_area(
                        kind, point, normal, planes, a, b, c, px, py, limits, x, y, fx, fy
                    )
                    if area != 0.0:
                        break
                # three edges push in the same directions and do the same work wherever P is
                edges = kind[a] == EDGE and kind[b] == EDGE and kind[c] == EDGE
                if area == 0.0 and not (edges and not squeezes(x, y, fx, fy)):
                    m3 = _near_part(q3x, q3y, m3, middle, near, ox, oy)
                    tried = _spread(q3x, q3y, m3, step)
                    for k in range(len(tried)):
                        px, py = tried[k, 0], tried[k, 1]
                        area = _squeezing_area(
                            kind, point, normal, planes, a, b, c, px, py, limits, x, y, fx, fy
                        )
                        if area != 0.0:
                            break
                if area == 0.0:
                    continue
                if count == len(triples):
                    triples = np.concatenate((triples, np.empty_like(triples)))
                    points = np.concatenate((points, np.empty_like(points)))
                triples[count, 0] = a
                triples[count, 1] = b if area > 0.0 else c
                triples[count, 2] = c if area > 0.0 else b
                points[count, 0], points[count, 1] = px, py
                count += 1
    return Triples(triples[:count], points[:count])
