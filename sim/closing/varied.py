"""Close many hands, each in a world of its own: friction, table, masses, speed, force, softness.

What may change from trial to trial without another compilation is a list of ``Setting``s, fields of
the compiled model. Trials that share a scene run in one batch with these fields expanded; trials
with a shape of their own run on edited models of their own. Both give the same bits.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any, Final

import numpy as np

from icage.arrays import BoolArray, FloatArray
from icage.errors import InputError
from sim.world.engine import MjModel, mj
from sim.world.scene import Scene

_OBJECT: Final = slice(3, 6)
"""Degrees of freedom of the object; the fingers' slides come first."""

_NO_HEIGHT: Final = 1e-12
"""[diameter] An edge whose line passes this close to the origin spans no area with it."""


@dataclass(frozen=True, slots=True)
class Worlds:
    """What differs between N trials of compiled scenes; every array (N,), none validated again.

    Attributes
    ----------
    friction:
        [1] Between fingers and object; the scenes must be compiled with friction if any is above 0.
    softness:
        [1] Time constant of a contact over its usual one.
    table_friction:
        [closing force] Largest force of the table on the object, per axis.
    gravity_x, gravity_y:
        [closing force / mass] Gravity in the plane, along the palm's axes.
    mass, inertia:
        [1] Over the usual ones; ``inertia`` for equal mass.
    com_x, com_y:
        [diameter] Centre of mass off the area centroid, in the object's axes.
    speed, force:
        [1] Of the closing hand, over the usual ones.
    """

    friction: FloatArray
    softness: FloatArray
    table_friction: FloatArray
    gravity_x: FloatArray
    gravity_y: FloatArray
    mass: FloatArray
    inertia: FloatArray
    com_x: FloatArray
    com_y: FloatArray
    speed: FloatArray
    force: FloatArray

    def __len__(self) -> int:
        return len(self.friction)

    @classmethod
    def usual(cls, count: int) -> Worlds:
        """N worlds as in a replay: no friction, a level table."""
        ones = ("softness", "mass", "inertia", "speed", "force")
        return cls(**{f.name: np.full(count, float(f.name in ones)) for f in fields(cls)})

    @property
    def are_usual(self) -> BoolArray:
        """(N,) which of them are as in a replay."""
        usual = Worlds.usual(1)
        same = [getattr(self, f.name) == getattr(usual, f.name)[0] for f in fields(self)]
        return np.logical_and.reduce(same)

    def __getitem__(self, rows: Any) -> Worlds:
        return Worlds(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})


@dataclass(frozen=True, slots=True)
class Setting:
    """Values (N, ...) of a part of one model field, a row per trial.

    ``const`` says that constants derived from the field have to follow (mj_setConst).
    """

    name: str
    part: Any
    values: FloatArray
    const: bool = field(default=False)


def settings(scene: Scene, worlds: Worlds) -> Iterator[Setting]:
    """The fields of the scene's model that differ from the compiled ones in any of the worlds."""
    model, config = scene.model, scene.config
    usual = Worlds.usual(1)

    def differs(*names: str) -> bool:
        return any((getattr(worlds, n) != getattr(usual, n)[0]).any() for n in names)

    touching = np.flatnonzero(model.geom_contype != 0)
    body = mj.mj_name2id(model, mj.mjtObj.mjOBJ_BODY, "object")
    if config.friction > 0.0:
        yield Setting("geom_friction", (touching, 0), worlds.friction[:, None])
    elif differs("friction"):
        raise InputError("friction in a scene that was compiled without")
    if differs("softness"):
        soft = worlds.softness[:, None] * config.solref[0]
        yield Setting("geom_solref", (touching, 0), soft)
    if differs("table_friction"):
        force = worlds.table_friction * config.drive_force
        arm = mean_distance(scene.object.vertices)
        loss = np.column_stack([force, force, force * arm])
        yield Setting("dof_frictionloss", (_OBJECT,), loss)
        # as stiff as a contact: with the engine's usual time constant what sticks creeps at 1e-3
        stiff = np.broadcast_to(config.solimp, (len(worlds), 3, 5))
        yield Setting("dof_solimp", (_OBJECT,), stiff)
        prompt = np.broadcast_to(config.solref, (len(worlds), 3, 2))
        yield Setting("dof_solref", (_OBJECT,), prompt)
    if differs("gravity_x", "gravity_y"):
        pull = np.column_stack([worlds.gravity_x, worlds.gravity_y]) * config.drive_force
        yield Setting("opt.gravity", (slice(0, 2),), pull)
    if differs("mass", "inertia", "com_x", "com_y"):
        spin = worlds.mass * worlds.inertia * scene.object.gyration_squared
        yield Setting("body_mass", (body,), worlds.mass, const=True)
        yield Setting("body_inertia", (body,), np.repeat(spin[:, None], 3, axis=1), const=True)
        yield Setting(
            "body_ipos", (body, slice(0, 2)), np.column_stack([worlds.com_x, worlds.com_y])
        )
    if differs("speed", "force"):
        slow = (config.finger_damping * worlds.force / worlds.speed)[:, None]
        yield Setting("dof_damping", (slice(0, 3),), slow)
    if differs("force"):
        limit = abs(scene.closing_force) * worlds.force
        yield Setting("actuator_ctrlrange", (0,), np.column_stack([-limit, limit]))
        yield Setting("actuator_forcerange", (0,), np.column_stack([-limit, limit]))


def expand(batch: Any, changes: list[Setting]) -> None:
    """Write settings into a batch: one model, a value per simulation."""
    for one in changes:
        batch.expand(one.name)[(slice(None), *one.part)] = one.values
    if any(one.const for one in changes):
        batch.set_const()


def own_model(model: MjModel, changes: list[Setting], row: int) -> MjModel:
    """A copy of a model with the settings of one trial."""
    mine: Any = copy.copy(model)
    for one in changes:
        where, name = mine, one.name
        if name.startswith("opt."):
            where, name = mine.opt, name.removeprefix("opt.")
        part = one.part if len(one.part) > 1 else one.part[0]
        getattr(where, name)[part] = one.values[row]
    if any(one.const for one in changes):
        mj.mj_setConst(mine, mj.MjData(mine))
    return mine


def mean_distance(vertices: FloatArray) -> float:
    """Mean distance of a polygon's points (n, 2) from the origin: the arm of a table's friction
    under even pressure, about the centroid.

    Signed triangles from the origin to the edges: |p| over one, in polar coordinates, is
    integral of R(phi)^3 / 3 dphi with R = h / cos(phi - psi) at distance h of the edge's line; the
    antiderivative of cos^-3 is (sec tan + asinh(tan)) / 2.
    """
    a, b = vertices, np.roll(vertices, -1, axis=0)
    total = area = 0.0
    for (ax, ay), (bx, by) in zip(a.tolist(), b.tolist(), strict=True):
        length = math.hypot(bx - ax, by - ay)
        cross = ax * by - ay * bx
        area += 0.5 * cross
        height = cross / length  # signed; the triangle's orientation
        if abs(height) < _NO_HEIGHT:
            continue
        ends = [
            (x * (bx - ax) + y * (by - ay)) / (length * abs(height))
            for x, y in ((ax, ay), (bx, by))
        ]
        first, last = (t * math.hypot(1.0, t) + math.asinh(t) for t in ends)
        total += height**3 * (last - first) / 6.0
    return total / area
