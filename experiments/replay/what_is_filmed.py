"""What a film needs of one closing: where it starts, and what is said of it and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from experiments.io.outcome_words import END_WORDS, VERDICT_WORDS
from icage.arrays import FloatArray
from icage.cage import Cage
from sim.world.scene import Scene

if TYPE_CHECKING:
    from experiments.replay.run import Run

_SETS: Final = {
    "guaranteed": "guaranteed set",
    "rest": "rest of the cage",
    "outside": "outside the cage",
    "study": "study",
}
"""Where starts were drawn from."""


@dataclass(frozen=True, slots=True, eq=False)
class Filmed:
    """One closing in a film.

    Attributes
    ----------
    grasp:
        Name of its case.
    group:
        Closings with the same words here share a window and a page.
    start:
        (4,), the hand's placement in the object's frame and unit.
    outcome:
        One of ``sim.closing.judge.OUTCOMES``: shown when the motion is over.
    good:
        Whether it may end so.
    about:
        Where the start is from, or what the planner says of it.
    before, after:
        The line below the picture until the motion is over, and from then on.
    after_good:
        Whether the second tells of nothing but what may happen.
    whole:
        Whether the whole object is in the picture all the time, however small the hand is on it.
    """

    grasp: str
    group: str
    cage: Cage
    scene: Scene
    start: FloatArray
    outcome: str
    good: bool
    about: str
    before: str
    after: str
    after_good: bool
    whole: bool


def filmed_of_run(run: Run, trial: int, outcome: str) -> Filmed:
    """One of many closings of a replay: below it stand the counts of all, from the beginning."""
    guaranteed = run.which == "guaranteed"
    text, fine = headline(run.counts, guaranteed)
    return Filmed(
        grasp=run.case.name,
        group=run.title,
        cage=run.cage,
        scene=run.scene,
        start=run.starts.placements[trial],
        outcome=outcome,
        good=_may_end(outcome, guaranteed),
        about=f"{_SETS[run.which]}, start {trial + 1} of {len(run.closings)}",
        before=text,
        after=text,
        after_good=fine,
        whole=False,
    )


def filmed_alone(
    index: int, grasp: str, cage: Cage, scene: Scene, start: FloatArray, outcome: str,
    verdict: str, in_cage: bool,
) -> Filmed:  # fmt: skip
    """A recorded trial; ``verdict`` and ``in_cage`` are what the planner said of its start.

    How it ends is not told before it has ended.
    """
    good = _may_end(outcome, verdict == "target")
    away = verdict in ("target", "caged") and not in_cage
    said = "in another cage" if away else VERDICT_WORDS[verdict]
    return Filmed(
        grasp=grasp,
        group=f"trial {index}",
        cage=cage,
        scene=scene,
        start=start,
        outcome=outcome,
        good=good,
        about=f"trial {index}, by plan: {said}",
        before=f"trial {index}",
        after=f"trial {index}: {END_WORDS[outcome]}",
        after_good=good,
        whole=True,
    )


def headline(counts: dict[str, int], guaranteed: bool) -> tuple[str, bool]:
    """How the closings of a run ended, in words, and whether each may end so."""
    fine = all(_may_end(name, guaranteed) for name, count in counts.items() if count)
    parts = [f"{counts['target']} of {sum(counts.values())} closings ended in the target grasp"]
    if counts["other_grasp"]:
        parts.append(f"{counts['other_grasp']} in another grasp")
    parts.append(f"{counts['escaped']} escaped")
    parts += [
        f"{counts[name]} {name.replace('_', ' ')}"
        for name in ("jammed", "unmatched", "timed_out", "diverged")
        if counts[name]
    ]
    return ", ".join(parts), fine


def _may_end(outcome: str, sure: bool) -> bool:
    """Whether a closing may end so: in another grasp only where others are within reach."""
    return outcome == "target" or (outcome == "other_grasp" and not sure)
