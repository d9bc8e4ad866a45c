"""Closings of one scene in worlds of their own, and how they compare."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.closing.outcome import ClosingOutcomes
from sim.closing.step_check import ENDINGS
from sim.closing.varied import Worlds
from sim.closing.varied_shapes import VariedOutcomes, close_varied
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.sim.grasps import KnownGrasp


def scene_of(grasp: KnownGrasp, **changed: Any) -> Scene:
    config = SimConfig(**{"max_time": 5.0, **changed})
    return Scene(grasp.outline, grasp.hand, grasp.radius, config, instrumented=True)


def close(
    scene: Scene, starts: FloatArray, worlds: Worlds | None = None, threads: int = 1
) -> VariedOutcomes:
    count = len(starts)
    which = np.zeros(count, dtype=np.int64)
    return close_varied([scene], which, starts, worlds or Worlds.usual(count), threads)


def assert_identical(one: VariedOutcomes, other: VariedOutcomes) -> None:
    assert one.peak_force.tobytes() == other.peak_force.tobytes()
    for part in fields(ClosingOutcomes):
        a, b = getattr(one.closings, part.name), getattr(other.closings, part.name)
        assert a.tobytes() == b.tobytes(), f"{part.name} differs"


def picked(found: VariedOutcomes, rows: IntArray) -> VariedOutcomes:
    return VariedOutcomes(found.closings.picked(rows), found.peak_force[rows])


def endings(found: VariedOutcomes) -> list[str]:
    return [ENDINGS[int(code)] for code in found.closings.ending]
