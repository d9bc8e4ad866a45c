"""For which directions of the hand do forces from given cones balance and squeeze?

With finger k at d + w z_k and force f_k on the object, balance and squeezing are: sum f_k = 0, and
sum conj(p_k) f_k = conj(w) sum conj(z_k) f_k is real and negative. So -w has to lie in

    G = {sum conj(z_k) f_k : f_k in cone k, sum f_k = 0},

which is a convex cone of the plane, whatever d is. Our own. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled

_NONE = 1e-13
"""[1] Size of a cross product of unit vectors, and of a sum of such over the hand's sides, below
which it is 0."""

NOTHING, SECTOR, EVERYTHING = 0, 1, 2


@compiled
def balancing(z, finger, cone, row_of, count, sector):
    """Which w balance: NOTHING, EVERYTHING, or those in a ``sector``.

    ``finger`` (count,) are the fingers in contact, ``row_of`` their rows of ``cone`` (m, 4).
    ``sector`` (2,) becomes the middle of the directions of w and half their spread, [rad].
    """
    g = 2 * count
    most = g * (g - 1) * (g - 2) // 6 if g > 2 else 0
    angles = np.empty(most)
    n = 0
    for a in range(g):
        for b in range(a + 1, g):
            for c in range(b + 1, g):
                ia, ib, ic = row_of[a // 2], row_of[b // 2], row_of[c // 2]
                pa, pb, pc = 2 * (a % 2), 2 * (b % 2), 2 * (c % 2)
                ax, ay = cone[ia, pa], cone[ia, pa + 1]
                bx, by = cone[ib, pb], cone[ib, pb + 1]
                cx, cy = cone[ic, pc], cone[ic, pc + 1]
                # weights of the only sum of the three that is zero
                la = bx * cy - by * cx
                lb = cx * ay - cy * ax
                lc = ax * by - ay * bx
                if la < 0.0 or lb < 0.0 or lc < 0.0:
                    la, lb, lc = -la, -lb, -lc
                if la < -_NONE or lb < -_NONE or lc < -_NONE:
                    continue
                if la + lb + lc < _NONE:
                    continue
                fa, fb, fc = finger[a // 2], finger[b // 2], finger[c // 2]
                # the sum of conj(z) f, and its opposite is a direction of w
                x = la * (z[fa, 0] * ax + z[fa, 1] * ay)
                y = la * (z[fa, 0] * ay - z[fa, 1] * ax)
                x += lb * (z[fb, 0] * bx + z[fb, 1] * by)
                y += lb * (z[fb, 0] * by - z[fb, 1] * bx)
                x += lc * (z[fc, 0] * cx + z[fc, 1] * cy)
                y += lc * (z[fc, 0] * cy - z[fc, 1] * cx)
                if np.hypot(x, y) > _NONE * (la + lb + lc):
                    angles[n] = math.atan2(-y, -x)
                    n += 1
    if n == 0:
        return NOTHING
    found = np.sort(angles[:n])
    widest = found[0] + 2.0 * math.pi - found[n - 1]
    first = found[0]
    for k in range(1, n):
        if found[k] - found[k - 1] > widest:
            widest = found[k] - found[k - 1]
            first = found[k]
    spread = 2.0 * math.pi - widest
    if widest < math.pi - _NONE:
        return EVERYTHING
    sector[0] = first + 0.5 * spread
    sector[1] = min(0.5 * spread, 0.5 * math.pi)
    return SECTOR
