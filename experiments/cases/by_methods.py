"""One case by one method or by both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from icage.agreement import disagreements
from icage.cage import Cage
from icage.case import Case
from icage.cells.regions import FingerRegion, caging_regions
from icage.planner import plan


@dataclass(frozen=True, slots=True)
class Answer:
    """The cage that is reported, the cells' one, and what both methods differ in.

    Regions and figures come from the cells whatever the method: the paper renders its regions
    by other means too, once sigma_max is known. [Bunis2018, Sec. VI]
    """

    cage: Cage
    cells: Cage
    disagreements: list[str]

    def regions(self) -> Sequence[FingerRegion]:
        """The caging regions; none for what is not a cage."""
        return caging_regions(self.cells) if self.cells.status != "not_a_cage" else ()


def planned(case: Case, method: str, *, tunnels: bool = True) -> Answer:
    """The cage of a case by ``cells``, ``contact-space`` or ``both``."""
    cells = plan(case.outline, case.contacts, case.finger_radius)
    if method == "cells":
        return Answer(cells, cells, [])
    from icage.contact_space.method import ContactSpace  # only now: many more kernels

    engine = ContactSpace(tunnels=tunnels)
    cage = plan(case.outline, case.contacts, case.finger_radius, engine)
    if method == "contact-space":
        return Answer(cage, cells, [])
    return Answer(replace(cells, search=cage.search), cells, disagreements(cells, cage))
