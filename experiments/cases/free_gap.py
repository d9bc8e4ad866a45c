"""How much room the fingers of a hand leave each other on the object."""

from __future__ import annotations

from icage.cage import Cage


def free_gap(cage: Cage) -> float:
    """Least free gap between two fingers in the grasp, [unit]."""
    return cage.hand.least_gap([complex(cage.sigma_0)]) - 2.0 * cage.finger_radius
