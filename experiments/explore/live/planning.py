"""The cage of the contacts: its levels first, then everything that the page shows of it."""

from __future__ import annotations

from typing import Any, Final

from experiments.explore.document import explore_document
from experiments.explore.live.thing import Thing
from experiments.explore.page_html import LARGEST
from experiments.io.pieces import cores
from icage.cage import Cage
from icage.cells.query_tables import query_tables
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.friction.levels import JamTolerance, friction_levels
from icage.grasps.regrasp import regrasp
from icage.planner import plan

_KEPT: Final = 8
"""Cages that are remembered: whoever goes back and forth between grasps does not wait."""


class Planning:
    """Answers ``levels``, ``document`` and ``regrasp``."""

    def __init__(self, thing: Thing) -> None:
        self.thing = thing
        self._cages: dict[str, Cage] = {}

    def answer(self, kind: str, question: dict[str, Any], _stopped: object) -> str:
        """The document of an answer."""
        if kind == "warm":
            return "{}"
        if kind == "regrasp":
            return self._regrasp(question)
        cage = self._cage(question)
        return json_text(levels_document(cage)) if kind == "levels" else self._page(cage, question)

    def _cage(self, question: dict[str, Any]) -> Cage:
        key = repr((question["radius"], question["contacts"]))
        if key not in self._cages:
            if len(self._cages) == _KEPT:
                del self._cages[next(iter(self._cages))]
            self._cages[key] = plan(self.thing.case_asked(question))
        return self._cages[key]

    def _page(self, cage: Cage, question: dict[str, Any]) -> str:
        tolerance, mus = JamTolerance(), question["friction"]
        friction = friction_levels(cage, sorted(set(mus)), tolerance) if mus else ()
        tables = query_tables(cage, cores())
        thing = self.thing
        text = json_text(
            explore_document(cage, tables, thing.name, thing.unit, friction, tolerance)
        )
        if len(text) > LARGEST:
            raise InputError(
                f"the tables of this hand have {len(text) / 1e6:.1f} million characters; up to "
                f"{LARGEST / 1e6:g} million are allowed: simplify the outline (--tolerance)"
            )
        return text

    def _regrasp(self, question: dict[str, Any]) -> str:
        case = regrasp(self.thing.case_asked(question), finger_radius=question["to"])
        return json_text({"contacts": case.contacts})


def levels_document(cage: Cage) -> dict[str, Any]:
    """What is shown of a cage before its regions are there; lengths in the object's unit."""
    return {
        "format": "icage-levels/1",
        "verdict": cage.status,
        "why": cage.why,
        "contacts": cage.contacts,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "shelf": None if cage.shelf is None else cage.shelf.sigma,
        "brink": None if cage.brink is None else cage.brink.sigma,
        "wedge": None if cage.wedge is None else cage.wedge.sigma,
        "grasps": len(cage.grasps),
        "warnings": cage.warnings,
    }


def worker(thing: Thing) -> Planning:
    """For ``Lane``."""
    return Planning(thing)
