"""Whether discs can move straight away from an outline: then they stand in no pocket of it."""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing

_DIRECTIONS = 16
"""Directions all round that are tried where straight off the nearest place does not do."""


@compiled_borrowing
def _off_nearest(x, y, at_x, at_y):
    """Unit vector to a place from the point of the outline that is nearest to it, or (0, 0)."""
    least = np.inf
    way_x, way_y = 0.0, 0.0
    for k in range(len(x)):
        ax, ay = x[k - 1] - at_x, y[k - 1] - at_y
        side_x, side_y = x[k] - x[k - 1], y[k] - y[k - 1]
        square = side_x * side_x + side_y * side_y
        t = -(ax * side_x + ay * side_y) / square if square > 0.0 else 0.0
        t = min(max(t, 0.0), 1.0)
        near_x, near_y = ax + t * side_x, ay + t * side_y
        far = np.hypot(near_x, near_y)
        if far < least:
            least = far
            way_x, way_y = -near_x, -near_y
    if least <= 0.0:
        return 0.0, 0.0
    return way_x / least, way_y / least


@compiled_borrowing
def _clear_ahead(x, y, at_x, at_y, way_x, way_y, reach):
    """Whether a disc that moves from a place in a direction, for ever, meets no edge."""
    for k in range(len(x)):
        ax, ay = x[k - 1] - at_x, y[k - 1] - at_y
        bx, by = x[k] - at_x, y[k] - at_y
        along_a, along_b = ax * way_x + ay * way_y, bx * way_x + by * way_y
        off_a, off_b = ay * way_x - ax * way_y, by * way_x - bx * way_y
        if along_a <= 0.0 or along_b <= 0.0:  # some of it lies behind
            side, rise = along_b - along_a, off_b - off_a
            square = side * side + rise * rise
            t = -(along_a * side + off_a * rise) / square if square > 0.0 else 0.0
            t = min(max(t, 0.0), 1.0)
            if np.hypot(along_a + t * side, off_a + t * rise) < reach:
                return False
            if along_a <= 0.0 and along_b <= 0.0:
                continue
            abreast = off_a - along_a / side * rise
            if along_a <= 0.0:
                off_a = abreast
            else:
                off_b = abreast
        if min(off_a, off_b) < reach and max(off_a, off_b) > -reach:
            return False
    return True


@compiled
def all_can_leave(x, y, places, reach, step):
    """Whether discs of the radius ``reach`` can go straight away from places (k, 2); else unknown.

    They begin ``step`` further on, straight off the outline or in one of a few other directions.
    """
    for k in range(len(places)):
        at_x, at_y = places[k, 0], places[k, 1]
        way_x, way_y = _off_nearest(x, y, at_x, at_y)
        found = False
        for turn in range(_DIRECTIONS + 1):
            if turn > 0:
                angle = 2.0 * math.pi * turn / _DIRECTIONS
                way_x, way_y = math.cos(angle), math.sin(angle)
            from_x, from_y = at_x + step * way_x, at_y + step * way_y
            if _clear_ahead(x, y, from_x, from_y, way_x, way_y, reach):
                found = True
                break
        if not found:
            return False
    return True
