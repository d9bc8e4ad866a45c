"""A jam, and which jams count as the target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.checks import a_number
from icage.errors import InputError
from icage.hand import Placement
from icage.tolerance import NEAR_POSITION, NEAR_TURN
from icage.values import Value

_LARGEST_TURN = 0.5 * np.pi
"""[rad] A tolerance of the angle has to be smaller: a hand across the target is not near it."""


@dataclass(frozen=True, slots=True, eq=False)
class Jam(Value):
    """A hand at which contact forces within the cones balance although it squeezes.

    ``fingers`` (of 1, 2, 3) carry the forces, ``contacts`` (3, 2) are all finger centres, sigma
    is the hand's size; in the object's frame and unit.
    """

    fingers: tuple[int, ...]
    contacts: FloatArray
    sigma: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "contacts", read_only(np.array(self.contacts, dtype=np.float64)))

    @property
    def placement(self) -> Placement:
        """The jam as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)


@dataclass(frozen=True, slots=True)
class JamTolerance:
    """Which jams count as the target: those within both, in the object's frame.

    ``position``: how far the middle of the fingers is from its place at the target, [diameter];
    ``angle``: how far the hand is turned, [rad].
    """

    position: float = NEAR_POSITION
    angle: float = NEAR_TURN

    def __post_init__(self) -> None:
        position = a_number(self.position, "the tolerance of the position")
        angle = a_number(self.angle, "the tolerance of the angle")
        if not 0.0 <= position <= 1.0:
            raise InputError(
                f"the tolerance of the position is {position:g} diameters; 0 to 1 is allowed"
            )
        if not 0.0 <= angle < _LARGEST_TURN:
            raise InputError(
                f"the tolerance of the angle is {angle:g} rad; 0 to less than "
                f"{_LARGEST_TURN:.4g} rad (a quarter turn) is allowed"
            )
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "angle", angle)
