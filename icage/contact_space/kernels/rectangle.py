"""One convex region of a contact space rectangle: clip, least sigma, seams. [Bunis2018, Sec. V-A]

Coordinates in a rectangle are (s, u): how far finger i is along edge j and finger i + 1 along edge
k. A region is the part of the rectangle where the third finger is in piece c of the plane. It is
clipped in (s, u) by the half planes of the piece, pulled back through Eq. (3) as linear functions:
no inverse of T is taken, so a singular T needs no care.
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.kernels.compiled import compiled

MOST_CORNERS = 48
"""Room for the corners of a region: 4 + one or two for every edge of a piece and its sharp tips."""

S_LOW, U_LOW, S_HIGH, U_HIGH, FIRST_SLOT = 0, 1, 2, 3, 4
"""Labels of a region's boundary: a finger at the start or end of its edge, then the slots."""


class Least(NamedTuple):
    """Least sigma and both ends (s, u) of where it is attained."""

    sigma: float
    s: float
    u: float
    s_too: float
    u_too: float


class LeastAt(NamedTuple):
    """Least sigma on a segment, and where."""

    sigma: float
    s: float
    u: float


@compiled
def finger_at(space, edge, s):
    """Point at distance ``s`` along an edge. [Bunis2018, Eq. (2)]"""
    return (
        space.edge_x[edge] + s * space.edge_tx[edge],
        space.edge_y[edge] + s * space.edge_ty[edge],
    )


@compiled
def third_finger(space, i, j, k, s, u):
    """The third finger of a pair on edges j, k. [Bunis2018, Eq. (3)]"""
    ax, ay = finger_at(space, j, s)
    bx, by = finger_at(space, k, u)
    re, im = space.turn_re[i], space.turn_im[i]
    return ax + re * (bx - ax) - im * (by - ay), ay + re * (by - ay) + im * (bx - ax)


@compiled
def scale_at(space, i, j, k, s, u):
    """The formation scale function. [Bunis2018, Def. 4]"""
    ax, ay = finger_at(space, j, s)
    bx, by = finger_at(space, k, u)
    return space.rho[i] * np.hypot(ax - bx, ay - by)


@compiled
def along(space, i, j, k, nx, ny, x0, y0):
    """N . (X - x0) of the third finger as h0 + hs s + hu u."""
    re, im = space.turn_re[i], space.turn_im[i]
    # n . R v = (R^T n) . v
    mx, my = re * nx + im * ny, re * ny - im * nx
    hs = (nx - mx) * space.edge_tx[j] + (ny - my) * space.edge_ty[j]
    hu = mx * space.edge_tx[k] + my * space.edge_ty[k]
    x, y = third_finger(space, i, j, k, 0.0, 0.0)
    return nx * (x - x0) + ny * (y - y0), hs, hu


@compiled
def clearance(space, i, j, k, slot):
    """Distance of the third finger from the line of a slot, positive inside the piece."""
    return along(
        space, i, j, k, space.slot_nx[slot], space.slot_ny[slot],
        space.slot_x[slot], space.slot_y[slot],
    )  # fmt: skip


@compiled
def _clipped(corners, count, h0, hs, hu, tol, spare):
    """Corners where h0 + hs s + hu u is not below 0, in ``corners`` again; returns how many."""
    out = 0
    before = h0 + hs * corners[count - 1, 0] + hu * corners[count - 1, 1]
    for a in range(count):
        s, u = corners[a, 0], corners[a, 1]
        here = h0 + hs * s + hu * u
        if (here < -tol and before > tol) or (here > tol and before < -tol):
            b = a - 1 if a > 0 else count - 1
            t = before / (before - here)
            spare[out, 0] = corners[b, 0] + t * (s - corners[b, 0])
            spare[out, 1] = corners[b, 1] + t * (u - corners[b, 1])
            out += 1
        if here >= -tol:
            spare[out, 0], spare[out, 1] = s, u
            out += 1
        before = here
    for a in range(out):
        corners[a, 0], corners[a, 1] = spare[a, 0], spare[a, 1]
    return out


@compiled
def region_corners(space, i, j, k, c, corners, spare):
    """Corners (count, 2) of region (i, j, k, c), counterclockwise; returns count (0: empty).

    A corner within the clip tolerance of a line is on it and stays where it is; so a region may
    come out as a segment or a point, touched by the lines that make it so: touching is free.
    Beyond the tip of a sliver a point may be that near to both of its edges and far from it: the
    lines across sharp tips are clipped by, too.
    """
    long_s, long_u = space.edge_length[j], space.edge_length[k]
    corners[0, 0], corners[0, 1] = 0.0, 0.0
    corners[1, 0], corners[1, 1] = long_s, 0.0
    corners[2, 0], corners[2, 1] = long_s, long_u
    corners[3, 0], corners[3, 1] = 0.0, long_u
    count = 4
    for slot in range(space.ptr[c], space.ptr[c + 1]):
        h0, hs, hu = clearance(space, i, j, k, slot)
        count = _clipped(corners, count, h0, hs, hu, space.clip, spare)
        if count == 0:
            return 0
    for tip in range(space.tip_ptr[c], space.tip_ptr[c + 1]):
        h0, hs, hu = along(
            space, i, j, k, space.tip_nx[tip], space.tip_ny[tip], space.tip_x[tip], space.tip_y[tip]
        )
        count = _clipped(corners, count, h0, hs, hu, space.clip, spare)
        if count == 0:
            return 0
    return count


@compiled
def least_on_edge(space, i, j, k, s1, u1, s2, u2):
    """Least sigma on a segment and where: the extremum, clamped. [Bunis2018, Eq. (5), Lemma 4.4]"""
    ax, ay = finger_at(space, j, s1)
    bx, by = finger_at(space, k, u1)
    gx, gy = ax - bx, ay - by
    ds, du = s2 - s1, u2 - u1
    ex = ds * space.edge_tx[j] - du * space.edge_tx[k]
    ey = ds * space.edge_ty[j] - du * space.edge_ty[k]
    square = ex * ex + ey * ey
    t = 0.0
    if square > 0.0:
        t = min(1.0, max(0.0, -(gx * ex + gy * ey) / square))
    s, u = s1 + t * ds, u1 + t * du
    return LeastAt(scale_at(space, i, j, k, s, u), s, u)


@compiled
def least_of_region(space, i, j, k, corners, count):
    """Least sigma of a region and both ends (s, u) of where it is attained.

    Sigma has no minimum inside a rectangle but along a valley between parallel edges, which ends
    on the boundary; so the boundary is enough. The ends are one point unless there is a valley.
    """
    low, ls, lu = np.inf, 0.0, 0.0
    for a in range(count):
        b = a + 1 if a + 1 < count else 0
        value, s, u = least_on_edge(
            space, i, j, k, corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
        )
        if value < low:
            low, ls, lu = value, s, u
    far, fs, fu = 0.0, ls, lu
    for a in range(count):
        b = a + 1 if a + 1 < count else 0
        s1, u1, s2, u2 = corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
        value, s, u = least_on_edge(space, i, j, k, s1, u1, s2, u2)
        for _ in range(2):
            if value <= low + space.flat and np.hypot(s - ls, u - lu) > far:
                far, fs, fu = np.hypot(s - ls, u - lu), s, u
            # the other end of a level edge
            value, s, u = scale_at(space, i, j, k, s2, u2), s2, u2
    return Least(low, ls, lu, fs, fu)


@compiled
def label_line(space, i, j, k, c, label):
    """Distance from the line of a label as h0 + hs s + hu u."""
    if label == S_LOW:
        return 0.0, 1.0, 0.0
    if label == U_LOW:
        return 0.0, 0.0, 1.0
    if label == S_HIGH:
        return space.edge_length[j], -1.0, 0.0
    if label == U_HIGH:
        return space.edge_length[k], 0.0, -1.0
    return clearance(space, i, j, k, space.ptr[c] + label - FIRST_SLOT)


@compiled
def slot_progress(space, i, j, k, c, label):
    """How far the third finger is along a slot as h0 + hs s + hu u, and the slot's length.

    Two edges of a piece may lie on one line (a wall and a diagonal that prolongs it): then to be
    on the line is not enough. Labels of fingers on their edges have no such trouble.
    """
    if label < FIRST_SLOT:
        return 0.0, 0.0, 0.0, 0.0
    slot = space.ptr[c] + label - FIRST_SLOT
    h0, hs, hu = along(
        space, i, j, k, space.slot_ny[slot], -space.slot_nx[slot],
        space.slot_x[slot], space.slot_y[slot],
    )  # fmt: skip
    return h0, hs, hu, space.slot_length[slot]


@compiled
def seam_value(space, i, j, k, c, label, corners, count):
    """Least sigma where a region meets a label's edge, and where; inf if it does not.

    The label, an index, says what lies across; coordinates only say where the edge is met.
    """
    low, ls, lu = np.inf, 0.0, 0.0
    tol = 2.0 * space.clip
    h0, hs, hu = label_line(space, i, j, k, c, label)
    g0, gs, gu, long = slot_progress(space, i, j, k, c, label)
    b = count - 1
    on_before = abs(h0 + hs * corners[b, 0] + hu * corners[b, 1]) <= tol
    for a in range(count):
        s, u = corners[a, 0], corners[a, 1]
        on_here = abs(h0 + hs * s + hu * u) <= tol
        if on_here:
            s0, u0 = (corners[b, 0], corners[b, 1]) if on_before else (s, u)
            # the part of the segment (s0, u0) -> (s, u) where the slot is
            first, last = g0 + gs * s0 + gu * u0, g0 + gs * s + gu * u
            t0, t1 = 0.0, 1.0
            step = last - first
            if max(first, last) < -tol or min(first, last) > long + tol:
                t1 = -1.0
            elif abs(step) > tol:
                at_start, at_end = (0.0 - first) / step, (long - first) / step
                t0 = max(0.0, min(1.0, min(at_start, at_end)))
                t1 = min(1.0, max(0.0, max(at_start, at_end)))
            if t1 >= t0:
                ds, du = s - s0, u - u0
                value, vs, vu = least_on_edge(
                    space, i, j, k, s0 + t0 * ds, u0 + t0 * du, s0 + t1 * ds, u0 + t1 * du
                )
                if value < low:
                    low, ls, lu = value, vs, vu
        on_before = on_here
        b = a
    return LeastAt(low, ls, lu)


@compiled
def across(space, i, j, k, c, label, out):
    """Regions on the other side of a label: rows (i, j, k, c) in ``out``; returns how many.

    A wall is a gluing seam: there all three fingers touch, and the configuration is a point of
    all three contact spaces. [Bunis2018, Def. 6]
    """
    n = len(space.edge_x)
    if label < FIRST_SLOT:
        out[0, 0], out[0, 1], out[0, 2], out[0, 3] = i, j, k, c
        if label == S_LOW:
            out[0, 1] = (j - 1) % n
        elif label == S_HIGH:
            out[0, 1] = (j + 1) % n
        elif label == U_LOW:
            out[0, 2] = (k - 1) % n
        else:
            out[0, 2] = (k + 1) % n
        return 1
    slot = space.ptr[c] + label - FIRST_SLOT
    q = space.slot_edge[slot]
    if q >= 0:
        out[0, 0], out[0, 1], out[0, 2], out[0, 3] = (i + 1) % 3, k, q, space.edge_piece[j]
        out[1, 0], out[1, 1], out[1, 2], out[1, 3] = (i + 2) % 3, q, j, space.edge_piece[k]
        return 2
    if space.slot_next[slot] < 0:
        return 0
    out[0, 0], out[0, 1], out[0, 2], out[0, 3] = i, j, k, space.slot_next[slot]
    return 1
