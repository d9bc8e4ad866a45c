"""The contact space as an engine: the paper's I-CAGE behind ``plan``. [Bunis2018, Sec. VI]"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage, CageStatus, not_a_cage
from icage.contact_space.basins import first_level, grasps_and_punctures, meetings
from icage.contact_space.exploration import Exploration, Plane, explore_from
from icage.contact_space.kernels.columns import (
    EDGE_KIND,
    EDGE_LABEL,
    EDGE_TO,
    HAND,
    HAND_TOO,
    REGION_PAIR,
    TUNNEL_KEPT,
    TUNNEL_PAIR,
    EdgeKind,
)
from icage.contact_space.target import ContactTarget, find_contact_target, largest_sigma
from icage.geometry.statics import ISOLATED, contacts_reason, no_depth_reason
from icage.geometry.way_out import corners_before_pinch
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import (
    DEPTH_CUT,
    DEPTH_FINE,
    DEPTH_ROUGH,
    NOT_A_CAGE,
    TARGET_SHIFT,
    TARGET_TURN,
)

__all__ = ["CONTACT_SPACE", "ContactLocalCage", "ContactSpace"]


@dataclass(frozen=True, slots=True)
class ContactLocalCage:
    """A target on one polygon and the search from it. See ``icage.method.Look``."""

    target: ContactTarget
    found: Exploration

    @property
    def sigma_max(self) -> float:
        """Escape level, inf if there is none."""
        return self.found.level

    @property
    def sigma_first(self) -> float:
        """First level."""
        return first_level(self.found)

    def cage(
        self, contacts: FloatArray, outline: Outline, radius: float, *, way: bool = True
    ) -> Cage:
        """The cage on this polygon."""
        found, sigma_0 = self.found, self.target.sigma_0
        hand = found.plane.hand
        largest = largest_sigma(found) if found.closed_in else None
        top = found.level if largest is None else largest
        if top / sigma_0 - 1.0 < NOT_A_CAGE:
            why = ISOLATED if largest is not None else no_depth_reason(top / sigma_0)
            return not_a_cage(outline, hand, contacts, why, radius)
        grasps, punctures = grasps_and_punctures(found, self.target)
        path, gap = (self.escape_path() if way else None) or (None, None)
        return Cage(
            outline=outline,
            hand=hand,
            finger_radius=radius,
            contacts=grasps[0].contacts,
            status=CageStatus.CAGE if found.escaped else CageStatus.NEVER_ESCAPES,
            why=None,
            sigma_0=sigma_0,
            sigma_first=punctures[0].sigma if punctures else None,
            sigma_max=found.level if found.escaped else None,
            sigma_largest=largest,
            adjusted_by=self.target.moved * found.plane.outline.diameter,
            punctures=punctures,
            grasps=grasps,
            escape_path=path,
            min_finger_gap=gap,
            warnings=_cut_warnings(found),
            search=found.log(),
        )

    def escape_path(self) -> tuple[FloatArray, float] | None:
        """Placements to a pinched hand and the least finger gap, or None.

        Between neighbours two fingers stay on their edges and the third in its piece (all three
        conditions are linear), or, in a tunnel, one finger stays and the hand shrinks.
        """
        if not self.found.escaped:
            return None
        found, plane = self.found, self.found.plane
        hands = [self.target.hand]
        for e in found.way_out():
            hands.append(found.hands[e, HAND])
            if found.edges[e, EDGE_KIND] == EdgeKind.TUNNEL:
                hands.append(found.hands[e, HAND_TOO])
        x, y = self._pinched_at(hands[-1])
        corners = [complex(h[2], h[3]) for h in hands]
        corners = corners[: corners_before_pinch(corners, plane.outline.diameter)]
        rows = [plane.placement(h) for h in hands[: len(corners)]]
        rows.append(np.array([x, y, rows[-1][2], 0.0]))
        return np.array(rows), plane.hand.least_gap(corners)

    def _pinched_at(self, last: FloatArray) -> FloatArray:
        """Where the three fingers meet at the end of the way out."""
        found, plane = self.found, self.found.plane
        if len(found.edges) and found.edges[-1, EDGE_TO] < 0:
            row = plane.tunnel_edges().rows[int(found.edges[-1, EDGE_LABEL])]
            return plane.contacts(last)[(int(row[TUNNEL_PAIR]) + int(row[TUNNEL_KEPT])) % 3]
        _, ends = plane.least(found.regions[-1])
        return plane.contacts(ends[0])[int(found.regions[-1, REGION_PAIR])]


@dataclass(frozen=True, slots=True)
class ContactSpace:
    """The paper's method, with one correction: tunnel edges are taken in both directions.

    ``both_ways=False`` takes them downwards only, to the letter; ``tunnels=False`` leaves out Sec.
    V-B altogether. Both can miss connections, so that sigma_max comes out too high: for teaching.
    ``merge=False`` keeps the triangles of the paper instead of larger convex pieces.
    """

    tunnels: bool = True
    both_ways: bool = True
    merge: bool = True

    @property
    def complete(self) -> bool:
        """Whether tunnel edges are taken, and in both directions: else connections are missed."""
        return self.tunnels and self.both_ways

    def cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, outline: Outline,
        radius: float,
    ) -> Cage:  # fmt: skip
        """The cage of point fingers on a polygon, or why there is none."""
        plane = Plane.around(polygon, hand, merge=self.merge)
        target = find_contact_target(plane, contacts, reach=TARGET_SHIFT, turn=TARGET_TURN)
        if target is None or target.slide:
            why = contacts_reason(polygon, contacts, target.slide if target else 0.0)
            return not_a_cage(outline, hand, contacts, why, radius)
        return self._explored(plane, target).cage(contacts, outline, radius)

    def local_cage(
        self, polygon: Outline, hand: HandShape, contacts: FloatArray, reach: float, turn: float
    ) -> ContactLocalCage | None:
        """The strict minimum nearest to the contacts and what surrounds it, or None."""
        plane = Plane.around(polygon, hand, merge=self.merge)
        target = find_contact_target(plane, contacts, reach=reach, turn=turn)
        if target is None or target.slide:
            return None
        return self._explored(plane, target)

    def _explored(self, plane: Plane, target: ContactTarget) -> ContactLocalCage:
        found = explore_from(plane, target.region, tunnels=self.tunnels, both_ways=self.both_ways)
        return ContactLocalCage(target, found)


CONTACT_SPACE = ContactSpace()


def _cut_warnings(found: Exploration) -> tuple[str, ...]:
    """Whether sigma_first hangs on the depth below which a minimum does not count."""
    size = found.plane.outline.diameter
    firsts = []
    for cut in (DEPTH_FINE, DEPTH_CUT, DEPTH_ROUGH):
        met = meetings(found, cut * size)
        firsts.append(met[0].sigma if met else found.level)
    if len(set(firsts)) == 1:
        return ()
    return (
        "sigma_first depends on how deep a minimum must be to count: "
        f"{firsts[0]:.9g} (1e-11 of the diameter), {firsts[1]:.9g} (1e-10, used), "
        f"{firsts[2]:.9g} (1e-6)",
    )
