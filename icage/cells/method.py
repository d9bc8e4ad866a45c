"""The cells' method as an engine: cells, passes and merges of one target. [docs/decisions/0001]"""

from __future__ import annotations

from dataclasses import dataclass

from icage.arrays import FloatArray
from icage.cage import Cage, CageStatus, not_a_cage
from icage.cells.free_space import FreeSpace, Search, Tree, merge_tree, search
from icage.cells.largest_sigma import largest_sigma_in
from icage.cells.minima import (
    escape_path,
    first_joining,
    grasps_and_punctures,
    has_joinings_between,
)
from icage.cells.target import Target, contacts_as_configuration, find_target
from icage.cells.why_not import plateau_reason, why_not
from icage.cells.work import CageWork
from icage.errors import GeometryError
from icage.geometry.statics import ISOLATED, no_depth_reason
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT, DEPTH_FINE, DEPTH_ROUGH, NOT_A_CAGE


@dataclass(frozen=True, slots=True)
class CellsLocalCage:
    """A target on one polygon and the search from it. See ``icage.method.Look``."""

    target: Target
    found: Search

    @property
    def sigma_max(self) -> float:
        """Escape level, inf if there is none."""
        return self.found.level

    @property
    def sigma_first(self) -> float:
        """First level."""
        return self.found.sigma_first()

    def cage(
        self, contacts: FloatArray, outline: Outline, radius: float, *, way: bool = True
    ) -> Cage:
        """The cage on this polygon."""
        space = self.found.free_space
        return cage_on(space, contacts, self.target, outline, radius, self.found, way=way)

    def escape_path(self) -> tuple[FloatArray, float] | None:
        """Placements to a pinched hand and the least finger gap, or None."""
        return escape_path(self.found, self.target) if self.found.escaped else None


class Cells:
    """The engine behind ``plan``. See ``icage.method.Method``."""

    @property
    def complete(self) -> bool:
        """No connection is missed."""
        return True

    def cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, outline: Outline,
        radius: float,
    ) -> Cage:  # fmt: skip
        """The cage of point fingers on a polygon, or why there is none."""
        free_space = FreeSpace.around(polygon, hand)
        target = find_target(free_space, contacts_as_configuration(free_space, contacts))
        return cage_on(free_space, contacts, target, outline, radius)

    def local_cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, reach: float, turn: float
    ) -> CellsLocalCage | None:
        """The strict minimum nearest to the contacts and what surrounds it, or None."""
        free_space = FreeSpace.around(polygon, hand)
        wanted = contacts_as_configuration(free_space, contacts)
        target = find_target(free_space, wanted, reach=reach, turn=turn)
        if target is None or target.plateau is not None:
            return None
        found = search(free_space, target.cell, target.sigma_0)
        if found.gave_up:
            raise GeometryError(f"the search gave up after {len(found.nodes)} cells")
        return CellsLocalCage(target, found)


CELLS = Cells()


def cage_on(
    free_space: FreeSpace,
    contacts: FloatArray,
    target: Target | None,
    outline: Outline,
    radius: float = 0.0,
    known: Search | None = None,
    *,
    way: bool = True,
) -> Cage:
    """The cage of a target on the polygon of a free space, whose fingers are points.

    ``known`` is the search from the target, where it has been made already. Without ``way`` there
    is no escape path.
    """
    hand = free_space.hand
    if target is None:
        return not_a_cage(outline, hand, contacts, why_not(free_space, contacts), radius)
    if target.plateau is not None:
        why = plateau_reason(target.plateau, free_space)
        return not_a_cage(outline, hand, contacts, why, radius)
    found = search(free_space, target.cell, target.sigma_0) if known is None else known
    if found.gave_up:
        raise GeometryError(f"the search gave up after {len(found.nodes)} cells")
    tree = merge_tree(found)
    grasps, punctures, nodes = grasps_and_punctures(found, tree, target)
    largest = largest_sigma_in(found) if found.never_escapes else None
    top = found.level if largest is None else largest
    if top / target.sigma_0 - 1.0 < NOT_A_CAGE:
        why = ISOLATED if largest is not None else no_depth_reason(top / target.sigma_0)
        return not_a_cage(outline, hand, contacts, why, radius)
    size = free_space.pieces.diameter
    path, gap = escape_path(found, target) if found.escaped and way else (None, None)
    first = punctures[0].sigma if punctures else None
    return Cage(
        outline=outline,
        hand=hand,
        finger_radius=radius,
        contacts=grasps[0].contacts,
        status=CageStatus.CAGE if found.escaped else CageStatus.NEVER_ESCAPES,
        why=None,
        sigma_0=target.sigma_0,
        sigma_first=first,
        sigma_max=found.level if found.escaped else None,
        sigma_largest=largest,
        adjusted_by=target.moved * size,
        punctures=punctures,
        grasps=grasps,
        escape_path=path,
        min_finger_gap=gap,
        warnings=_cut_warnings(tree, found.level, size),
        work=CageWork(found, tree, nodes),
    )


def _cut_warnings(tree: Tree, escape: float, size: float) -> tuple[str, ...]:
    """Whether sigma_first hangs on the depth below which a minimum does not count."""
    if not has_joinings_between(tree, DEPTH_FINE * size, DEPTH_ROUGH * size):
        return ()
    fine = first_joining(tree, DEPTH_FINE * size, escape)
    rough = first_joining(tree, DEPTH_ROUGH * size, escape)
    chosen = first_joining(tree, DEPTH_CUT * size, escape)
    if fine == rough == chosen:
        return ()
    return (
        "sigma_first depends on how deep a minimum must be to count: "
        f"{fine:.9g} (1e-11 of the diameter), {chosen:.9g} (1e-10, used), {rough:.9g} (1e-6)",
    )
