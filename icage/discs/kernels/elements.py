"""What is left of moved edges and of arcs where other edges come nearer than the radius.

The set of points of a line, or of an arc of this very radius, that are nearer than the radius to
one segment is a single interval: its ends are among a few candidates in closed form.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled, compiled_borrowing
from icage.kernels.storage import longer

NOTHING = 1e-12
"""[diameter] An element this short is rounding."""

_AT_END = 1e-12
"""[1] A crossing is taken to lie on a segment if its foot is this little beyond the end."""

_PARALLEL = 1e-12
"""[1] Sine of an angle between two edges that is none."""

_IN_REACH = 1e-6
"""[1] Edges are looked at up to this much further away than they can cover anything."""

_TURN = 2.0 * math.pi


class Left(NamedTuple):
    """Stretches: the edge or vertex (k, 1) of each, and where it begins and ends, (k, 2)."""

    number: np.ndarray
    ends: np.ndarray


class _Interval(NamedTuple):
    low: float
    high: float


@compiled_borrowing
def _with(interval, t):
    """The interval with one more point in it."""
    return _Interval(min(interval.low, t), max(interval.high, t))


@compiled_borrowing
def _boxes_meet(edges, other, first_x, first_y, last_x, last_y, reach):
    """Whether an edge's box meets the box round a segment, grown by ``reach``."""
    ax, ay = edges.start[other, 0], edges.start[other, 1]
    bx, by = edges.end[other, 0], edges.end[other, 1]
    return (
        min(first_x, last_x) - reach <= max(ax, bx)
        and max(first_x, last_x) + reach >= min(ax, bx)
        and min(first_y, last_y) - reach <= max(ay, by)
        and max(first_y, last_y) + reach >= min(ay, by)
    )


@compiled_borrowing
def _covered_line(edges, row, other, radius, size):
    """Where edge ``row``, moved out, is nearer than the radius to another edge."""
    sx = edges.start[row, 0] + radius * edges.out[row, 0]
    sy = edges.start[row, 1] + radius * edges.out[row, 1]
    wx, wy = edges.way[row, 0], edges.way[row, 1]
    nx, ny = edges.out[row, 0], edges.out[row, 1]
    ring_x, ring_y = edges.start[other, 0], edges.start[other, 1]
    way_x, way_y = edges.way[other, 0], edges.way[other, 1]
    out_x, out_y = edges.out[other, 0], edges.out[other, 1]
    length = edges.length[other]
    slack = _AT_END * length
    found = _Interval(np.inf, -np.inf)
    for last in range(2):
        cx, cy = ring_x, ring_y
        if last == 1:
            cx, cy = edges.end[other, 0], edges.end[other, 1]
        along = (cx - sx) * wx + (cy - sy) * wy
        across = (cx - sx) * nx + (cy - sy) * ny
        square = radius * radius - across * across
        if square <= 0.0:
            continue
        half = math.sqrt(square)
        for sign in (-1.0, 1.0):
            t = along + sign * half
            beyond = (sx + t * wx - cx) * way_x + (sy + t * wy - cy) * way_y
            if (last == 1 and beyond >= -slack) or (last == 0 and beyond <= slack):
                found = _with(found, t)
    gap = (sx - ring_x) * out_x + (sy - ring_y) * out_y
    slope = wx * out_x + wy * out_y
    if abs(slope) > _PARALLEL:
        for sign in (-1.0, 1.0):
            t = (sign * radius - gap) / slope
            foot = (sx + t * wx - ring_x) * way_x + (sy + t * wy - ring_y) * way_y
            if -slack <= foot <= length + slack:
                found = _with(found, t)
    elif abs(gap - radius) <= NOTHING * size and wx * way_x + wy * way_y < 0.0:
        # a slot that the finger fits into with no room to spare is closed
        along = (ring_x - sx) * wx + (ring_y - sy) * wy
        found = _with(_with(found, along), along - length)
    return found


@compiled_borrowing
def _covered_arc(edges, vertex, other, radius):
    """Where the circle round a vertex is nearer than the radius to an edge, [rad]: directions.

    They lie within half a turn of the first one's.
    """
    centre_x, centre_y = edges.start[vertex, 0], edges.start[vertex, 1]
    ring_x, ring_y = edges.start[other, 0], edges.start[other, 1]
    way_x, way_y = edges.way[other, 0], edges.way[other, 1]
    out_x, out_y = edges.out[other, 0], edges.out[other, 1]
    length = edges.length[other]
    slack = _AT_END * length
    off_x, off_y = ring_x - centre_x, ring_y - centre_y
    t = min(max(-(off_x * way_x + off_y * way_y), 0.0), length)
    near_x, near_y = off_x + t * way_x, off_y + t * way_y
    found = _Interval(np.inf, -np.inf)
    if near_x * near_x + near_y * near_y >= 4.0 * radius * radius:
        return found
    nearest = math.atan2(near_y, near_x)
    for last in range(2):
        cx, cy = ring_x, ring_y
        if last == 1:
            cx, cy = edges.end[other, 0], edges.end[other, 1]
        to_x, to_y = cx - centre_x, cy - centre_y
        share = math.sqrt(to_x * to_x + to_y * to_y) / (2.0 * radius)
        if share >= 1.0:
            continue
        half, towards = math.acos(share), math.atan2(to_y, to_x)
        for sign in (-1.0, 1.0):
            angle = towards + sign * half
            x, y = centre_x + radius * math.cos(angle), centre_y + radius * math.sin(angle)
            beyond = (x - cx) * way_x + (y - cy) * way_y
            if (last == 1 and beyond >= -slack) or (last == 0 and beyond <= slack):
                found = _with(found, (angle - nearest + math.pi) % _TURN - math.pi)
    height = -(off_x * out_x + off_y * out_y)
    outward = math.atan2(out_y, out_x)
    for side in (-1.0, 1.0):
        share = side - height / radius
        if abs(share) > 1.0:
            continue
        half = math.acos(share)
        for sign in (-1.0, 1.0):
            angle = outward + sign * half
            x, y = centre_x + radius * math.cos(angle), centre_y + radius * math.sin(angle)
            foot = (x - ring_x) * way_x + (y - ring_y) * way_y
            if -slack <= foot <= length + slack:
                found = _with(found, (angle - nearest + math.pi) % _TURN - math.pi)
    return _Interval(nearest + found.low, nearest + found.high)


@compiled_borrowing
def _put(cuts, count, low, high, length):
    """One more interval among the first ``count`` rows, which ascend; returns how many there are.

    Only if it covers anything of [0, length].
    """
    if not (low < length and high > 0.0 and high > low):
        return count
    k = count
    while k > 0 and cuts[k - 1, 0] > low:
        cuts[k, 0], cuts[k, 1] = cuts[k - 1, 0], cuts[k - 1, 1]
        k -= 1
    cuts[k, 0], cuts[k, 1] = low, high
    return count + 1


@compiled
def _add_left(number, ends, k, row, cuts, count, length, least):
    """What of [0, length] no interval covers, but for what is below ``least``, from row k on."""
    at = 0.0
    for c in range(count + 1):
        low, high = length, length
        if c < count:
            low, high = cuts[c, 0], cuts[c, 1]
        if low - at > least:
            if k == len(number):
                number, ends = longer(number), longer(ends)
            number[k, 0], ends[k, 0], ends[k, 1] = row, at, low
            k += 1
        at = max(at, high)
    return number, ends, k


@compiled
def lines_left(edges, radius, size):
    """What is left of every edge moved out, [unit] from its beginning."""
    n = len(edges.start)
    number, ends = np.empty((2 * n, 1), np.int64), np.empty((2 * n, 2))
    cuts = np.empty((n, 2))
    k = 0
    reach = radius * (1.0 + _IN_REACH) + _IN_REACH * size
    for row in range(n):
        before, after = (row - 1) % n, (row + 1) % n
        sx = edges.start[row, 0] + radius * edges.out[row, 0]
        sy = edges.start[row, 1] + radius * edges.out[row, 1]
        tx = sx + edges.length[row] * edges.way[row, 0]
        ty = sy + edges.length[row] * edges.way[row, 1]
        count = 0
        for other in range(n):
            # beside a convex vertex the edges keep clear of each other
            if other == row or not _boxes_meet(edges, other, sx, sy, tx, ty, reach):
                continue
            if (other == before and edges.turn[row] > 0.0) or (
                other == after and edges.turn[after] > 0.0
            ):
                continue
            found = _covered_line(edges, row, other, radius, size)
            count = _put(cuts, count, found.low, found.high, edges.length[row])
        number, ends, k = _add_left(
            number, ends, k, row, cuts, count, edges.length[row], NOTHING * size
        )
    return Left(number[:k], ends[:k])


@compiled
def arcs_left(edges, radius, size):
    """What is left of the arc round every convex vertex, [rad] from its beginning."""
    n = len(edges.start)
    number, ends = np.empty((2 * n, 1), np.int64), np.empty((2 * n, 2))
    cuts = np.empty((2 * n, 2))
    k = 0
    reach = 2.0 * radius * (1.0 + _IN_REACH)
    for vertex in range(n):
        turn = edges.turn[vertex]
        if not turn > 0.0:
            continue
        before = (vertex - 1) % n
        x, y = edges.start[vertex, 0], edges.start[vertex, 1]
        begin = math.atan2(edges.way[before, 1], edges.way[before, 0]) - 0.5 * math.pi
        count = 0
        for other in range(n):
            if other == vertex or other == before:
                continue
            if not _boxes_meet(edges, other, x, y, x, y, reach):
                continue
            found = _covered_arc(edges, vertex, other, radius)
            if found.low > found.high:
                continue
            nearest = 0.5 * (found.low + found.high)
            off = (nearest - begin + math.pi) % _TURN - math.pi - nearest
            for again in (0.0, _TURN):
                low, high = found.low + off + again, found.high + off + again
                count = _put(cuts, count, low, high, turn)
        number, ends, k = _add_left(
            number, ends, k, vertex, cuts, count, turn, NOTHING * size / radius
        )
    return Left(number[:k], ends[:k])
