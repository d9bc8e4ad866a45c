"""Hand and object in one compiled model, and the border between the planner's frame and it.

Frames: B is the object's frame in the case's unit, P = W the palm's, normalized. The planner speaks
of X_BP (the hand seen from the object), the engine of X_PB (the object seen from the hand); only
this file converts.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from icage.arrays import FloatArray
from icage.hand import HandShape
from icage.outline import Outline
from sim.world.config import SimConfig
from sim.world.engine import MjModel, MjSpec
from sim.world.hand_model import HandKinematics, add_instruments, build_hand
from sim.world.object_model import NormalObject, add_object

POSITIONS = 6
"""qpos = three finger slides, then the object's x, y and turn."""


@dataclass(frozen=True, slots=True)
class Scene:
    """One object and one hand, compiled.

    Parameters
    ----------
    outline, hand, finger_radius:
        In the object's frame and unit.
    instrumented:
        With a touch sensor on each finger, and gravity that acts on the object only.
    """

    outline: Outline
    hand: HandShape
    finger_radius: float
    config: SimConfig
    instrumented: bool = False
    object: NormalObject = field(init=False, repr=False)
    kinematics: HandKinematics = field(init=False, repr=False)
    model: MjModel = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        normal = NormalObject(self.outline)
        object.__setattr__(self, "object", normal)
        object.__setattr__(self, "kinematics", HandKinematics(self.hand))
        object.__setattr__(self, "model", self.spec(visuals=False).compile())

    def spec(self, visuals: bool = True) -> MjSpec:
        """A fresh spec of the whole scene; with visuals, for whoever adds lights and cameras."""
        radius = self.finger_radius / self.outline.diameter
        spec = build_hand(self.hand, radius, self.config, visuals)
        spec.modelname = "icage_scene"
        add_object(spec, self.object, self.config)
        if self.instrumented:
            add_instruments(spec, radius)
            spec.body("object").simple = 0  # its centre of mass may be moved
        return spec

    @property
    def closing_force(self) -> float:
        """[mass diameter / s^2] The motor's control while closing: a constant pull."""
        return -self.config.drive_force * self.kinematics.spread

    def start_positions(self, placements: FloatArray) -> FloatArray:
        """Positions (N, 6) of placements (N, 4) = x, y, theta, sigma in B.

        The slides are consistent with the linkage. With c the object's centroid, the palm stands at
        p = d + sigma e^{i theta} z_c in B, so the object at -e^{-i theta} (p - c), turned -theta.
        """
        rows = np.atleast_2d(np.asarray(placements, dtype=np.float64))
        theta, sigma = rows[:, 2], rows[:, 3] / self.object.diameter
        x, y = ((rows[:, :2] - self.object.centre) / self.object.diameter).T
        back = np.exp(-1j * theta)
        object_at = -back * (x + 1j * y) - sigma * self.kinematics.centroid
        slides = sigma[:, None] * self.kinematics.lengths
        return np.column_stack([slides, object_at.real, object_at.imag, -theta])

    def placements(self, qpos: FloatArray) -> FloatArray:
        """Placements (N, 4) in B of positions (N, 6): inverse of ``start_positions``."""
        rows = np.atleast_2d(np.asarray(qpos, dtype=np.float64))
        sigma = self.sigma(rows)
        theta = -rows[:, 5]
        object_at = rows[:, 3] + 1j * rows[:, 4]
        d = -np.exp(1j * theta) * (object_at + sigma * self.kinematics.centroid)
        xy = np.column_stack([d.real, d.imag]) * self.object.diameter + self.object.centre
        return np.column_stack([xy, theta, sigma * self.object.diameter])

    def sigma(self, qpos: FloatArray) -> FloatArray:
        """[diameter] The tendon's length, (N,), summed the same way for any N."""
        first, second, third = self.kinematics.tendon_coefficients.tolist()
        return first * qpos[:, 0] + second * qpos[:, 1] + third * qpos[:, 2]
