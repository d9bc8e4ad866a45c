"""One hand and one object in Chipmunk2D: the other engine's ``sim.world.scene``.

Frames, units and numbers are those of the ``Scene`` it is made from: the palm's frame, diameter 1,
mass 1, moment ``gyration_squared``, a viscous table, the same true outline in convex pieces, discs
of the same radius. Chipmunk has no slides that are geared to one another, but it has
turning bodies that are: so finger k is the tip of an *arm* of length R L_k,

    p_k(a) = R L_k (sin a u_k - (1 - cos a) m_k),    sigma = R sin a,

with R = 1e7 diameters. m_k is u_k turned by -90 degrees, so the tip moves along u_k; in all of a
closing it leaves that line by L_k sigma^2 / 2 R < 1e-7. The three arms are so heavy that they can
only turn, and two ``GearJoint`` of ratio 1 make them turn alike. That is the linkage, solved
together with the contacts.

What gears cannot do is follow the *position correction* of contacts, which moves one body at a
time. So after every step the angles and speeds are projected on the linkage, weighted by mass
(arms of equal tip mass, moment proportional to L_k^2):

    a = sum L_k^2 a_k / sum L_k^2.

``qpos`` is read before that projection: its shape error is what the engine itself left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from sim.chipmunk.engine import Body, Space, chipmunk
from sim.closing.step_check import TOUCHING
from sim.world.scene import Scene

ARM: Final = 1e7
"""[diameter] R: tips leave their rail by 1 / 2 R, and doubles resolve R to 2e-9."""

_UNMOVED: Final = 1e100
"""[mass] Of an arm: only its moment counts."""

_FINGERS: Final = 1
"""Group of shapes that do not touch one another."""


@dataclass(frozen=True, slots=True)
class SecondConfig:
    """Settings of the second engine that ``SimConfig`` does not have, each with its reason."""

    iterations: int = 40
    """Sweeps of the impulse solver per step; impulses are kept from step to step."""

    correction: float = 0.03
    """[1] Share of the depth beyond ``slop`` that is taken back per step. It moves one body at a
    time, so the shape error grows with it: on the saw 8e-6, and 1.0e-5 with 0.04."""

    slop: float = 6e-6
    """[diameter] Depth left alone, so that a contact at rest stays a contact. One that is lost for
    a step comes back up to 1e-4 deep, and taking that back loses others: with 1e-7 closings of the
    L (three fingers, four contacts) went round like that until they timed out."""


@dataclass(frozen=True, slots=True, eq=False)
class World:
    """One trial: a space with three arms and the object, at rest at ``qpos`` (6,).

    Parameters
    ----------
    opening:
        [diameter] A stop on sigma; inf for none.
    """

    scene: Scene
    start: FloatArray
    config: SecondConfig = SecondConfig()
    opening: float = math.inf
    space: Space = field(init=False, repr=False)
    arms: list[Body] = field(init=False, repr=False)
    body: Body = field(init=False, repr=False)
    _reach: list[float] = field(init=False, repr=False)
    _shares: list[float] = field(init=False, repr=False)
    _delay: float = field(init=False, repr=False)
    _step: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        config, kinematics = self.scene.config, self.scene.kinematics
        if config.linkage_compliance > 0.0:
            raise InputError("the second engine has only the rigid linkage")
        engine = chipmunk()
        put = object.__setattr__
        put(self, "_reach", (ARM * kinematics.lengths).tolist())
        put(self, "_shares", (kinematics.lengths * kinematics.tendon_coefficients).tolist())
        put(self, "_delay", 1.0 + config.time_step * config.object_damping)
        put(self, "_step", config.time_step)
        put(self, "space", _space(engine, self.scene, self.config))
        put(self, "arms", [_arm(engine, self.space, self.scene, k) for k in range(3)])
        put(self, "body", _body(engine, self.space, self.scene))
        _link(engine, self.space, self.arms, self.opening)
        x, y, turn = self.start[3:].tolist()
        self.body.position, self.body.angle = (x, y), turn
        self._turn_to(math.asin(float(self.scene.sigma(self.start[None])[0]) / ARM), 0.0)

    def step(
        self, motor: float, wrench: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> FloatArray:
        """One time step under the motor's control and a wrench on the object: qpos, qvel (12,).

        The speeds are what the positions changed by, corrections of depth included. Forces are
        divided by 1 + h d / m, as speeds are, so that the free object moves at force / damping.
        """
        before = self.positions()
        pull = motor * ARM / self._delay
        for arm, share in zip(self.arms, self._shares, strict=True):
            arm.torque = pull * share
        if any(wrench):
            self.body.force = (wrench[0] / self._delay, wrench[1] / self._delay)
            self.body.torque = wrench[2] / self._delay
        self.space.step(self._step)
        after = self.positions()
        angle = speed = 0.0
        for arm, share in zip(self.arms, self._shares, strict=True):
            angle += share * arm.angle
            speed += share * arm.angular_velocity
        self._turn_to(angle, speed)
        return np.array(after + [(b - a) / self._step for a, b in zip(before, after, strict=True)])

    def positions(self) -> list[float]:
        """The qpos (6,), as in MuJoCo's scene."""
        slides = [r * math.sin(arm.angle) for r, arm in zip(self._reach, self.arms, strict=True)]
        return [*slides, *self.body.position, self.body.angle]

    def press(self) -> tuple[FloatArray, int]:
        """Forces on the fingers in the last step, (3,) [drive_force], and how many contacts."""
        forces, count = np.zeros(3), 0

        def note(arbiter: Any, into: list[complex]) -> None:
            into.append(complex(*arbiter.total_impulse))

        for k, arm in enumerate(self.arms):
            impulses: list[complex] = []
            arm.each_arbiter(note, impulses)
            forces[k], count = abs(sum(impulses)), count + len(impulses)
        return forces * self._delay / (self._step * self.scene.config.drive_force), count

    def _turn_to(self, angle: float, speed: float) -> None:
        for arm in self.arms:
            arm.angle, arm.angular_velocity = angle, speed


def _space(engine: Any, scene: Scene, config: SecondConfig) -> Space:
    step, rate = scene.config.time_step, scene.config.object_damping
    space = engine.Space()
    space.iterations = config.iterations
    space.collision_slop = config.slop
    space.collision_bias = (1.0 - config.correction) ** (1.0 / step)
    space.damping = (1.0 + step * rate) ** (-1.0 / step)
    return space


def _arm(engine: Any, space: Space, scene: Scene, k: int) -> Body:
    """Tip mass such that the common decay time of the space gives the finger its damping.

    The disc is larger by ``TOUCHING``: what the engine holds, ``sim.closing.look`` then sees
    touching.
    """
    config, kinematics = scene.config, scene.kinematics
    reach = ARM * float(kinematics.lengths[k])
    mass = config.finger_damping / config.object_damping
    x, y = kinematics.directions[k].tolist()
    arm = engine.Body(_UNMOVED, mass * reach * reach)
    arm.position = (-reach * y, reach * x)
    radius = scene.finger_radius / scene.object.diameter + TOUCHING
    tip = engine.Circle(arm, radius, (reach * y, -reach * x))
    tip.filter = engine.ShapeFilter(group=_FINGERS)
    tip.friction = math.sqrt(config.friction)  # the engine multiplies those of two shapes
    space.add(arm, tip)
    return arm


def _body(engine: Any, space: Space, scene: Scene) -> Body:
    body = engine.Body(1.0, scene.object.gyration_squared)
    space.add(body)
    for piece in scene.object.pieces:
        solid = engine.Poly(body, [tuple(corner) for corner in piece.tolist()])
        solid.friction = math.sqrt(scene.config.friction)
        space.add(solid)
    return body


def _link(engine: Any, space: Space, arms: list[Body], opening: float) -> None:
    """Gears of ratio 1, in a ring so that no finger is favoured, and on the first arm the stop."""
    for one, other in ((arms[0], arms[1]), (arms[1], arms[2]), (arms[2], arms[0])):
        gear = engine.GearJoint(one, other, 0.0, 1.0)
        gear.error_bias = 1.0  # the projection corrects positions; this would add speed
        space.add(gear)
    if math.isfinite(opening):
        space.add(engine.RotaryLimitJoint(space.static_body, arms[0], -1.0, opening / ARM))
