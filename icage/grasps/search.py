"""Good target grasps of an outline: all triples of contacts that squeeze, the best made better.

On real tools most immobilizing grasps have useless cages, so enumeration alone is not enough (see
``icage.grasps.stages``). The search may be stopped at any time and then has the best so far. Our
own; the sets are those of [Bunis2018, Sec. VII-A] with the squeezing test.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from icage.errors import GraspError, InputError
from icage.geometry.near_frame import NearFrame
from icage.grasps.crew import Crew, Ended, OutOfTimeError, Progress
from icage.grasps.findings import groups
from icage.grasps.second_look import SecondLook
from icage.grasps.stages import Stages
from icage.grasps.wanted import Candidate, Wanted
from icage.outline import Outline

_AFTER_CTRL_C = 1.0
"""[s] For the plans without which nothing can be ranked, where a search is interrupted."""

_ANY = Wanted()
"""Any grasp, by sigma_first / sigma_0."""


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
    unplanned:
        Candidates that might be among the best by a plan, where plans are ranked, and were not
        planned.
    """

    candidates: tuple[Candidate, ...]
    triples: int
    triples_left_out: int
    broken_off: int
    compared: int = 0
    ended: Ended | None = None
    unplanned: int = 0


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
        escapes), "friction" by sigma_first(mu) / sigma_0.
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
    plans = wanted.aim == "friction"
    begun = time.monotonic()
    with Crew(workers, progress, 0.5 * seconds if plans and seconds else seconds) as crew:
        ended = _as_it_ended(lambda: search.run(crew))
    best, unplanned = search.best_first(), 0
    if plans and len(best):
        look = SecondLook(search)
        rest = None if seconds is None else begun + seconds - time.monotonic()
        with Crew(workers, progress, _AFTER_CTRL_C if ended == "interrupted" else rest) as again:
            ended = _as_it_ended(lambda: look.run(again)) or ended
        best, unplanned = look.best_first(), look.left_out
    if not len(best):
        when = "" if ended is None else f" (the search was {ended})"
        raise GraspError(
            f"no immobilizing three-finger grasp was found on this outline{when}, within the "
            "limits of the hand and of where it may touch; wider limits may let some in"
        )
    return Ranking(
        tuple(replace(c, contacts=frame.back(c.contacts)) for c in best.candidates()),
        search.triples, search.left_out, search.broken_off, crew.compared, ended, unplanned,
    )  # fmt: skip


def _as_it_ended(work: Callable[[], None]) -> Ended | None:
    """Work that may be ended early keeps what it has."""
    try:
        work()
    except OutOfTimeError:
        return "out of time"
    except KeyboardInterrupt:
        return "interrupted"
    return None


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
