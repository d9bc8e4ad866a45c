"""Do the results of closing depend on speed, time step, inertia or compliance? They must not.

The planner knows none of them. Each variant closes from the same starts as the usual settings with
one thing changed, and what counts is the difference it makes.

* Speed: under a constant pull through dampers every speed goes with the drive force, so a force
  half as large is a closing twice slower.
* Inertia: mass is measured in objects, so all masses times f is all forces and dampings over f: the
  same speeds, and f times as long until they are forgotten (object mass / ``object_damping``).
* Compliance: how far a finger would yield under the whole drive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from sim.closing.batch import close_many
from sim.closing.judge import Grasp, Tolerances, judge
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import SETTLED, TIMED_OUT
from sim.world.config import SimConfig
from sim.world.scene import Scene

NEAR: Final = Tolerances(0.2, 0.5, 0.2, 0.5)
"""[diameter, rad] An end is counted to the nearest grasp, if this near: how far it moved within
these is told apart, and a compliant hand moves it."""


@dataclass(frozen=True, slots=True)
class Change:
    """What a variant changes: speeds, time step and all masses over the usual ones.

    ``yielding`` is in [diameter], ``linkage_compliance`` times ``drive_force``.
    """

    speed: float = 1.0
    step: float = 1.0
    inertia: float = 1.0
    yielding: float = 0.0

    def config(self, base: SimConfig) -> SimConfig:
        """The settings changed; slower closings get more time.

        Contacts are as stiff per step as before. ``still_speed`` goes with the speed, so that
        stillness means the same rest of the way.
        """
        drive_force = base.drive_force * self.speed / self.inertia
        return replace(
            base,
            drive_force=drive_force,
            finger_damping=base.finger_damping / self.inertia,
            object_damping=base.object_damping / self.inertia,
            linkage_compliance=self.yielding / drive_force,
            time_step=base.time_step * self.step,
            max_time=base.max_time / min(self.speed, 1.0),
            still_speed=base.still_speed * self.speed,
        )


SLOWER: Final = (Change(speed=0.5), Change(step=0.5))
"""What must change nothing: twice slower, and half the time step."""

CHANGES: Final = (
    *(Change(speed=x) for x in (0.25, 0.5, 2.0, 4.0, 10.0, 30.0)),
    *(Change(step=x) for x in (0.5, 2.0, 4.0, 8.0)),
    *(Change(inertia=x) for x in (0.1, 2.0, 10.0, 30.0, 100.0)),
    *(Change(yielding=x) for x in (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)),
)
"""One thing at a time, from harmless to wild."""


@dataclass(frozen=True, slots=True)
class Variant:
    """One change against the usual settings.

    Attributes
    ----------
    changed:
        Closings that ended in another grasp (the nearest, within ``NEAR``) or with another outcome
        than with usual settings.
    timed_out:
        Closings that were not still in time; by pose they are counted like all others.
    position, angle:
        [diameter], [rad] Largest difference of the ends among those that ended in the same one.
    penetration:
        [diameter] Deepest disc in any closing.
    """

    change: Change
    trials: int
    changed: int
    timed_out: int
    position: float
    angle: float
    penetration: float

    @property
    def same(self) -> bool:
        """Whether no end changed beyond what counts as reaching a grasp (1e-4, 1e-3 rad)."""
        near = Tolerances()
        return (
            self.changed == 0
            and self.position <= near.target_position
            and self.angle <= near.target_angle
        )


def compare(
    scene: Scene,
    grasps: Sequence[Grasp],
    starts: FloatArray,
    changes: Sequence[Change],
    threads: int = 0,
) -> tuple[Variant, ...]:
    """Close from the starts (N, 4) with the usual settings and with each change."""
    waits = replace(scene.config, remains=0.0)  # ends are compared far below what remains
    usual = close_many(_with(scene, waits), starts, threads)
    found: list[Variant] = []
    for change in changes:
        other = close_many(_with(scene, change.config(waits)), starts, threads)
        found.append(_against(scene, grasps, usual, other, change))
    return tuple(found)


def _with(scene: Scene, config: SimConfig) -> Scene:
    return Scene(scene.outline, scene.hand, scene.finger_radius, config)


def _against(
    scene: Scene,
    grasps: Sequence[Grasp],
    usual: ClosingOutcomes,
    other: ClosingOutcomes,
    change: Change,
) -> Variant:
    was, now = (
        judge(_as_if_still(closings), grasps, scene.outline, tolerances=NEAR)
        for closings in (usual, other)
    )
    same = (was.outcome == now.outcome) & (was.grasp_id == now.grasp_id)
    held = same & (now.grasp_id >= 0)
    shift = np.abs(was.grasp_position_error - now.grasp_position_error)[held]
    turn = np.abs(was.grasp_angle_error - now.grasp_angle_error)[held]
    return Variant(
        change,
        len(usual),
        int((~same).sum()),
        int((other.ending == TIMED_OUT).sum()),
        float(shift.max(initial=0.0)),
        float(turn.max(initial=0.0)),
        float(other.penetration_max.max(initial=0.0)),
    )


def _as_if_still(closings: ClosingOutcomes) -> ClosingOutcomes:
    """Closings that ran out of time judged by where they are; they are counted apart."""
    ending = np.where(closings.ending == TIMED_OUT, SETTLED, closings.ending)
    return replace(closings, ending=ending)
