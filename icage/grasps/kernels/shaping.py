"""Points of concurrency at which the hand on three features has a wanted shape."""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.grasps.kernels.triples import contact_at
from icage.kernels.compiled import compiled

_STEPS = 12
_CLOSE = 1e-9
"""[rad] Off the wanted angles: as good as there."""

_DIFFERENCE = 1e-6
"""[diameter] Step of the slopes."""

_STRIDE = 0.1
"""[diameter] The longest step."""

_SINGULAR = 1e-12
"""[1] Share of the squared slopes that is added to them: where both angles change alike, the
shortest step that helps most."""


@compiled
def _error(features, triple, px, py, phi_1, phi_2, out):
    """Fill in how far both angles are off, for the best of the three readings."""
    x = np.empty(3)
    y = np.empty(3)
    for k in range(3):
        f = triple[k]
        at = contact_at(features.kind[f], features.point[f], features.normal[f], px, py)
        x[k], y[k] = at.x, at.y
    least = np.inf
    for k in range(3):
        h = (k + 1) % 3
        g = (k + 2) % 3
        base = math.atan2(y[h] - y[k], x[h] - x[k])
        one = (math.atan2(y[g] - y[k], x[g] - x[k]) - base) % (2.0 * math.pi) - phi_1
        two = (math.atan2(y[g] - y[h], x[g] - x[h]) - base) % (2.0 * math.pi) - phi_2
        off = max(abs(one), abs(two))
        if off < least:
            least = off
            out[0], out[1] = one, two
    return least


@compiled
def shaped_points(features, triples, points, phi_1, phi_2, diameter):
    """Points (n, 2) near the given ones where the hands have the wanted angles, and how far off.

    Gauss-Newton on the two angles of the best reading.
    """
    found = points.copy()
    off = np.empty(len(triples))
    here = np.empty(2)
    right = np.empty(2)
    above = np.empty(2)
    step = _DIFFERENCE * diameter
    for row in range(len(triples)):
        px, py = points[row, 0], points[row, 1]
        off[row] = _error(features, triples[row], px, py, phi_1, phi_2, here)
        for _ in range(_STEPS):
            if off[row] < _CLOSE:
                break
            _error(features, triples[row], px + step, py, phi_1, phi_2, right)
            _error(features, triples[row], px, py + step, phi_1, phi_2, above)
            a, b = (right[0] - here[0]) / step, (above[0] - here[0]) / step
            c, d = (right[1] - here[1]) / step, (above[1] - here[1]) / step
            damp = _SINGULAR * (a * a + b * b + c * c + d * d) + 1e-300
            m, n, o = a * a + c * c + damp, a * b + c * d, b * b + d * d + damp
            u, v = -(a * here[0] + c * here[1]), -(b * here[0] + d * here[1])
            det = m * o - n * n
            if not det > 0.0:  # three concave vertices: no contact moves with the point
                break
            mx, my = (o * u - n * v) / det, (m * v - n * u) / det
            length = np.hypot(mx, my)
            share = min(1.0, _STRIDE * diameter / max(length, 1e-300))
            px, py = px + share * mx, py + share * my
            off[row] = _error(features, triples[row], px, py, phi_1, phi_2, here)
        found[row, 0], found[row, 1] = px, py
    return found, off
