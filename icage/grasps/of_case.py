"""The best target grasps of a case: searched, planned one after another, ranked. Our own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from icage.case import Case
from icage.errors import GraspError, InputError
from icage.grasp import Grasp
from icage.grasps.crew import Progress
from icage.grasps.planned import PlannedGrasps, planned_grasps
from icage.grasps.search import ranked_grasps
from icage.grasps.wanted import Wanted
from icage.library_faults import geometry_told


@geometry_told()
def best_of_case(
    case: Case,
    top: int,
    wanted: Wanted,
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress | None = None,
    seconds: float | None = None,
) -> PlannedGrasps:
    """Up to ``top`` cages of the best grasps, and what came to nothing or was not looked at.

    ``seconds`` bounds the search; the best of it are planned after that.

    Raises
    ------
    GraspError:
        No immobilizing three-finger grasp was found, or none before the search was ended.
    InputError:
        ``top`` below 1.
    """
    if top < 1:
        raise InputError(f"top is {top}; at least 1 is needed")
    radius = case.finger_radius
    reporting = {} if progress is None else {"progress": progress}
    found = ranked_grasps(
        case.outline, finger_radius=radius, wanted=wanted, rng=rng, workers=workers,
        seconds=seconds, **reporting,
    )  # fmt: skip
    contacts = (candidate.contacts for candidate in found.candidates)
    planned = planned_grasps(case.outline, radius, contacts, wanted, top)
    if found.ended is not None and not planned.cages:
        raise GraspError(
            f"no grasp was found before the search was {found.ended}: none of the "
            f"{len(planned.failures)} that it had is one ({planned.reason_words()}); more time may "
            "help"
        )
    return replace(
        planned,
        triples_left_out=found.triples_left_out,
        searches_broken_off=found.broken_off,
        compared=found.compared,
        ended=found.ended,
        unplanned=found.unplanned,
    )


def grasps_in(planned: PlannedGrasps) -> tuple[Grasp, ...]:
    """The cages as grasps with their levels and scores."""
    return tuple(
        Grasp(cage.contacts, cage.sigma_0, cage.sigma_first, cage.sigma_max, score)
        for cage, score in zip(planned.cages, planned.scores, strict=True)
    )
