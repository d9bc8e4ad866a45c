"""What a method has to answer about one target on one polygon.

Two methods do, cells and contact space, and disc fingers are built on either.
"""

from __future__ import annotations

from typing import Protocol

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.hand import HandShape
from icage.outline import Outline


class LocalCage(Protocol):
    """A strict minimum on one polygon, and the levels round it."""

    @property
    def sigma_max(self) -> float:
        """Escape level, [unit]; inf if there is none."""
        ...

    @property
    def sigma_first(self) -> float:
        """First level, [unit]; the escape level if no other minimum comes before it."""
        ...

    def cage(
        self, contacts: FloatArray, outline: Outline, radius: float, *, way: bool = True
    ) -> Cage:
        """The cage on this polygon, of an outline and a radius that it stands for.

        Without ``way`` it need not have an escape path.
        """
        ...

    def escape_path(self) -> tuple[FloatArray, float] | None:
        """Placements (k, 4) to a pinched hand and the least finger gap on them, or None."""
        ...


class Method(Protocol):
    """A method of computing cages of point fingers."""

    @property
    def complete(self) -> bool:
        """Whether no connection is missed. Only then does sigma_max grow with the obstacle."""
        ...

    def cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, outline: Outline,
        radius: float,
    ) -> Cage:  # fmt: skip
        """The cage of the contacts on a polygon that stands for an outline and a radius."""
        ...

    def local_cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, reach: float, turn: float
    ) -> LocalCage | None:
        """The strict minimum within ``reach`` [diameter] and ``turn`` [rad], or None."""
        ...
