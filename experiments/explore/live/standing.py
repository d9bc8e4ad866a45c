"""What some contacts are, told while they are dragged: do they hold, and what grasp is near?"""

from __future__ import annotations

from functools import lru_cache, partial
from importlib import import_module
from typing import Any

import numpy as np

from experiments.explore.live.thing import Thing
from icage.contacts import as_contacts
from icage.formats.json_out import json_text
from icage.grasps.nearest import NearestGrasp, NearestGrasps
from icage.hand import HandShape


class Standing:
    """Answers ``standing``: milliseconds, so that a drag sees it at once."""

    def __init__(self, thing: Thing) -> None:
        self.thing = thing
        self._grasps = lru_cache(maxsize=4)(partial(NearestGrasps, thing.outline))

    def answer(self, kind: str, question: dict[str, Any], _stopped: object) -> str:
        """The document of an answer."""
        if kind == "warm":
            import_module("scipy.optimize")  # a third of a second that no drag shall wait for
            self._grasps(question["radius"])
            return "{}"
        nearest: NearestGrasps = self._grasps(question["radius"])
        contacts = nearest.on_curve(as_contacts(question["contacts"]))
        found = nearest.of(contacts)
        return json_text(
            {
                "format": "icage-standing/1",
                "contacts": contacts,
                "sigma": float(np.hypot(*(contacts[1] - contacts[0]))),
                "phi_deg": HandShape.from_contacts(contacts).phi_deg,
                "holds": found.holds,
                "why": found.why or None,
                "grasp": _grasp(found),
            }
        )


def _grasp(found: NearestGrasp) -> dict[str, Any] | None:
    if found.contacts is None:
        return None
    return {
        "contacts": found.contacts,
        "moved": found.moved,
        "turned_deg": float(np.degrees(found.turned)),
    }


def worker(thing: Thing) -> Standing:
    """For ``Lane``."""
    return Standing(thing)
