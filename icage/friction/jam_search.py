"""Jams in the target's component of one cage, for point and for disc fingers."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.cells.work import CageWork
from icage.friction.contacts import contacts_of
from icage.friction.disc_jams import NO_GOAL, DiscJams, disc_jams
from icage.friction.jam import Jam, JamTolerance
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal
from icage.friction.kernels.jams import LeastJam, least_jam
from icage.geometry.near_frame import NearFrame
from icage.tolerance import JAM_THICK, LEVEL

if TYPE_CHECKING:
    from icage.cage import Cage

_FINE = 1e-12
"""[diameter] How far the cover of the tolerance's outside may cut into it."""


class JamSearch:
    """The jams of one cage below its first level.

    ``known`` [unit] is the level below which the cells hold all of the component: sigma_first, or
    just below; inf if there is no such level.
    """

    def __init__(self, cage: Cage, work: CageWork, subsets: BoolArray | None = None) -> None:
        """``subsets`` (k, fingers): only jams in which the fingers of one of these touch."""
        self._cage = cage
        self._work = work if subsets is None else replace(work, remembered={})
        every = touching_subsets(len(work.search.free_space.z))
        self._subsets = every if subsets is None else subsets
        self._discs: DiscJams | None = None
        if cage.finger_radius > 0.0:
            self._discs = disc_jams(cage, self._work, self.near(JamTolerance()), self._subsets)
            self.known = self._discs.known
        else:
            # at sigma_first itself the search goes on into other basins, and the puncture is an
            # equilibrium
            first = np.inf if cage.sigma_first is None else cage.sigma_first
            self.known = float(first * (1.0 - 2.0 * LEVEL))

    @property
    def sigma_0(self) -> float:
        """[unit] Of the target."""
        return self._cage.sigma_0

    def near(self, tolerance: JamTolerance) -> Near:
        """The hands that count as the target, in the frame of the pieces."""
        return self.within(tolerance.position, tolerance.angle)

    def within(self, position: float, angle: float) -> Near:
        """The same for any position [diameter] and angle [rad]; inf: whatever it is."""
        cage, free_space = self._cage, self._work.search.free_space
        size = cage.outline.diameter  # a grown polygon has a larger one
        fingers = NearFrame.of(cage.outline).into(cage.contacts) - free_space.origin
        at, ahead = fingers.mean(axis=0), fingers[1] - fingers[0]
        ahead = ahead / np.hypot(ahead[0], ahead[1])
        mid = free_space.z.mean(axis=0)
        return Near(
            float(at[0]), float(at[1]), position * size, float(ahead[0]), float(ahead[1]), angle,
            float(mid[0]), float(mid[1]), _FINE * size,
        )  # fmt: skip

    def least(self, mu: float, near: Near, below: float) -> LeastJam:
        """The least jam that is not ``near``, if it is under ``below`` [unit]."""
        if self._discs is not None:
            return self._discs.least(mu, near, below)
        return self._of_points(mu, near, NO_GOAL, below)

    def nearest(self, mu: float, contacts: FloatArray) -> tuple[float, Jam | None]:
        """The jam whose fingers are nearest to ``contacts`` (fingers, 2), near the target or not,
        and the distance of the farthest of them [unit]; inf and None if there is none.
        """
        free_space = self._work.search.free_space
        fingers = NearFrame.of(self._cage.outline).into(contacts) - free_space.origin
        goal = Goal(np.ascontiguousarray(fingers), self.known, True)
        near = self.within(0.0, 0.0)
        if self._discs is not None:
            found = self._discs.nearest(mu, near, goal)
        else:
            found = self._of_points(mu, near, goal, np.inf)
        if not np.isfinite(found.sigma):
            return np.inf, None
        size = float(np.hypot(found.hand[2], found.hand[3]))
        return float(found.sigma), self.jam(found._replace(sigma=size))

    def _of_points(self, mu: float, near: Near, goal: Goal, below: float) -> LeastJam:
        found = self._work.search
        free_space = found.free_space
        inside = int(np.searchsorted(found.node_level, self.known))
        return least_jam(
            free_space.pieces, free_space.z, np.ascontiguousarray(found.cells[:inside]),
            np.ascontiguousarray(found.node_level[:inside]), contacts_of(free_space.pieces, mu),
            self._subsets, near, goal, below, JAM_THICK * free_space.pieces.diameter,
        )  # fmt: skip

    def jam(self, least: LeastJam) -> Jam:
        """What a kernel has found, in the object's frame."""
        free_space = self._work.search.free_space
        d_x, d_y, w_x, w_y = least.hand.tolist()
        hand = complex(d_x, d_y) + complex(w_x, w_y) * free_space.hand.z
        fingers = np.column_stack([hand.real, hand.imag]) + free_space.origin
        touching = tuple((np.flatnonzero(least.touches) + 1).tolist())
        return Jam(touching, NearFrame.of(self._cage.outline).back(fingers), float(least.sigma))


def touching_subsets(fingers: int) -> BoolArray:
    """(k, fingers) every way in which two fingers or more touch, the fewest first."""
    rows = [row for row in product((True, False), repeat=fingers) if sum(row) >= 2]
    return np.array(sorted(rows, key=sum), dtype=np.bool_)
