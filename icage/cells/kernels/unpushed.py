"""How much of the motor's pull the object itself does not balance at the least hand of a cell.

Nothing of it: the hand is at rest, whatever lies beyond the edges that pieces share. Our own.
"""

# pyright: basic
from __future__ import annotations

import math

import numpy as np

from icage.geometry.kernels.pieces import WALL
from icage.kernels.compiled import compiled
from icage.kernels.forces import pushing_of
from icage.tolerance import SAME_POINT

_MOST = 64
"""Edges that all fingers together touch; a finger of a piece touches two, and two at a vertex."""

_TO_ONE_SIDE = 0.3
"""[1] Sine of the least angle between normals that are taken to push to one side: above any share
that is asked for, those of chords in place of arcs among them."""


@compiled
def _put(slots, count, slot):
    """Add a slot to those that a finger touches, if it is not among them; how many."""
    for k in range(count):
        if slots[k] == slot:
            return count
    if count < len(slots):
        slots[count] = slot
        count += 1
    return count


@compiled
def _to_one_side(columns, count):
    """Whether normals (columns 0 and 1) all push to one side: no forces along them balance."""
    for i in range(count):
        first = True
        for j in range(count):
            cross = columns[0, i] * columns[1, j] - columns[1, i] * columns[0, j]
            if j != i and cross <= _TO_ONE_SIDE:
                first = False
                break
        if first:
            return True
    return False


@compiled
def unpushed(pieces, z, cells, hands, ends_at, begins_at):
    """Share (n,) of the motor's pull that pushes hands (n, 4) on past what their fingers touch.

    A finger of a cell touches the edges of the object that its piece has there. Where it is in a
    corner that is hollow it touches both, whichever piece it is in: ``ends_at`` and ``begins_at``
    (vertices,) are the slots of the edges that meet in such a vertex, -1 at the others.
    """
    fingers = len(z)
    reach = SAME_POINT * pieces.diameter
    share = np.ones(len(cells))
    wanted = np.zeros(4)
    slots = np.empty(_MOST, np.int64)
    columns = np.empty((4, fingers * _MOST))
    for k in range(len(cells)):
        wx, wy = hands[k, 2], hands[k, 3]
        count = 0
        touching = 0
        for f in range(fingers):
            x = hands[k, 0] + wx * z[f, 0] - wy * z[f, 1]
            y = hands[k, 1] + wx * z[f, 1] + wy * z[f, 0]
            own = 0
            first, end = pieces.ptr[cells[k, f]], pieces.ptr[cells[k, f] + 1]
            for s in range(first, end):
                v = pieces.slot_vertex[s]
                ax, ay = x - pieces.x[v], y - pieces.y[v]
                if pieces.slot_neighbour[s] == WALL:
                    nx, ny = pieces.normal_x[s], pieces.normal_y[s]
                    b = pieces.slot_vertex[s + 1 if s + 1 < end else first]
                    # within its ends: another edge of the piece may lie on the same line
                    along = ny * ax - nx * ay
                    past_end = ny * (x - pieces.x[b]) - nx * (y - pieces.y[b])
                    if abs(nx * ax + ny * ay) <= reach and -reach <= along and past_end <= reach:
                        own = _put(slots, own, s)
                if ends_at[v] >= 0 and math.hypot(ax, ay) <= reach:
                    own = _put(slots, own, ends_at[v])
                    own = _put(slots, own, begins_at[v])
            touching += own > 0
            for s in slots[:own]:
                nx, ny = pieces.normal_x[s], pieces.normal_y[s]
                columns[0, count], columns[1, count] = nx, ny
                columns[2, count] = nx * z[f, 0] + ny * z[f, 1]
                columns[3, count] = ny * z[f, 0] - nx * z[f, 1]
                count += 1
        if touching < 2 or _to_one_side(columns, count):
            continue
        wanted[2], wanted[3] = wx, wy
        pushed = pushing_of(np.ascontiguousarray(columns[:, :count]), wanted)
        share[k] = pushed.miss / math.hypot(wx, wy)
    return share
