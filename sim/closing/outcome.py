"""What a closing left behind: one trial, or a thousand as a structure of arrays."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.hand import Placement
from sim.closing.step_check import ENDINGS, StepCheck

RULES: Final = "2"
"""Counts the changes to closings that change a recorded number: part of every record's versions.

2: tails are foreseen (``SimConfig.remains``) and the object's way there is computed
(``SimConfig.computed_contacts``).
"""


@dataclass(frozen=True, slots=True)
class ClosingOutcome:
    """One closing. Lengths in object diameters, placements in the case's frame and unit.

    Attributes
    ----------
    ending:
        One of ``sim.closing.look.ENDINGS``.
    steps:
        Steps taken, each of ``SimConfig.time_step``, after the free travel
        (``sim.closing.approach``).
    penetration_max, penetration_rest:
        Deepest finger disc inside the true outline, while moving and after the last step.
    shape_error_max:
        Farthest a finger was from its place in the similar triangle.
    sigma_rise_max:
        Largest sigma / sigma at the start after any step.
    finger_forces:
        (3,), [drive_force], force of the contacts on each finger after the last step.
    contacts:
        Number of the engine's contacts after the last step.
    """

    start: Placement
    end: Placement
    ending: str
    steps: int
    penetration_max: float
    penetration_rest: float
    shape_error_max: float
    sigma_rise_max: float
    finger_forces: FloatArray
    contacts: int


@dataclass(frozen=True, slots=True)
class ClosingOutcomes:
    """N closings: the arrays of ``ClosingOutcome``, with placements (N, 4) = x, y, theta, sigma.

    ``ending`` holds codes into ``sim.closing.look.ENDINGS``. Rows of diverged closings hold
    whatever the engine last had; nothing in them means anything.
    """

    start: FloatArray
    end: FloatArray
    ending: IntArray
    steps: IntArray
    penetration_max: FloatArray
    penetration_rest: FloatArray
    shape_error_max: FloatArray
    sigma_rise_max: FloatArray
    finger_forces: FloatArray
    contacts: IntArray

    def __post_init__(self) -> None:
        for one in fields(self):
            getattr(self, one.name).flags.writeable = False

    def __len__(self) -> int:
        return len(self.start)

    def __getitem__(self, i: int) -> ClosingOutcome:
        return ClosingOutcome(
            start=Placement(*self.start[i].tolist()),
            end=Placement(*self.end[i].tolist()),
            ending=ENDINGS[int(self.ending[i])],
            steps=int(self.steps[i]),
            penetration_max=float(self.penetration_max[i]),
            penetration_rest=float(self.penetration_rest[i]),
            shape_error_max=float(self.shape_error_max[i]),
            sigma_rise_max=float(self.sigma_rise_max[i]),
            finger_forces=self.finger_forces[i],
            contacts=int(self.contacts[i]),
        )

    @classmethod
    def seen(
        cls, check: StepCheck, start: FloatArray, end: FloatArray, forces: FloatArray,
        contacts: IntArray,
    ) -> ClosingOutcomes:  # fmt: skip
        """What was watched, with placements (N, 4) and what presses at the end, of any engine.

        The last step of a hand that shuts on nothing may carry its slides past zero; such a hand
        has size 0.
        """
        return cls(
            start=np.array(start),
            end=np.column_stack([end[:, :3], np.maximum(end[:, 3], 0.0)]),
            ending=check.ending.copy(),
            steps=check.steps.copy(),
            penetration_max=check.penetration_max.copy(),
            penetration_rest=check.penetration_rest.copy(),
            shape_error_max=check.shape_error_max.copy(),
            sigma_rise_max=check.sigma_rise_max.copy(),
            finger_forces=forces,
            contacts=contacts,
        )

    def picked(self, rows: IntArray) -> ClosingOutcomes:
        """Some of them, in any order."""
        return ClosingOutcomes(**{one.name: getattr(self, one.name)[rows] for one in fields(self)})

    @classmethod
    def joined(cls, parts: list[ClosingOutcomes]) -> ClosingOutcomes:
        """Several batches, one after another."""
        return cls(
            **{
                one.name: np.concatenate([getattr(part, one.name) for part in parts])
                for one in fields(cls)
            }
        )
