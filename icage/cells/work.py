"""What the cells' search left behind of a cage: read by queries, regions and pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from icage.cells.free_space import Search, Tree
from icage.errors import MethodError

if TYPE_CHECKING:
    from icage.cage import Cage


@dataclass(frozen=True, slots=True)
class CageWork:
    """Search and merge tree of one cage: internal to the planner.

    It lies in the frame near the object (``icage.geometry.near_frame``), not in the object's own.
    """

    search: Search
    tree: Tree
    minimum_node: tuple[int, ...]
    """Node of each grasp, by id."""
    sagitta: float = 0.0
    """How far the polygon searched may lie inside the true offset, [unit] (0 for points)."""
    polygon_first: float | None = None
    """The polygon's own level of the puncture at sigma_first, [unit], where the cage has the levels
    of the true curve: what it joins below that is the target's to the true curve."""
    remembered: dict[str, object] = field(default_factory=dict[str, object])
    """Point location and escape levels, built when first asked for (see membership)."""


def work_of(cage: Cage) -> CageWork | None:
    """What the search left; None for what is not a cage.

    Raises
    ------
    MethodError:
        The cage was planned by the contact space, which answers no questions about placements.
    """
    if cage.work is None and cage.status != "not_a_cage":
        raise MethodError(
            "this cage was planned by the contact space, which answers no queries and draws no "
            "regions; plan it by the cells (method='cells') and ask that cage"
        )
    return cage.work
