"""The far jams of one cage of disc fingers: what does not depend on friction is found once.

The cells are those that the search has reached round an inner polygon, which leaves more room than
the true curve: what the target's component holds below a level lies in cells reached below it. So
no jam counts below the level at which its cell was reached, and none is missing. The features are
those of the true curve. [docs/theory.md, Sec. 10]
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cells.work import CageWork
from icage.discs.curve import TrueCurve
from icage.friction.disc_contacts import DiscContacts, disc_contacts
from icage.friction.kernels.disc_jams import (
    Choices,
    bounds_of,
    least_disc_jam,
    possible_choices,
)
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal
from icage.friction.kernels.jams import LeastJam
from icage.geometry.exterior import Pieces
from icage.geometry.near_frame import NearFrame
from icage.tolerance import COLLISION, LEVEL

if TYPE_CHECKING:
    from icage.cage import Cage

_THICK = 0.5 * COLLISION
"""[diameter] A finger this close to a feature may push there, and be this deep in the object:
above what the polygon's dropped vertices leave, below what a query calls a collision."""


NO_GOAL = Goal(np.zeros((0, 2)), np.inf, False)
"""For the least sigma."""

_EVERY_HAND = 0.0
"""Reach and turn of a tolerance that nothing is within."""


@dataclass(frozen=True, slots=True)
class DiscJams:
    """All ways in which fingers may stand in the target's component."""

    pieces: Pieces
    z: FloatArray
    cells: IntArray
    contacts: DiscContacts
    subsets: BoolArray
    known: float
    """[unit] Below it the component lies in the cells; inf if however far the hand opens."""
    choices: Choices
    bounds: dict[tuple[Near, float], FloatArray] = field(
        default_factory=dict[tuple[Near, float], FloatArray]
    )
    """(tolerance, [rad]) -> (k,) bounds of the choices for that angle of friction. They never rise
    with the angle."""

    def least(self, mu: float, near: Near, below: float) -> LeastJam:
        """The least jam outside a tolerance, if it is under ``below`` [unit]."""
        phi = math.atan(mu)
        return self._least(phi, near, NO_GOAL, below, self._bounds(phi, near, below))

    def nearest(self, mu: float, near: Near, goal: Goal) -> LeastJam:
        """The jam nearest to a goal; its distance in the place of sigma."""
        phi = math.atan(mu)
        bound = bounds_of(
            self.pieces, self.z, self.cells, self.contacts, self.subsets, self.choices, near, goal,
            phi, np.inf, self._thick,
        )  # fmt: skip
        return self._least(phi, near, goal, np.inf, bound)

    def _least(
        self, phi: float, near: Near, goal: Goal, below: float, bound: FloatArray
    ) -> LeastJam:
        return least_disc_jam(
            self.pieces, self.z, self.cells, self.contacts, self.subsets, self.choices, bound,
            np.argsort(bound, kind="stable"), near, goal, phi, below, self._thick,
        )  # fmt: skip

    def _bounds(self, phi: float, near: Near, below: float) -> FloatArray:
        """Bounds of the choices, from those for more friction; right where under ``below``."""
        larger = [angle for other, angle in self.bounds if other == near and angle >= phi]
        choices = self.choices
        if larger:
            choices = choices._replace(bound=self.bounds[near, min(larger)])
            if min(larger) == phi:
                return choices.bound
        bound = bounds_of(
            self.pieces, self.z, self.cells, self.contacts, self.subsets, choices, near,
            NO_GOAL, phi, below, self._thick,
        )  # fmt: skip
        # what is not under ``below`` may be for another question
        beyond = ~np.isfinite(bound)
        bound[beyond] = np.maximum(choices.bound[beyond], below)
        self.bounds[near, phi] = bound
        return bound

    @property
    def _thick(self) -> float:
        return _THICK * self.pieces.diameter


def disc_jams(cage: Cage, work: CageWork, near: Near, subsets: BoolArray) -> DiscJams:
    """What all questions about one cage share; remembered.

    Raises
    ------
    GeometryError:
        The object has no true curve for this radius.
    """
    found = work.remembered.get("disc jams")
    if isinstance(found, DiscJams):
        return found
    search = work.search
    free_space = search.free_space
    first = np.inf if cage.sigma_first is None else cage.sigma_first * (1.0 - 2.0 * LEVEL)
    # beyond its own first level the polygon's search goes on into other basins
    own = np.inf if work.polygon_first is None else work.polygon_first * (1.0 - 2.0 * LEVEL)
    known = min(first, own, search.level)
    inside = int(np.searchsorted(search.node_level, known))
    outline = NearFrame.of(cage.outline).outline_into(cage.outline)
    curve = TrueCurve.of(outline, cage.finger_radius)
    contacts = disc_contacts(curve, free_space.pieces, free_space.origin)
    cells = np.ascontiguousarray(search.cells[:inside])
    choices = possible_choices(
        free_space.pieces, free_space.z, cells, np.ascontiguousarray(search.node_level[:inside]),
        contacts, subsets, near._replace(reach=_EVERY_HAND, turn=_EVERY_HAND), NO_GOAL, known,
        _THICK * free_space.pieces.diameter,
    )  # fmt: skip
    jams = DiscJams(free_space.pieces, free_space.z, cells, contacts, subsets, known, choices)
    work.remembered["disc jams"] = jams
    return jams
