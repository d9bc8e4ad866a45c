"""Where did a closing end? Judged by pose; sigma alone hardly sees orientation.

A three-edge grasp obeys sigma = sigma_0 / cos(theta): at an excess of 1e-6 the object may still be
turned by 1.4e-3 rad. So the object's pose in the hand frame (origin finger 1, x axis towards
finger 2) is compared: the displacement of its area centroid and its rotation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.hand import Placement
from icage.outline import Outline
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import DIVERGED, PINCHED, SETTLED, TIMED_OUT


class OutcomeCode(IntEnum):
    """Where a closing ended.

    jammed: at rest in no grasp, held by friction. unmatched: at rest without friction, in none of
    the given grasps. From the plan's own cage that means that plan or physics is wrong; from other
    starts, and with another object, hand or gravity than planned, there may be more grasps.
    """

    TARGET = 0
    OTHER_GRASP = 1
    JAMMED = 2
    ESCAPED = 3
    DIVERGED = 4
    TIMED_OUT = 5
    UNMATCHED = 6


OUTCOMES = tuple(code.name.lower() for code in OutcomeCode)
"""The words for the codes, in their order: those of files and reports."""

TARGET, OTHER_GRASP, JAMMED, ESCAPED, DID_DIVERGE, DID_TIME_OUT, UNMATCHED = OutcomeCode


class Grasp(Protocol):
    """What is read of an immobilizing grasp (the planner's ``GraspMinimum`` has more)."""

    @property
    def id(self) -> int:
        """Number of the grasp; the target is the first of the sequence."""
        ...

    @property
    def contacts(self) -> FloatArray:
        """Finger centres, (3, 2), in the object's frame."""
        ...

    @property
    def plateau(self) -> tuple[FloatArray, FloatArray] | None:
        """Finger centres at both ends of a plateau of equal sigma, or None."""
        ...


@dataclass(frozen=True, slots=True)
class Tolerances:
    """How near is there: positions in object diameters, angles in [rad]."""

    target_position: float = 1e-4
    target_angle: float = 1e-3
    other_position: float = 1e-3
    other_angle: float = 1e-3


@dataclass(frozen=True, slots=True)
class Verdicts:
    """Judgement of N closings.

    Attributes
    ----------
    outcome:
        (N,) codes into ``OUTCOMES``.
    grasp_id:
        (N,) id of the grasp ended in, -1 for none.
    position_error, angle_error:
        (N,) against the *target*, [diameter] and [rad], wherever the closing ended; nan if it
        diverged.
    grasp_position_error, grasp_angle_error:
        (N,) against the nearest listed grasp.
    """

    outcome: IntArray
    grasp_id: IntArray
    position_error: FloatArray
    angle_error: FloatArray
    grasp_position_error: FloatArray
    grasp_angle_error: FloatArray

    def counts(self) -> dict[str, int]:
        """Trials per outcome, every outcome named."""
        return {name: int((self.outcome == k).sum()) for k, name in enumerate(OUTCOMES)}


@dataclass(frozen=True, slots=True)
class TrialRecord:
    """One trial, closed and judged: what a table of trials holds per row."""

    trial: int
    start: Placement
    end: Placement
    outcome: str
    grasp_id: int
    position_error: float
    angle_error: float
    penetration_max: float
    penetration_rest: float
    steps: int


def judge(
    closings: ClosingOutcomes,
    grasps: Sequence[Grasp],
    outline: Outline,
    *,
    friction: bool = False,
    tolerances: Tolerances | None = None,
) -> Verdicts:
    """Name the outcome of every closing; ``grasps[0]`` is the target."""
    near = tolerances or Tolerances()
    ends = np.where((closings.ending == DIVERGED)[:, None], np.nan, closings.end)
    errors = [grasp_errors(ends, grasp, outline) for grasp in grasps]
    position = np.array([error[0] for error in errors])
    angle = np.array([error[1] for error in errors])
    distance = np.maximum(position / near.other_position, angle / near.other_angle)
    best = np.where(np.isnan(distance), np.inf, distance).argmin(axis=0)
    rows = np.arange(len(closings))
    is_target = best == 0
    reach_position = np.where(is_target, near.target_position, near.other_position)
    reach_angle = np.where(is_target, near.target_angle, near.other_angle)
    reached = (position[best, rows] <= reach_position) & (angle[best, rows] <= reach_angle)
    held = (closings.ending == SETTLED) & reached
    outcome = np.full(len(closings), JAMMED if friction else UNMATCHED, dtype=np.int64)
    outcome[held] = np.where(is_target[held], TARGET, OTHER_GRASP)
    outcome[closings.ending == PINCHED] = ESCAPED
    outcome[closings.ending == TIMED_OUT] = DID_TIME_OUT
    outcome[closings.ending == DIVERGED] = DID_DIVERGE
    ids = np.array([grasp.id for grasp in grasps], dtype=np.int64)
    return Verdicts(
        outcome=outcome,
        grasp_id=np.where(held, ids[best], -1),
        position_error=position[0],
        angle_error=angle[0],
        grasp_position_error=position[best, rows],
        grasp_angle_error=angle[best, rows],
    )


def grasp_errors(ends: FloatArray, grasp: Grasp, outline: Outline) -> tuple[FloatArray, FloatArray]:
    """Errors (N,), (N,) of placements (N, 4) against one grasp, [diameter] and [rad].

    Against a plateau: distance to the segment between the poses at its two ends.
    """
    first, last = grasp.plateau or (grasp.contacts, grasp.contacts)
    place_a = Placement.from_contacts(first).as_array()[None, :]
    place_b = Placement.from_contacts(last).as_array()[None, :]
    a, b = _centroid_in_hand(place_a, outline)[0], _centroid_in_hand(place_b, outline)[0]
    seen = _centroid_in_hand(ends, outline)
    span = b - a
    length_squared = abs(span) ** 2
    if length_squared > 0.0:
        share = np.clip(((seen - a) * np.conj(span)).real / length_squared, 0.0, 1.0)
    else:
        share = np.zeros(len(seen))
    turn = _wrapped(place_b[0, 2] - place_a[0, 2])
    position = np.abs(seen - (a + share * span)) / outline.diameter
    angle = np.abs(_wrapped(ends[:, 2] - place_a[0, 2] - share * turn))
    return position, angle


def _centroid_in_hand(placements: FloatArray, outline: Outline) -> np.ndarray:
    """Area centroid in the hand frame, (N,) complex: e^{-i theta} (c - d)."""
    x, y = outline.centroid.tolist()
    offset = (x - placements[:, 0]) + 1j * (y - placements[:, 1])
    return np.exp(-1j * placements[:, 2]) * offset


def _wrapped(angle: FloatArray) -> FloatArray:
    """Angles brought to [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % (2.0 * np.pi) - np.pi


def trial_records(closings: ClosingOutcomes, verdicts: Verdicts) -> list[TrialRecord]:
    """Rows for a table, one per trial."""
    return [
        TrialRecord(
            trial=i,
            start=closings[i].start,
            end=closings[i].end,
            outcome=OUTCOMES[int(verdicts.outcome[i])],
            grasp_id=int(verdicts.grasp_id[i]),
            position_error=float(verdicts.position_error[i]),
            angle_error=float(verdicts.angle_error[i]),
            penetration_max=float(closings.penetration_max[i]),
            penetration_rest=float(closings.penetration_rest[i]),
            steps=int(closings.steps[i]),
        )
        for i in range(len(closings))
    ]
