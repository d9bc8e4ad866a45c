"""Good target grasps of an outline: all triples of contacts that squeeze, the best made better.

On real tools most immobilizing grasps have useless cages, so enumeration alone is not enough (see
``icage.grasps.stages``). The search may be stopped at any time and then has the best so far. Our
own; the sets are those of [Bunis2018, Sec. VII-A] with the squeezing test.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from icage.errors import GraspError, InputError
from icage.geometry.near_frame import NearFrame
from icage.grasps.crew import Crew, OutOfTimeError, Progress
from icage.grasps.findings import groups
from icage.grasps.stages import Stages
from icage.grasps.wanted import Candidate, Wanted
from icage.outline import Outline

_ANY = Wanted()
"""Any grasp, by sigma_first / sigma_0."""

Ended: TypeAlias = Literal["out of time", "interrupted"]


@dataclass(frozen=True, slots=True)
class Ranking:
    """Everything that was found, best first, and what was not looked at.

    Attributes
    ----------
    candidates:
        They may be near each other.
    triples, triples_left_out:
        Triples of contact features, and those of them that were not drawn.
    broken_off:
        Grasps whose search was larger than allowed.
    compared:
        Candidates that were looked at.
    ended:
        What ended the search before its own end, or None.
    """

    candidates: tuple[Candidate, ...]
    triples: int
    triples_left_out: int
    broken_off: int
    compared: int = 0
    ended: Ended | None = None


def _silent(_stage: str, _done: int, _total: int, _best: float | None) -> None:
    """No progress report."""


def ranked_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    wanted: Wanted = _ANY,
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
    seconds: float | None = None,
) -> Ranking:
    """All grasps that were found, best first.

    Parameters
    ----------
    finger_radius:
        Radius of disc fingers, [unit]; the search then runs on the inner offset polygon, so the
        levels are those of that polygon: plan the winners for certified ones.
    wanted:
        What is ranked and which grasps are looked at. aim "first" ranks by sigma_first / sigma_0,
        "cage" by sigma_max / sigma_0 (the largest sigma of the component for a hand that never
        escapes).
    workers:
        Threads; the result does not depend on their number.
    seconds:
        When to stop with what there is. Ctrl-C does the same. None: the search ends by itself.

    Raises
    ------
    GraspError:
        No immobilizing grasp within the limits was found.
    """
    frame = NearFrame.of(outline)
    outline = frame.outline_into(outline)
    search = Stages(outline, finger_radius, wanted, rng)
    ended: Ended | None = None
    with Crew(workers, progress, seconds) as crew:
        try:
            search.run(crew)
        except OutOfTimeError:
            ended = "out of time"
        except KeyboardInterrupt:
            ended = "interrupted"
    best = search.best_first()
    if not len(best):
        when = "" if ended is None else f" (the search was {ended})"
        raise GraspError(
            f"no immobilizing three-finger grasp was found on this outline{when}, within the "
            "limits of the hand and of where it may touch; wider limits may let some in"
        )
    return Ranking(
        tuple(replace(c, contacts=frame.back(c.contacts)) for c in best.candidates()),
        search.triples, search.left_out, search.broken_off, crew.compared, ended,
    )  # fmt: skip


def best_grasps(
    outline: Outline,
    *,
    finger_radius: float = 0.0,
    top: int = 10,
    wanted: Wanted = _ANY,
    rng: np.random.Generator,
    workers: int = 1,
    progress: Progress = _silent,
    seconds: float | None = None,
) -> list[Candidate]:
    """The ``top`` best of ``ranked_grasps``, each another idea (``icage.grasps.findings``)."""
    if top < 1:
        raise InputError(f"top = {top}; at least 1 is needed")
    ranking = ranked_grasps(
        outline, finger_radius=finger_radius, wanted=wanted, rng=rng, workers=workers,
        progress=progress, seconds=seconds,
    )  # fmt: skip
    contacts = np.array([c.contacts for c in ranking.candidates])
    return [ranking.candidates[int(group[0])] for group in groups(contacts, outline.diameter, top)]
