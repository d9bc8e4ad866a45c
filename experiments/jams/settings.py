"""Do the answers hang on the engine's settings? The same jams and ends with one of them changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from experiments.jams.closings import Ends, close_from
from icage.friction.levels import FrictionLevel
from icage.hand import Placement
from sim.grip.stick import RUBBING, moved, threshold
from sim.world.config import SimConfig

CHANGED: Final[dict[str, SimConfig]] = {
    "half the step": replace(RUBBING, time_step=0.5 * RUBBING.time_step),
    "impratio 1000": replace(RUBBING, impratio=1e3),
    "impratio 100": replace(RUBBING, impratio=1e2),
    "solver 10 times as long": replace(
        RUBBING, solver_iterations=10 * RUBBING.solver_iterations, solver_tolerance=1e-13
    ),
    "damping ratio 2": replace(RUBBING, contact_damping=2.0),
    "contacts half as stiff": replace(RUBBING, contact_solref=2.0 * RUBBING.contact_solref),
    "a third of the drive": replace(RUBBING, drive_force=RUBBING.drive_force / 3.0),
    "a tenth of the inertia": replace(
        RUBBING,
        object_damping=10.0 * RUBBING.object_damping,
        finger_damping=10.0 * RUBBING.finger_damping,
        drive_force=10.0 * RUBBING.drive_force,
    ),
}
"""One thing each against the usual ones. Cones are elliptic throughout: in the plane they are
Coulomb's."""


@dataclass(frozen=True, slots=True)
class Changed:
    """What came out with one setting changed.

    ``thresholds`` are the measured coefficients over the usual ones; of ``trials`` ends ``same``
    were in the target or outside as before, ``stray`` were where nothing holds; ``shifts`` are how
    far the ends moved [diameter, rad].
    """

    name: str
    thresholds: tuple[float, ...]
    trials: int
    same: int
    stray: int
    shifts: tuple[float, ...]
    penetration: float

    @property
    def shift(self) -> float:
        """[diameter, rad] Of 95 in a hundred ends."""
        return float(np.percentile(self.shifts, 95)) if self.shifts else 0.0

    @classmethod
    def joined(cls, name: str, parts: Sequence[Changed]) -> Changed:
        """That of several cases."""
        return cls(
            name,
            tuple(x for part in parts for x in part.thresholds),
            sum(part.trials for part in parts),
            sum(part.same for part in parts),
            sum(part.stray for part in parts),
            tuple(x for part in parts for x in part.shifts),
            max((part.penetration for part in parts), default=0.0),
        )


def change(
    name: str,
    physical: PhysicalCase,
    jams: list[tuple[Placement, float, float]],
    levels: dict[float, FrictionLevel],
    before: list[Ends],
) -> Changed:
    """Repeat thresholds and closings with the setting ``name`` of ``CHANGED``.

    ``jams`` are placements with the coefficient foretold and the one measured as usual.
    """
    config, scene = CHANGED[name], physical.simulated.scene()
    found: list[float] = []
    for place, foretold, measured in jams:
        now = threshold(scene, place.as_array(), foretold, config)
        found.append(now.sticks / measured)
    trials = same = stray = 0
    shifts = list[float]()
    deepest = 0.0
    for ends in before:
        now = close_from(physical, levels[ends.mu], ends.side, ends.starts, config)
        trials, stray = trials + len(ends), stray + int(now.stray.sum())
        same += int((now.in_target == ends.in_target).sum())
        shifts += np.maximum(*moved(scene, ends.ends, now.ends)).tolist()
        deepest = max(deepest, now.penetration)
    return Changed(name, tuple(found), trials, same, stray, tuple(shifts), deepest)
