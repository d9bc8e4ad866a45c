"""The play of a grasp: how far the object turns in a rigid hand a little larger than the target.

For three fingers on three edges sigma(theta) = sigma_0 / cos(theta): the object turns about the
point where the force lines meet [docs/theory.md, Sec. 2.6], so the play at sigma = (1 + delta)
sigma_0 is acos(1 / (1 + delta)), a square root; with concave corners it is linear in delta.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.optimize import linprog

from icage.arrays import FloatArray
from icage.errors import GeometryError
from icage.geometry.contact_types import Supports, on_others, on_supports
from icage.hand import Placement
from sim.world.engine import mj, no_log
from sim.world.rigid_hand import disc_depths, rigid_data, rigid_model
from sim.world.scene import Scene

WAY: Final = 0.2
"""[s] The torque is such that the free object would turn through its play in this time: a gentle
push, whose force hardly depends on the play."""

_LONGEST: Final = 4.0
"""[s] Bound on a push; at rest it ends."""

_LEAST_PLAY: Final = 1e-6
"""[rad] An object that is expected to turn by less is turned as fast as if it were this much."""

_STILL: Final = 1e-4
"""[1] Slower than this share of the free turning speed is still."""


@dataclass(frozen=True, slots=True)
class Play:
    """Play at sigma = (1 + delta) sigma_0, [rad], towards negative and positive turns of the hand.

    Attributes
    ----------
    measured, predicted:
        (2,) of the engine, and of the edges that the fingers rest on, produced to lines.
    on_edges:
        Whether at both ends every finger stood over the inside of its edges and had come up against
        no other: then both must agree.
    penetration:
        [diameter] Deepest disc at the ends: it acts as so much more delta.
    """

    delta: float
    measured: tuple[float, float]
    predicted: tuple[float, float]
    on_edges: bool
    penetration: float

    @property
    def law(self) -> float:
        """[rad] acos(1 / (1 + delta)), of three edges."""
        return math.acos(1.0 / (1.0 + self.delta))


def clearance(
    held: Supports, contacts: FloatArray, scale: float, turn: float
) -> tuple[float, FloatArray]:
    """Largest clearance from the supports of a hand scaled and turned about its centroid.

    Fingers c + v + scale R(turn) (f_k - c); the translation v (2,) is free:
    max t  s.t.  n_i . (displacement of i's finger) >= t. Returns t and v, both in [unit].
    """
    centre = contacts.mean(axis=0)
    cos, sin = math.cos(turn), math.sin(turn)
    turned = (contacts - centre) @ np.array([[cos, sin], [-sin, cos]])
    moved = (centre + scale * turned - contacts)[held.finger]
    reach = (held.normals * moved).sum(axis=1)
    answer: Any = linprog(
        [0.0, 0.0, -1.0],
        A_ub=np.hstack([-held.normals, np.ones((len(reach), 1))]),
        b_ub=reach,
        bounds=[(None, None)] * 3,
    )
    if answer.status != 0:
        raise GeometryError(f"these contacts do not hold the object: {answer.message}")
    return float(answer.x[2]), np.asarray(answer.x[:2])


def opened(held: Supports, contacts: FloatArray, scale: float) -> Placement:
    """The target hand, ``scale`` times as large, as clear of its contacts as it can be."""
    _, shift = clearance(held, contacts, scale, 0.0)
    centre = contacts.mean(axis=0)
    return Placement.from_contacts(centre + shift + scale * (contacts - centre))


def predicted_play(
    held: Supports, contacts: FloatArray, delta: float, most: float = 0.5 * math.pi
) -> tuple[float, float]:
    """Largest turns (negative, positive), [rad], that leave room between the supports."""
    ends: list[float] = []
    for side in (-1.0, 1.0):
        low, high = 0.0, most
        for _ in range(60):
            middle = 0.5 * (low + high)
            room, _ = clearance(held, contacts, 1.0 + delta, side * middle)
            low, high = (middle, high) if room >= 0.0 else (low, middle)
        ends.append(low)
    return ends[0], ends[1]


def measure_play(scene: Scene, held: Supports, contacts: FloatArray, delta: float) -> Play:
    """Lock the hand at (1 + delta) sigma_0 and turn the object both ways until it stops.

    Raises
    ------
    GeometryError:
        The contacts do not hold the object.
    """
    predicted = predicted_play(held, contacts, delta)
    start = scene.start_positions(opened(held, contacts, 1.0 + delta).as_array())[0]
    sigma = float(scene.sigma(start[None, :])[0])
    model = rigid_model(scene, sigma)
    ends: list[float] = []
    inside, deepest = True, 0.0
    for side, expected in zip((1.0, -1.0), predicted, strict=True):  # turning the object turns
        speed = max(expected, _LEAST_PLAY) / WAY  # the hand the other way round
        data = rigid_data(model, start[3:])
        torque = scene.config.object_damping * scene.object.gyration_squared * speed
        data.qfrc_applied[2] = side * torque
        with no_log():
            for step in range(math.ceil(_LONGEST / scene.config.time_step)):
                mj.mj_step(model, data)
                still = np.abs(data.qvel).max() < _STILL * speed
                if step > 20 and still:
                    break
        pose = np.array(data.qpos)
        ends.append(abs(float(pose[2] - start[5])))
        deepest = max(deepest, float(disc_depths(scene, sigma, pose).max()))
        place = scene.placements(np.concatenate([start[:3], pose])[None, :])
        fingers = scene.hand.fingers(place[0])
        inside = inside and on_supports(scene.outline, held, fingers)
        inside = inside and not on_others(scene.outline, held, fingers, scene.finger_radius)
    return Play(delta, (ends[0], ends[1]), predicted, inside, deepest)
