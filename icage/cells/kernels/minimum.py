"""The local minima of sigma next to given contacts, from the least points of the cells round them.

Each cell that holds a local minimum has it as its own least point (sigma is convex on a cell), so
being a local minimum is decided by the few cells round the contacts, with no descent. Our own.
"""

# pyright: basic
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BIRTH_WY,
    BORN_FINGER,
    BORN_SLOT,
    NEAR_DX,
    NEAR_DY,
    NEAR_MOVED,
    NEAR_SIGMA,
    NEAR_TURNED,
    NEAR_WX,
    NEAR_WY,
)
from icage.cells.kernels.facet import ends_on_facet
from icage.cells.kernels.near import Hand, cells_near
from icage.cells.kernels.plateau import Plateau, plateau_through, slid_further, translations
from icage.cells.kernels.tree import births
from icage.kernels.compiled import compiled
from icage.kernels.storage import stable_order
from icage.tolerance import DEPTH_CUT, SAME_POINT

MOST_CELLS = 2_000_000
"""Cells round a target that fit into 200 MB; a vertex of a fine fan has some tens of pieces."""


class Nearest(NamedTuple):
    """The local minimum nearest to a configuration.

    Attributes
    ----------
    row:
        Its row in ``near``, -1 for none.
    plateau:
        The translations through it.
    near:
        (n, 7) least points of cells within reach, by sigma; columns in ``cells.kernels.columns``.
    cells:
        (n, fingers) the cell of each.
    total:
        How many cells meet round the contacts; none was looked at if there are too many.
    """

    row: int
    plateau: Plateau
    near: np.ndarray
    cells: np.ndarray
    total: int


@compiled
def _shift(z, ax, ay, awx, awy, b):
    """Largest distance that a finger moves between two configurations."""
    most = 0.0
    for f in range(len(z)):
        vx, vy = b.w_x - awx, b.w_y - awy
        x = b.d_x - ax + vx * z[f, 0] - vy * z[f, 1]
        y = b.d_y - ay + vx * z[f, 1] + vy * z[f, 0]
        most = max(most, np.hypot(x, y))
    return most


@compiled
def _turn(awx, awy, b):
    """Angle between two configurations, [rad]."""
    if (awx == 0.0 and awy == 0.0) or (b.w_x == 0.0 and b.w_y == 0.0):
        return 0.0
    return abs(math.atan2(b.w_y * awx - b.w_x * awy, b.w_x * awx + b.w_y * awy))


@compiled
def _nearest_on(ax, ay, bx, by, wx, wy):
    """The point of the segment from a to b that is nearest to w."""
    sx, sy = bx - ax, by - ay
    length = np.hypot(sx, sy)
    if length == 0.0:
        return ax, ay
    t = ((wx - ax) * sx + (wy - ay) * sy) / (length * length)
    t = min(1.0, max(0.0, t))
    return ax + t * sx, ay + t * sy


@compiled
def _slid_to(pieces, z, cell, hx, hy, wx, wy, to):
    """The translation of a hand inside its cell that is nearest to the wanted configuration."""
    corners = translations(pieces, z, cell, wx, wy)
    if len(corners) == 0:
        return hx, hy
    far = 0
    for k in range(len(corners)):
        if np.hypot(corners[k, 0] - hx, corners[k, 1] - hy) > np.hypot(
            corners[far, 0] - hx, corners[far, 1] - hy
        ):
            far = k
    back = 0
    for k in range(len(corners)):
        if np.hypot(corners[k, 0] - corners[far, 0], corners[k, 1] - corners[far, 1]) > (
            np.hypot(corners[back, 0] - corners[far, 0], corners[back, 1] - corners[far, 1])
        ):
            back = k
    return _nearest_on(
        corners[far, 0], corners[far, 1], corners[back, 0], corners[back, 1], to.d_x, to.d_y
    )


@compiled
def _least_round(pieces, z, here, sigma, cap, worst):
    """The cells (n, fingers) round a configuration and their least sigma (n,).

    And whether none goes deeper by more than the depth cut, nor are there too many to be looked at.
    """
    size = pieces.diameter
    cells, total = cells_near(pieces, z, here, SAME_POINT * size, MOST_CELLS)
    low = births(pieces, z, cells, cap, worst).value[:, BIRTH_SIGMA]
    for k in range(len(low)):
        if low[k] < sigma - DEPTH_CUT * size:
            return cells, low, False
    return cells, low, total <= MOST_CELLS


@compiled
def is_local_minimum(pieces, z, here, sigma, cap, worst):
    """Whether no cell round the configuration goes deeper by more than the depth cut."""
    return _least_round(pieces, z, here, sigma, cap, worst)[2]


@compiled
def is_strict_minimum(pieces, z, here, sigma, cap, worst):
    """Whether besides no translation at constant sigma leads away: ``plateau_through`` is a point.

    Were there a plateau, already its first step would lead further off.
    """
    cells, low, is_minimum = _least_round(pieces, z, here, sigma, cap, worst)
    if not is_minimum:
        return False
    at = np.array([here.d_x, here.d_y])
    return not slid_further(pieces, z, here, at, at, cells, low, sigma)[2]


@compiled
def nearest_minimum(pieces, z, wanted, reach, turn, cap, worst, most):
    """The local minimum nearest to a configuration, if there is one within ``reach``.

    ``reach`` [diameter] bounds how far a finger may be from where it was asked to be, ``turn``
    [rad] the angle. That a minimum is too shallow to count is left to the caller, who searches from
    it anyway. Nothing is looked at where more than ``most`` cells meet round the contacts.
    """
    size = pieces.diameter
    nowhere = Plateau(False, 0.0, 0.0, 0.0, 0.0)
    cells, total = cells_near(pieces, z, wanted, reach * size, most)
    near = np.empty((len(cells), 7))
    kept = np.empty(len(cells), np.int64)
    if total > most:
        return Nearest(-1, nowhere, near, cells, total)
    low = births(pieces, z, cells, cap, worst)
    count = 0
    best = -1
    plateau = nowhere
    for k in stable_order(low.value[:, BIRTH_SIGMA].copy()):
        sigma = low.value[k, BIRTH_SIGMA]
        if not 0.0 < sigma < np.inf:
            continue
        wx, wy = low.value[k, BIRTH_WX], low.value[k, BIRTH_WY]
        finger = low.where[k, BORN_FINGER]
        ends = ends_on_facet(pieces, z, cells[k], finger, low.where[k, BORN_SLOT], wx, wy)
        fx = wx * z[finger, 0] - wy * z[finger, 1]
        fy = wx * z[finger, 1] + wy * z[finger, 0]
        dx, dy = _nearest_on(
            ends.x_lo - fx, ends.y_lo - fy, ends.x_hi - fx, ends.y_hi - fy, wanted.d_x, wanted.d_y
        )
        if (
            np.hypot(wx - wanted.w_x, wy - wanted.w_y)
            <= reach * size
            < np.hypot(dx - wanted.d_x, dy - wanted.d_y)
        ):
            # the same hand elsewhere: perhaps on a plateau that runs through where it should be
            dx, dy = _slid_to(pieces, z, cells[k], dx, dy, wx, wy, wanted)
        here = Hand(dx, dy, wx, wy)
        moved = _shift(z, wanted.d_x, wanted.d_y, wanted.w_x, wanted.w_y, here) / size
        turned = _turn(wanted.w_x, wanted.w_y, here)
        if moved > reach or turned > turn:
            continue
        at = count
        kept[at] = k
        near[at, NEAR_DX], near[at, NEAR_DY] = dx, dy
        near[at, NEAR_WX], near[at, NEAR_WY] = wx, wy
        near[at, NEAR_SIGMA] = sigma
        near[at, NEAR_MOVED], near[at, NEAR_TURNED] = moved, turned
        count += 1
        # hundreds of cells may meet in one point, as at the centre of an arc: it is looked at once
        if best >= 0 and moved >= near[best, NEAR_MOVED] - SAME_POINT:
            continue
        if not is_local_minimum(pieces, z, here, sigma, cap, worst):
            continue
        best = at
        plateau = plateau_through(pieces, z, here, sigma, cap, worst, MOST_CELLS)
    return Nearest(best, plateau, near[:count], cells[kept[:count]], total)
