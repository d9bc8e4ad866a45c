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
from icage.friction.kernels.jams import LeastJam
from icage.geometry.exterior import Pieces
from icage.geometry.near_frame import NearFrame
from icage.tolerance import COLLISION, LEVEL

if TYPE_CHECKING:
    from icage.cage import Cage

_THICK = 0.5 * COLLISION
"""[diameter] A finger this close to a feature may push there, and be this deep in the object:
above what the polygon's dropped vertices leave, below what a query calls a collision."""


@dataclass(frozen=True, slots=True)
class DiscJams:
    """All ways in which fingers may stand in the target's component, outside a tolerance."""

    pieces: Pieces
    z: FloatArray
    cells: IntArray
    contacts: DiscContacts
    subsets: BoolArray
    near: Near
    known: float
    """[unit] Below it the component lies in the cells; inf if however far the hand opens."""
    choices: Choices
    bounds: dict[float, FloatArray] = field(default_factory=dict[float, FloatArray])
    """[rad] -> (k,) bounds of the choices for that angle of friction; they never rise with it."""

    def least(self, mu: float, below: float) -> LeastJam:
        """The least far jam for a coefficient of friction, if it is under ``below`` [unit]."""
        phi = math.atan(mu)
        larger = [angle for angle in self.bounds if angle >= phi]
        choices = self.choices
        if larger:
            choices = choices._replace(bound=self.bounds[min(larger)])
        # all that may be asked for: bounds are kept for smaller coefficients
        bound = bounds_of(
            self.pieces, self.z, self.cells, self.contacts, self.subsets, choices, self.near, phi,
            self.known, self._thick,
        )  # fmt: skip
        self.bounds[phi] = bound
        order = np.argsort(bound, kind="stable")
        return least_disc_jam(
            self.pieces, self.z, self.cells, self.contacts, self.subsets, choices, bound, order,
            self.near, phi, below, self._thick,
        )  # fmt: skip

    @property
    def _thick(self) -> float:
        return _THICK * self.pieces.diameter


def disc_jams(cage: Cage, work: CageWork, near: Near, subsets: BoolArray) -> DiscJams:
    """The same for one tolerance; remembered.

    Raises
    ------
    GeometryError:
        The object has no true curve for this radius.
    """
    key = f"disc jams {near}"
    found = work.remembered.get(key)
    if isinstance(found, DiscJams):
        return found
    search = work.search
    free_space = search.free_space
    first = np.inf if cage.sigma_first is None else cage.sigma_first * (1.0 - 2.0 * LEVEL)
    known = min(first, search.level)
    inside = int(np.searchsorted(search.node_level, known))
    outline = NearFrame.of(cage.outline).outline_into(cage.outline)
    curve = TrueCurve.of(outline, cage.finger_radius)
    contacts = disc_contacts(curve, free_space.pieces, free_space.origin)
    cells = np.ascontiguousarray(search.cells[:inside])
    thick = _THICK * free_space.pieces.diameter
    choices = possible_choices(
        free_space.pieces, free_space.z, cells, np.ascontiguousarray(search.node_level[:inside]),
        contacts, subsets, near, known, thick,
    )  # fmt: skip
    jams = DiscJams(free_space.pieces, free_space.z, cells, contacts, subsets, near, known, choices)
    work.remembered[key] = jams
    return jams
