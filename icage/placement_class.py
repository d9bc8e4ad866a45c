"""What a query says of a placement, by name and by code. [docs/formats.md, icage query]"""

from __future__ import annotations

from enum import IntEnum, StrEnum


class PlacementClass(StrEnum):
    """What is in the component of a placement, at the placement's own sigma."""

    TARGET = "target"
    """The target and nothing else: closing can end only there."""
    CAGED = "caged"
    """The target and other grasps, and no way out."""
    OTHER = "other"
    """No way out, and not the target."""
    ESCAPES = "escapes"
    """A pinched hand: the object can leave."""
    COLLISION = "collision"
    """A finger stands inside the object."""


class PlacementCode(IntEnum):
    """The classes as numbers, for arrays; below ``ESCAPES`` the object is caged."""

    TARGET = 0
    CAGED = 1
    OTHER = 2
    ESCAPES = 3
    COLLISION = 4

    @property
    def placement_class(self) -> PlacementClass:
        """The class by its name.

        >>> PlacementCode(1).placement_class
        <PlacementClass.CAGED: 'caged'>
        """
        return tuple(PlacementClass)[self.value]
