"""What all figures of one case share: the plan, and one polygon with its search; computed once.

Levels, punctures and regions are the plan's own, those that ``icage plan`` prints. What only a
search of point fingers on one polygon has (rectangles, nodes, the graph) is drawn from that; with
discs the polygon is coarse and its own levels are others, so they are never named.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.case import Case
from icage.cells.regions import FingerRegion, caging_regions
from icage.contact_space.boundary import Boundary
from icage.contact_space.exploration import Exploration, Plane
from icage.contact_space.method import ContactLocalCage, ContactSpace
from icage.discs.offsets import directions_on_arcs, offsets
from icage.errors import InputError
from icage.geometry.statics import contacts_reason
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.tolerance import TARGET_SHIFT, TARGET_TURN

_ARCS = (2, 3, 4, 8, 16)
"""Segments a quadrant to try: few, so that the rectangles of contact space can be read."""

TOUCH = 1e-7
"""[diameter] A finger this close to the polygon touches it."""


@dataclass(frozen=True)
class Study:
    """A case as its figures see it.

    ``polygon`` and ``look`` are of point fingers: on the object, or with discs on an inner offset
    polygon of ``segments`` chords a quadrant (0 for points).
    """

    case: Case
    polygon: Outline
    local_cage: ContactLocalCage
    segments: int

    @classmethod
    def of(cls, case: Case) -> Study:
        """Run the search of a case.

        Raises
        ------
        InputError:
            The contacts are no strict local minimum, so that there is no search to draw.
        """
        hand = HandShape.from_contacts(case.contacts)
        if case.finger_radius == 0.0:
            local_cage = ContactSpace().local_cage(
                case.outline, hand, case.contacts, TARGET_SHIFT, TARGET_TURN
            )  # fmt: skip
            if local_cage is not None:
                return cls(case, case.outline, local_cage, 0)
        for segments in _ARCS if case.finger_radius > 0.0 else ():
            found = _on_chords(case, hand, segments)
            if found is not None:
                return cls(case, *found, segments)
        why = contacts_reason(case.outline, case.contacts) if not case.finger_radius else "no grasp"
        raise InputError(f"{case.name}: the figures need an immobilizing grasp; {why}")

    @property
    def found(self) -> Exploration:
        """The search."""
        return self.local_cage.found

    @property
    def plane(self) -> Plane:
        """The polygon, the hand and the pieces of the plane."""
        return self.local_cage.found.plane

    @property
    def hand(self) -> HandShape:
        """The hand's shape."""
        return self.plane.hand

    @cached_property
    def answer(self) -> Cage:
        """The plan's own cage of the case, discs and all."""
        return plan(self.case.outline, self.case.contacts, self.case.finger_radius)

    @property
    def sigma_0(self) -> float:
        """[unit] The plan's."""
        return self.answer.sigma_0

    @property
    def finest(self) -> Outline:
        """The polygon that the plan's punctures lie on; with discs much finer than ``polygon``."""
        work = self.answer.work
        return self.polygon if work is None else work.search.free_space.outline

    @property
    def about(self) -> str | None:
        """With discs, what else is drawn but the plan's levels; None for points."""
        if not self.segments:
            return None
        return (
            f"drawn for point fingers on one polygon, the inner offset with {self.segments} chords "
            "a quadrant; sigma_0, sigma_first and sigma_max are the plan's"
        )

    @property
    def near(self) -> float:
        """[unit] Within this a finger touches."""
        return TOUCH * self.polygon.diameter

    @cached_property
    def boundary(self) -> Boundary:
        """The polygon by arclength."""
        return Boundary.of(self.polygon)

    @cached_property
    def target(self) -> FloatArray:
        """Contacts (3, 2) of the target on the polygon."""
        return self.plane.contacts(self.local_cage.target.hand)

    @cached_property
    def cage(self) -> Cage:
        """The cage by the search, point fingers on ``polygon``: with discs not the plan's."""
        return self.local_cage.cage(self.target, self.polygon, 0.0)

    @cached_property
    def regions(self) -> tuple[FingerRegion, ...]:
        """The plan's caging regions, from inside."""
        if self.answer.status == "not_a_cage":
            return ()
        return tuple(r for r in caging_regions(self.answer, gap=3e-3) if r.bound == "inner")

    @cached_property
    def grasps(self) -> list[FloatArray]:
        """Contacts (3, 2) of all immobilizing grasps of this hand, by sigma."""
        return grasps_of_hand(self.polygon, self.hand)

    def places(self, contacts: FloatArray, pair: int) -> FloatArray:
        """Where a hand (3, 2) is in U_{i,i+1}: (k, 2), none if one of both fingers is free.

        More than one at s = 0, which is s = L too.
        """
        ends: list[list[float]] = []
        for finger in (pair, (pair + 1) % 3):
            _, s, gap = self.boundary.nearest(contacts[finger])
            total = self.boundary.perimeter
            if gap > self.near:
                return np.empty((0, 2))
            at_seam = min(s, total - s) <= self.near
            ends.append([0.0, total] if at_seam else [s])
        return np.array([[a, b] for a in ends[0] for b in ends[1]])


def _on_chords(
    case: Case, hand: HandShape, segments: int
) -> tuple[Outline, ContactLocalCage] | None:
    """The inner offset polygon and the search on it, if the target is a minimum there."""
    through = directions_on_arcs(case.outline, case.finger_radius, case.contacts)
    polygon = offsets(case.outline, case.finger_radius, segments, through).inner
    chord = case.finger_radius * np.pi / segments / polygon.diameter if through else 0.0
    reach, turn = max(TARGET_SHIFT, chord), max(TARGET_TURN, 10.0 * chord)
    local_cage = ContactSpace().local_cage(polygon, hand, case.contacts, reach, turn)
    return None if local_cage is None else (polygon, local_cage)
