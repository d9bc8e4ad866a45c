"""From candidates of the search to cages: one after another until enough of them are planned.

A candidate is found on an inner polygon of the discs' true curve, and not every one is a grasp on
the curve itself. Those that are not give their place to the next, and are told of.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.discs.true_curve import grasp_on_curve
from icage.errors import GeometryError, GraspError, HandError
from icage.grasps.crew import Ended
from icage.grasps.findings import distinct, ideas, same_idea
from icage.grasps.scores import score
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan

_TRIES_AT_A_PLACE = 4
"""Candidates of one idea that are tried before it is given up."""

_OF_AN_IDEA = 4
"""Grasps of discs of one idea that are planned, ..."""

_APART = 3e-4
"""[diameter] ... further from each other than this."""

_SAME = 1e-7
"""[diameter] Solved grasps of one hand whose fingers are this near are one."""

WEDGED: Final = "a wedge: only an exact fit holds it"
"""Why a cage is not ranked of which nothing is guaranteed."""


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
    scores: tuple[float, ...] = ()
    """Of the cages: the ratio that is ranked, as it was planned."""
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
    unplanned: int = 0
    """Where plans are ranked: candidates that might be among the best and were not planned."""

    def reasons(self) -> list[tuple[str, int]]:
        """Reasons of the failures with their numbers, the commonest first."""
        return Counter(failure.why for failure in self.failures).most_common()

    def reason_words(self) -> str:
        """The reasons in one line: "2 no cage; 1 too large", the commonest first."""
        return "; ".join(f"{count} {why}" for why, count in self.reasons())


def planned_grasps(
    outline: Outline, radius: float, candidates: Iterable[FloatArray], wanted: Wanted, top: int
) -> PlannedGrasps:
    """The first ``top`` candidates, (3, 2) contacts best first, that are cages of different ideas.

    A candidate that fails gives its place to others like it, ``_TRIES_AT_A_PLACE`` at most.
    """
    contacts = np.array(list(candidates), dtype=np.float64).reshape(-1, 3, 2)
    cages: list[tuple[float, Cage]] = []
    alike: list[int] = []
    failures: list[Failure] = []
    for group in ideas(contacts, outline.diameter):
        if len(cages) == top:
            break
        best, why = _best_planned(outline, radius, contacts[group], wanted)
        if best is None:
            failures.append(Failure(contacts[group[0]], why))
        # a grasp of discs moves a little when it is solved on the true curve
        elif not any(same_idea(outline, best[1].contacts, other.contacts) for _, other in cages):
            cages.append(best)
            alike.append(len(group) - 1)
    return _ordered(cages, alike, failures)


def _best_planned(
    outline: Outline, radius: float, alike: FloatArray, wanted: Wanted
) -> tuple[tuple[float, Cage] | None, str]:
    """The best cage of grasps (n, 3, 2) of one idea, best first, and its score; or why the first
    is none.

    Scores of discs are those of polygons, and the best are often those that are wrong: where a
    finger is just about to be free, the true curve asks for another hand. So more than one of an
    idea is planned.
    """
    rows = distinct(alike, _APART * outline.diameter) if radius > 0.0 else np.arange(len(alike))
    best: tuple[float, Cage] | None = None
    planned, why = 0, ""
    for row in rows[:_TRIES_AT_A_PLACE]:
        cage = planned_or_why(outline, radius, alike[row])
        if isinstance(cage, Cage) and wanted.aim != "cage" and _is_wedged(cage):
            cage = WEDGED
        if isinstance(cage, str):
            why = why or cage
            continue
        worth = score(cage, wanted)
        if best is None or worth > best[0]:
            best = worth, cage
        planned += 1
        if planned == (_OF_AN_IDEA if radius > 0.0 else 1):
            break
    return best, why


def _is_wedged(cage: Cage) -> bool:
    """Whether nothing is left of the guaranteed set if a hair is changed."""
    return cage.wedge is not None and cage.wedge.sigma <= cage.sigma_0


def planned_grasps_of_hand(
    outline: Outline,
    radius: float,
    hand: HandShape,
    candidates: Iterable[FloatArray],
    wanted: Wanted,
) -> PlannedGrasps:
    """All candidates, (3, 2) contacts, that are cages of this very hand.

    Chords that stand for one arc have grasps of their own, which are one on the true curve: planned
    once, the others are told as alike.
    """
    places: list[FloatArray] = []
    alike: list[int] = []
    failures: list[Failure] = []
    for contacts in candidates:
        held = _held_or_why(outline, radius, contacts, hand)
        if isinstance(held, str):
            failures.append(Failure(contacts, held))
            continue
        off = [float(np.abs(held - other).max()) for other in places]
        if off and min(off) <= _SAME * outline.diameter:
            alike[int(np.argmin(off))] += 1
        else:
            places.append(held)
            alike.append(0)
    cages: list[tuple[float, Cage]] = []
    kept: list[int] = []
    for held, more in zip(places, alike, strict=True):
        cage = _planned_or_why(outline, radius, held)
        if isinstance(cage, str):
            failures += [Failure(held, cage)] * (1 + more)
        else:
            cages.append((score(cage, wanted), cage))
            kept.append(more)
    return _ordered(cages, kept, failures)


def _ordered(
    cages: list[tuple[float, Cage]], alike: list[int], failures: list[Failure]
) -> PlannedGrasps:
    order = sorted(range(len(cages)), key=lambda k: -cages[k][0])
    return PlannedGrasps(
        tuple(cages[k][1] for k in order),
        tuple(failures),
        tuple(cages[k][0] for k in order),
        tuple(alike[k] for k in order),
    )


def planned_or_why(
    outline: Outline, radius: float, contacts: FloatArray, hand: HandShape | None = None
) -> Cage | str:
    """The cage of a candidate, or why there is none: one that fails is no reason to stop."""
    held = _held_or_why(outline, radius, contacts, hand)
    return held if isinstance(held, str) else _planned_or_why(outline, radius, held)


def _held_or_why(
    outline: Outline, radius: float, contacts: FloatArray, hand: HandShape | None
) -> FloatArray | str:
    """Where the fingers of a candidate stand on the true curve, or why they cannot."""
    try:
        return grasp_on_curve(outline, radius, contacts, hand) if radius > 0.0 else contacts
    except GraspError as error:
        return str(error)
    except HandError:
        return "the fingers come to stand on one line"


def _planned_or_why(outline: Outline, radius: float, contacts: FloatArray) -> Cage | str:
    try:
        cage = plan(outline, contacts, radius)
    except GraspError:
        return "out of reach of fingers of this radius"
    except GeometryError:
        return "it could not be planned (our fault)"
    return cage if cage.status != "not_a_cage" else "no cage"
