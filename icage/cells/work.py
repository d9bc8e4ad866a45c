"""What the cells' search left behind of a cage: read by queries, regions and pictures."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import Search, Tree
from icage.cells.kernels.columns import (
    BIRTH_SIGMA,
    BIRTH_WX,
    BIRTH_WY,
    BORN_FINGER,
    BORN_SLOT,
)
from icage.cells.kernels.region import least_points
from icage.errors import MethodError
from icage.tolerance import LEVEL

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
    """Where the cage has the levels of the true curve: what the polygon searched joins to the
    target below this level, [unit], is the target's to the true curve, too."""
    remembered: dict[str, object] = field(default_factory=dict[str, object])
    """Point location and escape levels, built when first asked for (see membership)."""

    def below_first(self, sigma_first: float | None) -> tuple[IntArray, FloatArray]:
        """Nodes (n,) of the target's component below sigma_first [unit], and their levels (n,).

        A node's level [unit] is that from which on it has hands of the component.
        """
        first = np.inf if sigma_first is None else sigma_first
        own = first if self.polygon_first is None else min(first, self.polygon_first)
        birth = self.tree.birth[:, BIRTH_SIGMA]
        level = np.maximum(birth, self.search.node_level[: len(birth)])
        nodes = np.flatnonzero((birth > 0.0) & (level < own * (1.0 - LEVEL)))
        return nodes, level[nodes]

    def least_hands(self, below: float) -> FloatArray:
        """(n, 3, 2) fingers at the least points of the visited cells born below a level, [unit]."""
        birth = self.tree.birth[:, BIRTH_SIGMA]
        return self.least_hands_of(np.flatnonzero((birth > 0.0) & (birth < below)))

    def least_hands_of(self, nodes: IntArray) -> FloatArray:
        """(n, 3, 2) fingers at the least points of nodes (n,) that are no pinched hands."""
        found, tree = self.search, self.tree
        if not len(nodes):
            return np.empty((0, len(found.free_space.z), 2))
        free_space = found.free_space
        low, at = tree.birth[nodes], tree.birth_at[nodes]
        points = least_points(
            free_space.pieces, free_space.z, 0, np.ascontiguousarray(found.cells[nodes]),
            low[:, BIRTH_WX], low[:, BIRTH_WY], at[:, BORN_FINGER], at[:, BORN_SLOT],
        )  # fmt: skip
        d = points[:, 0] + 1j * points[:, 1]
        w = low[:, BIRTH_WX] + 1j * low[:, BIRTH_WY]
        hands = d[:, None] + w[:, None] * free_space.hand.z
        return np.stack([hands.real, hands.imag], axis=2) + free_space.origin


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
