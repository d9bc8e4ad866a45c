"""Grasps that are worth a look: the product's own search, for as long as somebody waits."""

from __future__ import annotations

from typing import Any

import numpy as np

from experiments.explore.live.lane import Stopped
from experiments.explore.live.planning import levels_document
from experiments.explore.live.thing import Thing
from experiments.io.pieces import cores
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.grasps.of_case import best_of_case
from icage.grasps.wanted import Wanted
from icage.kernels.compiled import long_job

THREADS = 2


class Proposing:
    """Answers ``propose``."""

    def __init__(self, thing: Thing) -> None:
        self.thing = thing

    def answer(self, kind: str, question: dict[str, Any], stopped: Stopped) -> str:
        """The document of an answer: the best grasps, planned, best first."""
        if kind == "warm":
            return "{}"

        def look(_stage: str, _done: int, _total: int, best: float | None) -> None:
            if best is not None and stopped():
                raise KeyboardInterrupt  # the search takes it as "with what there is"

        long_job()
        case = self.thing.case(question["radius"])
        if case.finger_radius > case.outline.diameter:
            raise InputError(
                f"the finger radius is {case.finger_radius:g} {case.unit}; the object's diameter "
                f"is {case.outline.diameter:g}"
            )
        wanted = Wanted("first", tolerance=self.thing.tolerance)
        found = best_of_case(
            case, question["top"], wanted, np.random.default_rng(0), min(THREADS, cores()), look,
            question["seconds"],
        )  # fmt: skip
        return json_text(
            {
                "format": "icage-proposals/1",
                "compared": found.compared,
                "ended": found.ended,
                "grasps": [
                    {**levels_document(cage), "phi_deg": cage.hand.phi_deg, "score": score}
                    for cage, score in zip(found.cages, found.scores, strict=True)
                ],
            }
        )


def worker(thing: Thing) -> Proposing:
    """For ``Lane``."""
    return Proposing(thing)
