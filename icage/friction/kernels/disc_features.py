"""Forces of disc fingers on contact features, and the ways in which they add up to none.

A finger's force acts where the finger touches, not at its centre p: at p + r n on an edge (n its
inward normal), at the vertex on an arc. Only part of an arc is looked at at a time: its forces are
those of all its normals together, too many rather than too few. [docs/theory.md, Sec. 10]
"""

# pyright: basic
from __future__ import annotations

import math

from icage.kernels.compiled import compiled

EDGE, CORNER, ARC = 0, 1, 2
"""Kinds of features: a straight edge, a concave corner, (part of) the arc round a vertex."""

MOST_EDGES = 4
"""Edges of force cones of one feature, at most: two cones in a corner."""

_WIDE = 1.0
"""[rad] Half a cone that is wider has a middle edge too: the two outer ones may span the rest."""

_NONE = 1e-13
"""[1] Size of a cross product of unit vectors that is 0."""

FORCE_X, FORCE_Y, AT_X, AT_Y, FIXED, OF_FINGER = 0, 1, 2, 3, 4, 5
"""Columns of a generator: a unit force; where it acts, from the finger's centre or, if fixed, from
the origin; the finger."""

TORQUE, POWER = 0, 5
"""Columns of a ray: torque as a row (5,) over (d, w, 1), and power as one (2,) over w."""


@compiled
def generators(contacts, finger, chosen, count, state, phi, found):
    """Fill in the edges of all force cones, rows of ``found``; returns how many.

    ``state`` (f, ...) has, for a finger on an arc, the direction from the vertex to the middle of
    the part of the arc, and half its turn.
    """
    n = 0
    r = contacts.radius
    for k in range(count):
        feature = chosen[k]
        kind = contacts.kind[feature]
        for cone in range(2 if kind == CORNER else 1):
            along = contacts.angle[feature, cone]
            half = phi
            x = r * math.cos(along)
            y = r * math.sin(along)
            if kind == ARC:
                along = state[finger[k], 0] + math.pi
                half = phi + state[finger[k], 1]
                x = contacts.place[feature, 0]
                y = contacts.place[feature, 1]
            for way in (-1.0, 0.0, 1.0):
                if way == 0.0 and half <= _WIDE:
                    continue
                if n == len(found):
                    break
                found[n, FORCE_X] = math.cos(along + way * half)
                found[n, FORCE_Y] = math.sin(along + way * half)
                found[n, AT_X] = x
                found[n, AT_Y] = y
                found[n, FIXED] = 1.0 if kind == ARC else 0.0
                found[n, OF_FINGER] = finger[k]
                n += 1
    return n


@compiled
def rays(z, edge, g, found):
    """Torque and power of the extreme forces that add up to none; returns how many.

    ``edge`` are the ``g`` generators. Each ray is three of them at most, of unit weight together.
    """
    n = 0
    for a in range(g):
        for b in range(a + 1, g):
            for c in range(b + 1, g):
                ax, ay = edge[a, FORCE_X], edge[a, FORCE_Y]
                bx, by = edge[b, FORCE_X], edge[b, FORCE_Y]
                cx, cy = edge[c, FORCE_X], edge[c, FORCE_Y]
                la = bx * cy - by * cx
                lb = cx * ay - cy * ax
                lc = ax * by - ay * bx
                if la < 0.0 or lb < 0.0 or lc < 0.0:
                    la, lb, lc = -la, -lb, -lc
                if la < -_NONE or lb < -_NONE or lc < -_NONE:
                    continue
                total = la + lb + lc
                if total < _NONE or n == len(found):
                    continue
                for col in range(7):
                    found[n, col] = 0.0
                for which in range(3):
                    row = a if which == 0 else b if which == 1 else c
                    weight = (la if which == 0 else lb if which == 1 else lc) / total
                    fx = weight * edge[row, FORCE_X]
                    fy = weight * edge[row, FORCE_Y]
                    finger = int(edge[row, OF_FINGER])
                    zx, zy = z[finger, 0], z[finger, 1]
                    if edge[row, FIXED] == 0.0:
                        found[n, TORQUE] += fy
                        found[n, TORQUE + 1] -= fx
                        found[n, TORQUE + 2] += zx * fy - zy * fx
                        found[n, TORQUE + 3] -= zx * fx + zy * fy
                    found[n, TORQUE + 4] += edge[row, AT_X] * fy - edge[row, AT_Y] * fx
                    # Re(conj(w) sum conj(z) f)
                    found[n, POWER] += zx * fx + zy * fy
                    found[n, POWER + 1] += zx * fy - zy * fx
                n += 1
    return n
