"""Do the results of closing depend on how fast it is, or on the time step? They must not.

The planner knows no speed. Under a constant pull through dampers every speed goes with the drive
force, so a force half as large is a closing twice slower. Each variant closes from the same starts
as the usual settings, and what counts is the difference it makes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from icage.arrays import FloatArray
from sim.batch import close_many
from sim.config import SimConfig
from sim.judge import Grasp, judge
from sim.outcome import ClosingOutcomes
from sim.scene import Scene
from sim.watch import SETTLED, TIMED_OUT

SPEEDS: Final = (0.25, 0.5, 2.0, 4.0, 10.0, 30.0)
"""[1] Drive forces over the usual one: twice and four times slower, then ever faster."""

STEPS: Final = (0.5, 2.0, 4.0, 8.0)
"""[1] Time steps over the usual one."""


@dataclass(frozen=True, slots=True)
class Variant:
    """One setting against the usual one.

    Attributes
    ----------
    speed, step:
        Drive force and time step over the usual ones.
    changed:
        Closings that ended in another grasp, or with another outcome, than with usual settings.
    timed_out:
        Closings that were not still in time; by pose they are counted like all others.
    position, angle:
        [diameter], [rad] Largest difference of the ends among those that ended in the same one.
    penetration:
        [diameter] Deepest disc in any closing.
    """

    speed: float
    step: float
    trials: int
    changed: int
    timed_out: int
    position: float
    angle: float
    penetration: float

    @property
    def same(self) -> bool:
        """Whether no end changed beyond what counts as reaching a grasp (1e-4, 1e-3 rad)."""
        return self.changed == 0 and self.position <= 1e-4 and self.angle <= 1e-3


def variant_config(base: SimConfig, speed: float, step: float) -> SimConfig:
    """Settings with another speed and time step; slower closings get more time.

    Contacts are as stiff per step as before. ``still_speed`` goes with the speed, so that stillness
    means the same rest of the way.
    """
    return replace(
        base,
        drive_force=base.drive_force * speed,
        time_step=base.time_step * step,
        max_time=base.max_time / min(speed, 1.0),
        still_speed=base.still_speed * speed,
    )


def compare(
    scene: Scene,
    grasps: Sequence[Grasp],
    starts: FloatArray,
    variants: Sequence[tuple[float, float]],
    threads: int = 0,
) -> tuple[Variant, ...]:
    """Close from the starts (N, 4) with the usual settings and with each (speed, step)."""
    usual = close_many(scene, starts, threads)
    found: list[Variant] = []
    for speed, step in variants:
        config = variant_config(scene.config, speed, step)
        other_scene = Scene(scene.outline, scene.hand, scene.finger_radius, config)
        other = close_many(other_scene, starts, threads)
        found.append(_against(scene, grasps, usual, other, speed, step))
    return tuple(found)


def _against(
    scene: Scene,
    grasps: Sequence[Grasp],
    usual: ClosingOutcomes,
    other: ClosingOutcomes,
    speed: float,
    step: float,
) -> Variant:
    was, now = (judge(_as_if_still(c), grasps, scene.outline) for c in (usual, other))
    same = (was.outcome == now.outcome) & (was.grasp_id == now.grasp_id)
    held = same & (now.grasp_id >= 0)
    shift = np.abs(was.grasp_position_error - now.grasp_position_error)[held]
    turn = np.abs(was.grasp_angle_error - now.grasp_angle_error)[held]
    return Variant(
        speed,
        step,
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
