"""A piece of a study: any trials, from their numbers to what became of them.

A result depends on the study's config, its case and the trial's number, and on nothing else: not on
the shard, the thread, the machine or on who ran before.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from experiments.io.outcome_words import NOT_CLOSED
from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.design import Design
from experiments.study.inputs.placements import Intended, collide, moved
from experiments.study.inputs.variants import Key, Variant, Variants
from experiments.study.run.worlds import slope_of, worlds_of
from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cage import Cage
from icage.case import Case
from icage.cells.membership import COLLIDES, Answers, query
from icage.tolerance import COLLISION
from sim.closing.judge import JAMMED, OUTCOMES, UNMATCHED, Tolerances, grasp_errors, judge
from sim.closing.outcome import ClosingOutcomes
from sim.closing.varied_shapes import VariedOutcomes, close_varied

STUDY_OUTCOMES: Final = (*OUTCOMES, *NOT_CLOSED)

COLLISION_AT_START, NOT_CAGED, NO_SHAPE = (len(OUTCOMES) + k for k in range(3))

_NEAREST: Final = 3
"""Other grasps of the plan that an end on a variant is compared with."""


@dataclass(frozen=True, slots=True, eq=False)
class Study:
    """A config with its case, planned: what every shard needs."""

    config: StudyConfig
    case: Case
    cage: Cage
    design: Design = field(init=False)
    intended: Intended = field(init=False, repr=False)
    variants: Variants = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "design", Design.of(self.config))
        object.__setattr__(self, "intended", Intended(self.config, self.cage))
        object.__setattr__(self, "variants", Variants(self.config, self.cage))


@dataclass(frozen=True, slots=True, eq=False)
class Ran:
    """Trials (n): everything that a row of the table is made of.

    Attributes
    ----------
    done:
        (m,) rows that were closed; ``closings`` has those only.
    """

    trials: IntArray
    values: dict[str, FloatArray]
    meant: FloatArray
    starts: FloatArray
    answers: Answers
    outcome: IntArray
    grasp_id: IntArray
    errors: FloatArray
    done: IntArray
    closings: VariedOutcomes
    variants: list[Variant]
    which: IntArray

    @property
    def sizes(self) -> FloatArray:
        """(n,) diameters of the true objects: what the engine calls 1."""
        return np.array([variant.outline.diameter for variant in self.variants])[self.which]


def run_trials(study: Study, trials: IntArray) -> Ran:
    """Draw, close and judge trials (n,), given in ascending order."""
    config, cage, design = study.config, study.cage, study.design
    values = design.values(trials)
    meant = study.intended.placements(*design.streams(trials))
    planned_middle = np.full(len(trials), complex(cage.hand.z.mean()))
    seen = moved(meant, values, cage, planned_middle)
    answers = query(cage, _askable(seen))
    outcome = np.full(len(trials), -1, dtype=np.int64)
    if config.uncaged == "skip":
        outcome[~answers.in_cage & (answers.verdict != COLLIDES)] = NOT_CAGED
    variants, which = _variants(study, values, trials)
    middles = np.array([0j if v is None else complex(v.hand.z.mean()) for v in variants])
    starts = moved(meant, values, cage, middles[which])
    for number, variant in enumerate(variants):
        rows = np.flatnonzero((outcome < 0) & (which == number))
        if variant is None:
            outcome[rows] = NO_SHAPE
        else:
            outcome[rows[_collide(variant, starts[rows])]] = COLLISION_AT_START
    done = np.flatnonzero(outcome < 0)
    known = [v or study.variants.planned for v in variants]
    worlds = worlds_of(values, starts, np.array([v.outline.diameter for v in known])[which])
    closings = close_varied([v.scene for v in known], which[done], starts[done], worlds[done])
    errors = np.full((len(trials), 2), np.nan)
    grasp_id = np.full(len(trials), -1, dtype=np.int64)
    for number in np.unique(which[done]).tolist():
        here = np.flatnonzero(which[done] == number)
        rows = done[here]
        found = _judged(study, known[number], closings.closings.picked(here))
        outcome[rows], grasp_id[rows], errors[rows] = found
    rough = (worlds.friction > 0.0) | (worlds.table_friction > 0.0)
    held_up = rough | slope_of(values).pulls
    outcome[(outcome == UNMATCHED) & held_up] = JAMMED
    return Ran(
        trials, values, meant, starts, answers, outcome, grasp_id, errors, done, closings, known,
        which,
    )  # fmt: skip


def _askable(placements: FloatArray) -> FloatArray:
    """Placements that can be asked about: a hand cannot be smaller than shut."""
    rows = np.array(placements)
    rows[:, 3] = np.maximum(rows[:, 3], 0.0)
    return rows


def _variants(
    study: Study, values: dict[str, FloatArray], trials: IntArray
) -> tuple[list[Variant | None], IntArray]:
    """The variants of trials (n,), each once, and which one each trial has."""
    keys = study.variants.keys(values, study.design.shapes(trials))
    which = np.zeros(len(trials), dtype=np.int64)
    if keys and not any(keys):
        return [study.variants.planned], which
    number: dict[Key, int] = {}
    for row, key in enumerate(keys):
        which[row] = number.setdefault(key, len(number))
    return [study.variants.make(key) for key in number], which


def _collide(variant: Variant, starts: FloatArray) -> BoolArray:
    """(n,) which hands at starts (n, 4) touch the variant's object, or are shut."""
    hits = ~(starts[:, 3] > 0.0)
    fingers = variant.hand.fingers(starts[~hits])
    hits[~hits] = collide(variant.outline, fingers, variant.finger_radius, COLLISION)
    return hits


def _judged(
    study: Study, variant: Variant, closings: ClosingOutcomes
) -> tuple[IntArray, IntArray, FloatArray]:
    """Outcome (k,), grasp (k,) and errors (k, 2) of closings of one variant.

    On a variant, an end off the target is compared with the grasps of the plan nearest to it, at
    their places there: with its own ones, so that no other trial decides what it is called.
    """
    config, grasps = study.config, study.cage.grasps
    near = config.position_tolerance, config.angle_tolerance
    tolerances = Tolerances(*near, *near)
    if variant.planned:
        found = judge(closings, grasps, variant.outline, tolerances=tolerances)
        return found.outcome, found.grasp_id, _errors(found)
    places = {0: study.variants.grasps(variant, grasps[:1])[0]}
    found = judge(closings, [places[0]], variant.outline, tolerances=tolerances)
    outcome, grasp_id = found.outcome.copy(), found.grasp_id.copy()
    astray = np.flatnonzero(outcome == UNMATCHED)
    ends = closings.end[astray]
    seen = [grasp_errors(ends, grasp, study.cage.outline) for grasp in grasps[1:]]
    off = np.array([np.maximum(at / near[0], turn / near[1]) for at, turn in seen])
    for row, far in zip(astray.tolist(), off.reshape(len(seen), len(astray)).T, strict=True):
        nearest = 1 + np.argsort(far, kind="stable")[:_NEAREST]
        for k in nearest.tolist():
            if k not in places:
                places[k] = study.variants.grasps(variant, grasps[k : k + 1])[0]
        mine = [places[k] for k in (0, *nearest.tolist())]
        one = judge(closings.picked(np.array([row])), mine, variant.outline, tolerances=tolerances)
        outcome[row], grasp_id[row] = one.outcome[0], one.grasp_id[0]
    return outcome, grasp_id, _errors(found)


def _errors(verdicts: Any) -> FloatArray:
    return np.column_stack([verdicts.position_error, verdicts.angle_error])
