"""Ray shooting for tunnel edges: one finger stays, the hand shrinks until another one touches.

[Bunis2018, Sec. V-B]. The kept finger f stays where it is and the hand keeps its orientation, so
both other fingers run straight at f; what stops them first is a wall, or each other at f: a pinch.
"""

# pyright: basic
from __future__ import annotations

import numpy as np

from icage.contact_space.kernels.columns import Shot
from icage.contact_space.kernels.rectangle import (
    MOST_CORNERS,
    finger_at,
    region_corners,
    third_finger,
)  # fmt: skip
from icage.kernels.compiled import compiled

NO_TUNNEL, LANDED, PINCHED = Shot

_ON_THE_WAY = 1e-9
"""[1] A wall this far (share of the way) before the start or behind the end is still met: rounding
of a finger that stands on a wall."""


@compiled
def touches(space, x, y):
    """Whether a point is within the touching distance of the object's boundary."""
    near = space.touch * space.touch
    for q in range(len(space.edge_x)):
        dx, dy = x - space.edge_x[q], y - space.edge_y[q]
        t = dx * space.edge_tx[q] + dy * space.edge_ty[q]
        t = min(space.edge_length[q], max(0.0, t))
        dx -= t * space.edge_tx[q]
        dy -= t * space.edge_ty[q]
        if dx * dx + dy * dy <= near:
            return True
    return False


@compiled
def may_leave(space, edge, s, dx, dy):
    """Whether a finger at ``s`` on an edge can move in direction (dx, dy), and the edge's mate.

    The mate is the other edge at the vertex where the finger stands, -1 inside the edge. At a
    convex vertex of the object one of both sides must be free, at a concave one both.
    """
    n = len(space.edge_x)
    free = dx * space.edge_ty[edge] - dy * space.edge_tx[edge] >= 0.0  # outwards: right of t
    if s <= space.touch:
        mate = (edge - 1) % n
        turn = mate, edge
    elif s >= space.edge_length[edge] - space.touch:
        mate = (edge + 1) % n
        turn = edge, mate
    else:
        return free, -1
    free_too = dx * space.edge_ty[mate] - dy * space.edge_tx[mate] >= 0.0
    a, b = turn
    convex = space.edge_tx[a] * space.edge_ty[b] - space.edge_ty[a] * space.edge_tx[b] >= 0.0
    return (free or free_too) if convex else (free and free_too), mate


@compiled
def first_hit(space, x, y, tx, ty, skip, skip_too):
    """First wall that the segment (x, y) -> (tx, ty) enters: fraction of the way, wall, place.

    Walls reach a hair beyond their ends, so that no ray slips through a vertex.
    """
    best, wall, place = np.inf, -1, 0.0
    dx, dy = tx - x, ty - y
    for q in range(len(space.edge_x)):
        if q in (skip, skip_too):
            continue
        ex, ey = space.edge_tx[q], space.edge_ty[q]
        speed = dx * ey - dy * ex
        if speed >= 0.0:  # along the wall or away from it
            continue
        off_x, off_y = space.edge_x[q] - x, space.edge_y[q] - y
        t = (off_x * ey - off_y * ex) / speed
        if t >= best or t < -_ON_THE_WAY or t > 1.0 + _ON_THE_WAY:
            continue
        s = (t * dx - off_x) * ex + (t * dy - off_y) * ey
        if -space.hair <= s <= space.edge_length[q] + space.hair:
            best, wall, place = t, q, min(space.edge_length[q], max(0.0, s))
    return best, wall, place


@compiled
def shoot(space, i, j, k, s, u, keep, landing, where):
    """Shrink the hand of pair i on (j, s), (k, u) about finger i (``keep`` 0) or i + 1 (1).

    Returns NO_TUNNEL if the mover cannot start, PINCHED, or LANDED: then ``landing`` (3,) holds
    pair and edges of the new contact, ``where`` (4,) its s and u and the third finger's position.
    """
    x1, y1 = finger_at(space, j, s)
    x2, y2 = finger_at(space, k, u)
    x3, y3 = third_finger(space, i, j, k, s, u)
    if keep == 0:
        fx, fy, mx, my, edge, at = x1, y1, x2, y2, k, u
    else:
        fx, fy, mx, my, edge, at = x2, y2, x1, y1, j, s
    free, mate = may_leave(space, edge, at, fx - mx, fy - my)
    if not free:
        return NO_TUNNEL
    t_mover, q_mover, s_mover = first_hit(space, mx, my, fx, fy, edge, mate)
    t_third, q_third, s_third = first_hit(space, x3, y3, fx, fy, -1, -1)
    t = min(t_mover, t_third)
    reach = np.hypot(fx - mx, fy - my)
    if (1.0 - t) * reach <= space.pinch:
        return PINCHED
    t = max(t, 0.0)
    if t_mover <= t_third:
        landing[0] = i
        where[2], where[3] = x3 + t * (fx - x3), y3 + t * (fy - y3)
        if keep == 0:
            landing[1], landing[2], where[0], where[1] = j, q_mover, s, s_mover
        else:
            landing[1], landing[2], where[0], where[1] = q_mover, k, s_mover, u
        return LANDED
    where[2], where[3] = mx + t * (fx - mx), my + t * (fy - my)
    if keep == 0:
        landing[0] = (i + 2) % 3
        landing[1], landing[2], where[0], where[1] = q_third, j, s_third, s
    else:
        landing[0] = (i + 1) % 3
        landing[1], landing[2], where[0], where[1] = k, q_third, u, s_third
    return LANDED


@compiled
def piece_of(space, i, j, k, x, y):
    """The piece that holds the third finger (x, y) and has a region in rectangle (i, j, k), or -1.

    The one it lies deepest in; on a diagonal either side will do.
    """
    best, deepest = -1, -space.touch
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    for c in range(len(space.ptr) - 1):
        worst = np.inf
        for slot in range(space.ptr[c], space.ptr[c + 1]):
            off = space.slot_nx[slot] * (x - space.slot_x[slot]) + space.slot_ny[slot] * (
                y - space.slot_y[slot]
            )
            worst = min(worst, off)
            if worst <= deepest:
                break
        if worst > deepest and region_corners(space, i, j, k, c, corners, spare) > 0:
            best, deepest = c, worst
    return best
