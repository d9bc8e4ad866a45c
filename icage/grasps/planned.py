"""From candidates of the search to cages: one after another until enough of them are planned.

A candidate is found on an inner polygon of the discs' true curve, and not every one is a grasp on
the curve itself. Those that are not give their place to the next, and are told of.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.discs.true_curve import grasp_on_curve
from icage.errors import GeometryError, GraspError, HandError
from icage.grasps.search import same_place
from icage.grasps.wanted import Aim
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan

_TRIES_AT_A_PLACE = 4
"""Candidates near each other that are tried before the place is given up."""


@dataclass(frozen=True, slots=True)
class Failure:
    """Candidates that are no cages at one place: ``contacts`` (3, 2) of the best one, and why."""

    contacts: FloatArray
    why: str


@dataclass(frozen=True, slots=True)
class PlannedGrasps:
    """Cages, best first, and the candidates that came to nothing on the way."""

    cages: tuple[Cage, ...]
    failures: tuple[Failure, ...]
    triples_left_out: int = 0
    """Triples of contacts that the search did not draw, at random."""
    searches_broken_off: int = 0
    """Candidates whose search of the free space was too large."""
    compared: int = 0
    """Candidates that the search has ranked."""

    def reasons(self) -> list[tuple[str, int]]:
        """Reasons of the failures with their numbers, the commonest first."""
        return Counter(failure.why for failure in self.failures).most_common()


def score(cage: Cage, aim: Aim) -> float:
    """Ratio that ranks; levels that do not exist count as the largest sigma of the component."""
    top = cage.sigma_max if cage.sigma_max is not None else cage.sigma_largest
    if top is None:
        raise GeometryError("a cage without sigma_max and without a largest sigma")
    level = top if aim == "cage" or cage.sigma_first is None else cage.sigma_first
    return level / cage.sigma_0


def planned_grasps(
    outline: Outline, radius: float, candidates: Iterable[FloatArray], aim: Aim, top: int
) -> PlannedGrasps:
    """The first ``top`` candidates, (3, 2) contacts best first, that are cages at different places.

    A candidate near one that failed is tried as well, ``_TRIES_AT_A_PLACE`` times at most.
    """
    cages: list[Cage] = []
    failures: list[Failure] = []
    tries: list[int] = []
    for contacts in candidates:
        if len(cages) == top:
            break
        if any(same_place(outline, contacts, cage.contacts) for cage in cages):
            continue
        known = (k for k, f in enumerate(failures) if same_place(outline, contacts, f.contacts))
        at = next(known, None)
        if at is not None and tries[at] >= _TRIES_AT_A_PLACE:
            continue
        cage = _planned(outline, radius, contacts)
        if isinstance(cage, Cage):
            if not any(same_place(outline, cage.contacts, other.contacts) for other in cages):
                cages.append(cage)
            if at is not None:  # a neighbour has taken its place
                del failures[at], tries[at]
        elif at is None:
            failures.append(Failure(contacts, cage))
            tries.append(1)
        else:
            tries[at] += 1
    return _ordered(cages, failures, aim)


def planned_grasps_of_hand(
    outline: Outline, radius: float, hand: HandShape, candidates: Iterable[FloatArray], aim: Aim
) -> PlannedGrasps:
    """All candidates, (3, 2) contacts, that are cages of this very hand."""
    answers = [(contacts, _planned(outline, radius, contacts, hand)) for contacts in candidates]
    cages = [cage for _, cage in answers if isinstance(cage, Cage)]
    failures = [Failure(contacts, why) for contacts, why in answers if isinstance(why, str)]
    return _ordered(cages, failures, aim)


def _ordered(cages: list[Cage], failures: list[Failure], aim: Aim) -> PlannedGrasps:
    return PlannedGrasps(tuple(sorted(cages, key=lambda cage: -score(cage, aim))), tuple(failures))


def _planned(
    outline: Outline, radius: float, contacts: FloatArray, hand: HandShape | None = None
) -> Cage | str:
    """The cage of a candidate, or why there is none: one that fails is no reason to stop."""
    try:
        if radius > 0.0:
            contacts = grasp_on_curve(outline, radius, contacts, hand)
    except GraspError as error:
        return str(error)
    except HandError:
        return "the fingers come to stand on one line"
    try:
        cage = plan(outline, contacts, radius)
    except GraspError:
        return "out of reach of fingers of this radius"
    except GeometryError:
        return "it could not be planned (our fault)"
    return cage if cage.status != "not_a_cage" else "no cage"
