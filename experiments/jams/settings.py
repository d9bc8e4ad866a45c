"""Do the answers hang on the engine's settings? The same jams and ends with one of them changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from experiments.cases.with_discs import PhysicalCase
from experiments.jams.closings import Ends, close_from
from icage.friction.levels import FrictionLevel
from icage.hand import Placement
from sim.grip.stick import AT_REST, RUBBING, moved, threshold
from sim.world.config import SimConfig

CHANGED: Final[dict[str, Callable[[SimConfig], SimConfig]]] = {
    "half the step": lambda usual: replace(usual, time_step=0.5 * usual.time_step),
    "impratio 1000": lambda usual: replace(usual, impratio=1e3),
    "impratio 100": lambda usual: replace(usual, impratio=1e2),
    "solver 10 times as long": lambda usual: replace(
        usual, solver_iterations=10 * usual.solver_iterations, solver_tolerance=1e-13
    ),
    "damping ratio 3": lambda usual: replace(usual, contact_damping=3.0),
    "contacts half as stiff": lambda usual: replace(usual, contact_solref=2 * usual.contact_solref),
    "a third of the drive": lambda usual: replace(usual, drive_force=usual.drive_force / 3.0),
    "a tenth of the inertia": lambda usual: replace(
        usual,
        object_damping=10.0 * usual.object_damping,
        finger_damping=10.0 * usual.finger_damping,
        drive_force=10.0 * usual.drive_force,
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
    other, scene = CHANGED[name], physical.simulated.scene()
    found: list[float] = []
    for place, foretold, measured in jams:
        now = threshold(scene, place.as_array(), foretold, other(AT_REST))
        found.append(now.sticks / measured)
    trials = same = stray = 0
    shifts = list[float]()
    deepest = 0.0
    for ends in before:
        now = close_from(physical, levels[ends.mu], ends.side, ends.starts, other(RUBBING))
        trials, stray = trials + len(ends), stray + int(now.stray.sum())
        same += int((now.in_target == ends.in_target).sum())
        shifts += np.maximum(*moved(scene, ends.ends, now.ends)).tolist()
        deepest = max(deepest, now.penetration)
    return Changed(name, tuple(found), trials, same, stray, tuple(shifts), deepest)
