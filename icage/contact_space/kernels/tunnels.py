"""All tunnel edges of a hand at once, so that a search can take them in either direction. Our own.

A tunnel edge joins a minimum v of contact space that is none of free space to a region below it.
[Bunis2018, Sec. V-B] adds it when the search closes v; a search that comes from *below* never
learns of it, although the hand may open along it just as well. Then basins, and in rare cases the
escape, are met too late. The minima in question need two contacts only, with the third finger
free: so they are local minima of the distance between two edges, whatever the hand, and O(n^2)
pairs of edges tell all candidates. With both directions contact space and free space have the same
sublevels. [Bunis2018, Def. 9, Lemma 4.3]
"""

# pyright: basic
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.contact_space.kernels.columns import HAND_LEVEL, TUNNEL_KEPT
from icage.contact_space.kernels.explore import configuration
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    finger_at,
    least_of_region,
    region_corners,
    scale_at,
    seam_value,
    third_finger,
)
from icage.contact_space.kernels.shooting import (
    LANDED,
    NO_TUNNEL,
    may_leave,
    piece_of,
    shoot,
    touches,
)
from icage.kernels.compiled import compiled
from icage.kernels.storage import longer

_LOWER = 1e-3
"""[tie] A distance falls on across a side if it is lower by this: above the rounding of the same
corner seen from two rectangles."""


class Tunnels(NamedTuple):
    """All tunnel edges of a hand.

    rows (t, 9) = region above, region below (-1: a pinch), finger kept; hands (t, 9) = level, hand
    above, hand below.
    """

    rows: np.ndarray
    hands: np.ndarray


@compiled
def rectangle_minima(space):
    """Least distance (n, n) of every two edges, and both ends (n, n, 4) of where it is attained."""
    n = len(space.edge_x)
    low, at = np.empty((n, n)), np.empty((n, n, 4))
    corners = np.empty((4, 2))
    for j in range(n):
        for k in range(n):
            corners[0, 0], corners[0, 1] = 0.0, 0.0
            corners[1, 0], corners[1, 1] = space.edge_length[j], 0.0
            corners[2, 0], corners[2, 1] = space.edge_length[j], space.edge_length[k]
            corners[3, 0], corners[3, 1] = 0.0, space.edge_length[k]
            least, s, u, s_too, u_too = least_of_region(space, 0, j, k, corners, 4)
            low[j, k] = least / space.rho[0]
            at[j, k, 0], at[j, k, 1], at[j, k, 2], at[j, k, 3] = s, u, s_too, u_too
    return low, at


@compiled
def lower_beside(space, low, at, j, k):
    """Whether the distance falls on across a side of rectangle (j, k) that holds its minimum."""
    n = len(low)
    s, u = at[j, k, 0], at[j, k, 1]
    bound = low[j, k] - _LOWER * space.tie
    if s <= space.clip and low[(j - 1) % n, k] < bound:
        return True
    if u <= space.clip and low[j, (k - 1) % n] < bound:
        return True
    if s >= space.edge_length[j] - space.clip and low[(j + 1) % n, k] < bound:
        return True
    return u >= space.edge_length[k] - space.clip and low[j, (k + 1) % n] < bound


@compiled
def is_lowest(space, i, j, k, c, low, corners, count):
    """Whether no seam at the level of a region's least node leads to a deeper region."""
    out = np.empty((2, 4), np.int64)
    other, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    for label in range(FIRST_SLOT + space.ptr[c + 1] - space.ptr[c]):
        value, _, _ = seam_value(space, i, j, k, c, label, corners, count)
        if value > low + space.tie:
            continue
        for a in range(across(space, i, j, k, c, label, out)):
            many = region_corners(space, out[a, 0], out[a, 1], out[a, 2], out[a, 3], other, spare)
            if many == 0:
                continue
            least = least_of_region(space, out[a, 0], out[a, 1], out[a, 2], other, many)
            if least.sigma < low - space.tie:
                return False
    return True


@compiled
def holds(space, c, x, y):
    """Whether a point is in piece c."""
    for slot in range(space.ptr[c], space.ptr[c + 1]):
        if (
            space.slot_nx[slot] * (x - space.slot_x[slot])
            + space.slot_ny[slot] * (y - space.slot_y[slot])
            < -space.clip
        ):
            return False
    return True


@compiled
def find_tunnel(space, region, s, u, target, where):
    """The tunnel edge of a least node: NO_TUNNEL, PINCHED or LANDED, and the finger kept.

    Landed: ``target`` (4,) is the region, ``where`` (4,) as of ``shoot``.
    """
    i, j, k = region[0], region[1], region[2]
    for keep in range(2):
        ended = shoot(space, i, j, k, s, u, keep, target, where)
        if ended == LANDED:
            target[3] = piece_of(space, target[0], target[1], target[2], where[2], where[3])
            if target[3] < 0:
                continue
        if ended != NO_TUNNEL:
            return ended, keep
    return NO_TUNNEL, 0


@compiled
def _one_may_leave(space, j, k, s, u):
    """Whether either finger of a pair may move straight at the other."""
    x1, y1 = finger_at(space, j, s)
    x2, y2 = finger_at(space, k, u)
    return (
        may_leave(space, j, s, x2 - x1, y2 - y1)[0] or may_leave(space, k, u, x1 - x2, y1 - y2)[0]
    )


@compiled
def all_tunnels(space):
    """All tunnel edges. O(n^2) distances, then O(n) for each of the few candidates."""
    ints, floats = np.empty((64, 9), np.int64), np.empty((64, 9))
    corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    target, where = np.empty(4, np.int64), np.empty(4)
    region = np.empty(4, np.int64)
    n, m = len(space.edge_x), len(space.ptr) - 1
    low, at = rectangle_minima(space)
    t = 0
    for j in range(n):
        for k in range(n):
            if low[j, k] <= space.pinch:
                continue
            a = at[j, k]
            valley = abs(a[0] - a[2]) + abs(a[1] - a[3]) > space.clip
            if not valley and lower_beside(space, low, at, j, k):
                continue
            if not _one_may_leave(space, j, k, a[0], a[1]):
                continue  # a grasp of two fingers
            for i in range(3):
                x, y = third_finger(space, i, j, k, a[0], a[1])
                if not valley and touches(space, x, y):
                    continue
                for c in range(m):
                    if not valley and not holds(space, c, x, y):
                        continue
                    count = region_corners(space, i, j, k, c, corners, spare)
                    if count == 0:
                        continue
                    least, s, u, s_too, u_too = least_of_region(space, i, j, k, corners, count)
                    # of a valley, only the part that the third finger leaves free
                    if least > space.rho[i] * low[j, k] + space.tie:
                        continue
                    s, u = 0.5 * (s + s_too), 0.5 * (u + u_too)
                    x, y = third_finger(space, i, j, k, s, u)
                    if valley and (
                        touches(space, x, y)
                        or not is_lowest(space, i, j, k, c, least, corners, count)
                    ):
                        continue
                    region[0], region[1], region[2], region[3] = i, j, k, c
                    ended, keep = find_tunnel(space, region, s, u, target, where)
                    if ended == NO_TUNNEL:
                        continue
                    if t == len(ints):
                        ints, floats = longer(ints), longer(floats)
                    for b in range(4):
                        ints[t, b], ints[t, 4 + b] = region[b], -1
                        floats[t, 5 + b] = 0.0
                    ints[t, TUNNEL_KEPT] = keep
                    floats[t, HAND_LEVEL] = scale_at(space, i, j, k, s, u)
                    configuration(space, i, j, k, s, u, floats[t], 1)
                    if ended == LANDED:
                        for b in range(4):
                            ints[t, 4 + b] = target[b]
                        configuration(
                            space, target[0], target[1], target[2], where[0], where[1],
                            floats[t], 5,
                        )  # fmt: skip
                    t += 1
                    if not valley:
                        break  # on a diagonal either side will do
    return Tunnels(ints[:t], floats[:t])
