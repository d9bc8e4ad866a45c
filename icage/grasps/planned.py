"""From candidates of the search to cages: one after another until enough of them are planned.

A candidate is found on an inner polygon of the discs' true curve, and not every one is a grasp on
the curve itself. Those that are not give their place to the next, and are told of.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.discs.true_curve import grasp_on_curve
from icage.errors import GeometryError, GraspError, HandError
from icage.grasps.findings import distinct, ideas, same_idea
from icage.grasps.search import Ended
from icage.grasps.wanted import Aim
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan

_TRIES_AT_A_PLACE = 4
"""Candidates of one idea that are tried before it is given up."""

_OF_AN_IDEA = 4
"""Grasps of discs of one idea that are planned, ..."""

_APART = 3e-4
"""[diameter] ... further from each other than this."""


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
    alike: tuple[int, ...] = ()
    """How many more candidates are the same idea as each cage."""
    ended: Ended | None = None
    """What ended the search before its own end, if anything."""
    triples_left_out: int = 0
    """Triples of contacts that the search did not draw, at random."""
    searches_broken_off: int = 0
    """Candidates whose search of the free space was too large."""
    compared: int = 0
    """Candidates that the search has ranked."""

    def reasons(self) -> list[tuple[str, int]]:
        """Reasons of the failures with their numbers, the commonest first."""
        return Counter(failure.why for failure in self.failures).most_common()

    def reason_words(self) -> str:
        """The reasons in one line: "2 no cage; 1 too large", the commonest first."""
        return "; ".join(f"{count} {why}" for why, count in self.reasons())


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
    """The first ``top`` candidates, (3, 2) contacts best first, that are cages of different ideas.

    A candidate that fails gives its place to others like it, ``_TRIES_AT_A_PLACE`` at most.
    """
    contacts = np.array(list(candidates), dtype=np.float64).reshape(-1, 3, 2)
    cages: list[Cage] = []
    alike: list[int] = []
    failures: list[Failure] = []
    for group in ideas(contacts, outline.diameter):
        if len(cages) == top:
            break
        best, why = _best_planned(outline, radius, contacts[group], aim)
        if best is None:
            failures.append(Failure(contacts[group[0]], why))
        # a grasp of discs moves a little when it is solved on the true curve
        elif not any(same_idea(outline, best.contacts, other.contacts) for other in cages):
            cages.append(best)
            alike.append(len(group) - 1)
    return _ordered(cages, alike, failures, aim)


def _best_planned(
    outline: Outline, radius: float, alike: FloatArray, aim: Aim
) -> tuple[Cage | None, str]:
    """The best cage of grasps (n, 3, 2) of one idea, best first; or why the first is none.

    Scores of discs are those of polygons, and the best are often those that are wrong: where a
    finger is just about to be free, the true curve asks for another hand. So more than one of an
    idea is planned.
    """
    rows = distinct(alike, _APART * outline.diameter) if radius > 0.0 else np.arange(len(alike))
    best: Cage | None = None
    planned, why = 0, ""
    for row in rows[:_TRIES_AT_A_PLACE]:
        cage = _planned(outline, radius, alike[row])
        if isinstance(cage, str):
            why = why or cage
            continue
        if best is None or score(cage, aim) > score(best, aim):
            best = cage
        planned += 1
        if planned == (_OF_AN_IDEA if radius > 0.0 else 1):
            break
    return best, why


def planned_grasps_of_hand(
    outline: Outline, radius: float, hand: HandShape, candidates: Iterable[FloatArray], aim: Aim
) -> PlannedGrasps:
    """All candidates, (3, 2) contacts, that are cages of this very hand."""
    answers = [(contacts, _planned(outline, radius, contacts, hand)) for contacts in candidates]
    cages = [cage for _, cage in answers if isinstance(cage, Cage)]
    failures = [Failure(contacts, why) for contacts, why in answers if isinstance(why, str)]
    return _ordered(cages, [0] * len(cages), failures, aim)


def _ordered(
    cages: list[Cage], alike: list[int], failures: list[Failure], aim: Aim
) -> PlannedGrasps:
    order = sorted(range(len(cages)), key=lambda k: -score(cages[k], aim))
    return PlannedGrasps(
        tuple(cages[k] for k in order), tuple(failures), tuple(alike[k] for k in order)
    )


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
