"""Which grasps are looked for, and a grasp that was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from icage.arrays import FloatArray
from icage.hand import HandShape

Aim: TypeAlias = Literal["first", "cage"]
"""What is ranked: sigma_first / sigma_0, or sigma_max / sigma_0."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which grasps are looked for.

    ``aim`` is what is ranked; ``corners`` the least number of fingers in concave corners (three
    straight edges are of second-order immobility only); ``near`` = (phi_1, phi_2, within), [rad],
    keeps to hands of about one shape, read from any finger.
    """

    aim: Aim = "first"
    corners: int = 0
    near: tuple[float, float, float] | None = None

    def shape_error(self, hand: HandShape) -> FloatArray:
        """Difference (phi_1, phi_2) from the wanted shape in the best of the three readings."""
        if self.near is None:
            return np.zeros(2)
        phis = np.array([hand.relabelled(first).phi for first in range(3)])
        errors = phis - np.array(self.near[:2])
        return errors[int(np.argmin(np.abs(errors).max(axis=1)))]

    def allows(self, hand: HandShape) -> bool:
        """Whether the hand has about the wanted shape."""
        if self.near is None:
            return True
        return bool(np.abs(self.shape_error(hand)).max() <= self.near[2])


@dataclass(frozen=True, slots=True)
class Candidate:
    """A grasp and its levels as found on the polygon that was searched, [unit]."""

    contacts: FloatArray
    triple: tuple[int, int, int]
    """Contact features (see Features), counterclockwise."""
    sigma_0: float
    sigma_first: float
    sigma_max: float
    score: float
