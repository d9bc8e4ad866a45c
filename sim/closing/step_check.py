"""What is seen of closings while they run, in rows: the record that ``sim.closing.look`` keeps."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import FloatArray, IntArray
from sim.closing.look import (
    DEPTH,
    DEPTH_MAX,
    FIELDS,
    RISE_MAX,
    SHAPE_MAX,
    SIGMA_START,
    TAIL_FIELDS,
    TOUCHES,
    Bounds,
    Record,
    Shape,
    observe,
)
from sim.closing.look import DIVERGED as DIVERGED
from sim.closing.look import ENDINGS as ENDINGS
from sim.closing.look import PINCHED as PINCHED
from sim.closing.look import RUNNING as RUNNING
from sim.closing.look import SETTLED as SETTLED
from sim.closing.look import TIMED_OUT as TIMED_OUT
from sim.closing.look import TOUCHING as TOUCHING
from sim.closing.look import EndingCode as EndingCode
from sim.closing.near_edges import near_edges
from sim.world.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable

_RUNNING = int(RUNNING)
"""Numpy looks for six special methods of an enum at every comparison, and of a number for none."""


@dataclass(frozen=True, slots=True)
class StepCheck:
    """The running record of N closings of one scene, a row each; updated in place.

    Attributes
    ----------
    steps, ending:
        (N,) integers; ``ending`` is a code into ``ENDINGS``.
    stride:
        [step] Between two looks.
    told:
        What the compiled loops read and update.
    """

    scene: Scene
    steps: IntArray
    ending: IntArray
    stride: int
    _max_steps: IntArray
    _remains: FloatArray
    _tail: FloatArray
    _apart: FloatArray
    _still: IntArray
    _seen: FloatArray
    told: tuple[Shape, Bounds, Record] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # what the compiled loop reads and updates is the same at every look: gathered once
        scene, config, kinematics = self.scene, self.scene.config, self.scene.kinematics
        vertices, radius = scene.object.vertices, scene.finger_radius / scene.object.diameter
        shape = Shape(
            vertices,
            near_edges(vertices, radius, len(self.steps)),
            radius,
            kinematics.directions,
            kinematics.lengths,
            kinematics.tendon_coefficients,
        )
        bounds = Bounds(
            config.pinched_size / kinematics.longest_side,
            config.still_speed,
            config.still_steps,
            self.stride,
            config.time_step,
        )
        record = Record(
            self._max_steps, self._remains, self._tail, self._apart, self._seen, self._still,
            self.steps, self.ending,
        )  # fmt: skip
        object.__setattr__(self, "told", (shape, bounds, record))

    @classmethod
    def over(
        cls,
        scene: Scene,
        qpos: FloatArray,
        stride: int = 1,
        patience: FloatArray | None = None,
        remains: FloatArray | None = None,
    ) -> StepCheck:
        """Start watching closings that start from qpos (N, 6), every ``stride`` steps.

        ``patience`` (N,) multiplies the scene's time until a closing
        has timed out. ``remains`` (N,) stands for the scene's own; 0 where anything but the motor
        and the dampers acts, or in another engine.
        """
        count = len(qpos)
        longer = np.ones(count) if patience is None else patience
        seen = np.zeros((count, FIELDS))
        seen[:, SIGMA_START] = scene.sigma(qpos)
        rest = scene.config.remains if scene.config.friction == 0.0 else 0.0
        return cls(
            scene,
            steps=np.zeros(count, dtype=np.int64),
            ending=np.full(count, RUNNING, dtype=np.int64),
            stride=stride,
            _max_steps=np.ceil(scene.config.max_steps * longer).astype(np.int64),
            _remains=np.full(count, rest) if remains is None else remains,
            _tail=np.zeros((count, TAIL_FIELDS)),
            _apart=np.zeros((count, 3, 3)),
            _still=np.zeros(count, dtype=np.int64),
            _seen=seen,
        )

    def observe(self, ids: IntArray, qpos: FloatArray, qvel: FloatArray) -> IntArray:
        """Look at the closings ``ids`` after ``stride`` more steps; those of them that go on.

        qpos and qvel are (N, 6).
        """
        look: Callable[..., IntArray] = observe
        return look(ids, qpos, qvel, *self.told)

    def diverged(self, ids: IntArray) -> None:
        """Note that the engine gave up on, or warned about, these closings."""
        self.ending[ids] = DIVERGED

    @property
    def running(self) -> IntArray:
        """Ids of the closings that have not ended."""
        return np.flatnonzero(self.ending == _RUNNING)

    @property
    def touches(self) -> FloatArray:
        """(N,) fingers that touched the outline at the last look."""
        return self._seen[:, TOUCHES]

    @property
    def penetration_max(self) -> FloatArray:
        """[diameter] (N,) deepest disc over all steps."""
        return self._seen[:, DEPTH_MAX]

    @property
    def penetration_rest(self) -> FloatArray:
        """[diameter] (N,) deepest disc after the last step."""
        return self._seen[:, DEPTH]

    @property
    def shape_error_max(self) -> FloatArray:
        """[diameter] (N,) farthest a finger was from its place in the similar triangle."""
        return self._seen[:, SHAPE_MAX]

    @property
    def sigma_rise_max(self) -> FloatArray:
        """[1] (N,) largest sigma / sigma at the start over all steps: above 1 the hand opened."""
        return self._seen[:, RISE_MAX]
