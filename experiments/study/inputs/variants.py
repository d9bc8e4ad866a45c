"""Objects and hands that are not what was planned: outline, finger radius, shape of the hand, play.

A variant is compiled once; what a trial calls the target is then the planned grasp moved with the
edges it rests on: the least opening of the true hand between the same edges of the true object, or
those that its fingers roll on to.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

import numpy as np

from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.variables import VARIABLES, fields_of
from icage.arrays import FloatArray, IntArray
from icage.cage import Cage, GraspMinimum
from icage.errors import IcageError
from icage.geometry.contact_types import Supports, supports
from icage.geometry.least_opening import NoOpeningError, followed_opening, sliding_room
from icage.hand import HandShape
from icage.outline import Outline
from sim.world.config import SimConfig
from sim.world.scene import Scene

MODES: Final = 8
"""Waves round the boundary, at most, of its noise."""

_STREAM: Final = 14


class ShapeError(NamedTuple):
    """How object and hand differ from the planned ones: all that changes what is compiled.

    Attributes
    ----------
    scale:
        [1] Size of the object over the planned one.
    noise:
        [unit] Root mean square of the boundary's displacement.
    finger_radius, phi_1, phi_2:
        [unit, rad, rad] Errors of the discs, and of the hand's angles at fingers 1 and 2.
    play:
        [unit] How far a finger yields under the closing force.
    """

    scale: float
    noise: float
    finger_radius: float
    phi_1: float
    phi_2: float
    play: float


Key = tuple[ShapeError, int] | None
"""What a variant depends on, with the number of its boundary's shape; None is the planned one."""


@dataclass(frozen=True, slots=True, eq=False)
class Variant:
    """One true object and hand, compiled."""

    outline: Outline
    hand: HandShape
    finger_radius: float
    scene: Scene
    planned: bool


@dataclass(frozen=True, slots=True)
class _Moved:
    """A grasp of the plan at its place on a variant; what the judge reads.

    ``plateau``: both ends of its room, where a hand that is off holds the object loosely.
    """

    id: int
    contacts: FloatArray
    plateau: tuple[FloatArray, FloatArray] | None = field(default=None)


class Variants:
    """Makes the variants of a study; the planned one is made once."""

    def __init__(self, config: StudyConfig, cage: Cage) -> None:
        self._config, self._cage = config, cage
        self.planned = self._compiled(cage.outline, cage.hand, cage.finger_radius, 0.0, True)
        self._supports: dict[int, Supports] = {}
        usual = {name: one.nominal for name, one in VARIABLES.items()}
        self._usual = ShapeError(**fields_of("shape", usual))

    def keys(self, values: Mapping[str, FloatArray], shapes: IntArray) -> list[Key]:
        """The keys of the variants of trials (n); ``shapes`` (n,) number the shapes of the
        boundary's noise.
        """
        columns = fields_of("shape", values)
        usual = self._usual._asdict()
        keys: list[Key] = [None] * len(shapes)
        others = np.logical_or.reduce([columns[field] != usual[field] for field in columns])
        for row in np.flatnonzero(others).tolist():
            given = ShapeError(**{field: float(column[row]) for field, column in columns.items()})
            keys[row] = given, int(shapes[row]) if given.noise > 0.0 else 0
        return keys

    def make(self, key: Key) -> Variant | None:
        """The variant of a key, None if no such object or hand exists (it would cross itself)."""
        if key is None:
            return self.planned
        error, shape = key
        cage = self._cage
        try:
            outline = self._outline(error.scale, error.noise, shape)
            hand = cage.hand
            if error.phi_1 or error.phi_2:
                first, second = cage.hand.phi
                hand = HandShape.from_angles(first + error.phi_1, second + error.phi_2)
            radius = cage.finger_radius + error.finger_radius
            return self._compiled(outline, hand, radius, error.play, False)
        except IcageError:
            return None

    def grasps(self, variant: Variant, wanted: tuple[GraspMinimum, ...]) -> list[Any]:
        """Grasps of the plan as the judge takes them, at their places on the variant.

        One that cannot be moved (a finger on a corner's arc, or no such minimum) stays where it
        was planned.
        """
        if variant.planned:
            return list(wanted)
        return [self._moved(variant, grasp) for grasp in wanted]

    def _moved(self, variant: Variant, grasp: GraspMinimum) -> Any:
        cage = self._cage
        if grasp.plateau is not None or grasp.free_fingers:
            return grasp
        if grasp.id not in self._supports:
            found = supports(cage.outline, grasp.contacts, cage.finger_radius)
            self._supports[grasp.id] = found
        held = self._supports[grasp.id]
        if not set(held.types) <= {"edge", "concave_corner"}:
            return grasp
        radius = variant.finger_radius
        try:
            contacts, finger, edge = followed_opening(
                variant.outline, variant.hand, held.finger, held.edge, grasp.contacts, radius
            )
        except NoOpeningError:
            return grasp
        room = sliding_room(variant.outline, finger, edge, contacts, radius)
        return _Moved(grasp.id, contacts, room)

    def _outline(self, scale: float, noise: float, shape: int) -> Outline:
        planned = self._cage.outline
        centre = planned.centroid
        vertices = centre + scale * (planned.vertices - centre)
        if noise > 0.0:
            rng = np.random.default_rng([self._config.seed, _STREAM, shape])
            vertices = vertices + boundary_noise(planned.vertices, noise, rng)
        return Outline(vertices)

    def _compiled(
        self, outline: Outline, hand: HandShape, radius: float, play: float, planned: bool
    ) -> Variant:
        usual = SimConfig()
        config = SimConfig(
            time_step=self._config.time_step,
            max_time=self._config.max_time,
            friction=1.0 if self._config.rough else 0.0,
            linkage_compliance=play / outline.diameter / usual.drive_force,
        )
        scene = Scene(outline, hand, radius, config, instrumented=True)
        return Variant(outline, hand, radius, scene, planned)


def boundary_noise(vertices: FloatArray, rms: float, rng: np.random.Generator) -> FloatArray:
    """Displacements (n, 2) of the vertices (n, 2) along the boundary's normal, smooth along it.

    A random periodic function of arclength with at most ``MODES`` waves, its root mean square
    ``rms`` over all draws; every vertex goes along the mean normal of its two edges. Edges stay
    straight, so the contacts of a grasp keep their edges.
    """
    side = np.roll(vertices, -1, axis=0) - vertices
    length = np.hypot(*side.T)
    along = np.concatenate([[0.0], np.cumsum(length)[:-1]]) / length.sum()
    waves = 2.0 * np.pi * np.arange(1, MODES + 1)[:, None] * along
    cosines, sines = rng.standard_normal((2, MODES))
    # in an order of our own: a product of matrices adds in another one on every number of threads
    each = cosines[:, None] * np.cos(waves) + sines[:, None] * np.sin(waves)
    height = rms / np.sqrt(MODES) * each.sum(axis=0)
    normal = np.column_stack([side[:, 1], -side[:, 0]]) / length[:, None]
    both = normal + np.roll(normal, 1, axis=0)
    size = np.hypot(*both.T)
    mean = np.where(size[:, None] > 1e-9, both / np.maximum(size, 1e-9)[:, None], normal)
    return height[:, None] * mean
