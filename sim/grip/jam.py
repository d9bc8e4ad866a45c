"""Do forces within the cones of friction hold a hand that squeezes? A program of its own.

Contact i presses on the object at c_i with inward normal n_i, and finger k(i) moves by r_k when the
hand opens by one: r_k = L_k u_k. A hand is jammed at mu if there are weights >= 0 of the edges
n_i +- mu t_i of the cones with

    sum f_i = 0,    sum c_i x f_i = 0,    sum r_k(i) . f_i = -|r|

(the fingers carry the motor, whose pull is |r| times the drive force). The least residual of these
four equations is found by non-negative least squares. Nothing of ``icage.friction`` is used.
[docs/theory.md, Sec. 10]
"""

from __future__ import annotations

import copy
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.optimize import nnls

from icage.arrays import FloatArray, IntArray
from icage.geometry.contact_types import supports
from sim.grip.form_closure import joined
from sim.world.engine import mj
from sim.world.scene import Scene

BALANCED: Final = 1e-8
"""[drive_force] A smaller residual is none: contacts of a plan are known to 1e-10 diameters."""

_LARGEST: Final = 1e4
"""[1] A hand that does not balance at this coefficient does at none."""

_HALVINGS: Final = 60

_ABOUT: Final = 5e-6
"""[diameter] Margin of a geom: the margins of finger and object add."""


class Held(NamedTuple):
    """Contacts (m,) of a hand in its own frame P, [diameter]; ``rates`` (3, 2) are r_k."""

    finger: IntArray
    points: FloatArray
    normals: FloatArray
    rates: FloatArray


def held_at(scene: Scene, placement: FloatArray) -> Held:
    """The contacts of a placement (4,), from the outline alone."""
    contacts = scene.hand.fingers(placement)
    found = supports(scene.outline, contacts, scene.finger_radius)
    points = contacts[found.finger] - scene.finger_radius * found.normals
    rates = scene.kinematics.directions * scene.kinematics.lengths[:, None]
    theta = float(placement[2])
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    middle = contacts.mean(axis=0)
    at = (points - middle) @ turn / scene.object.diameter
    return Held(found.finger, at, -found.normals @ turn, rates)


def held_by_engine(scene: Scene, placement: FloatArray) -> Held:
    """The contacts that the engine finds at a placement (4,), those about to touch included.

    No step is taken: forces of friction depend on how a hand came to where it is, so a jam that
    is put down again may slide.
    """
    model = copy.copy(scene.model)
    model.geom_margin[model.geom_contype != 0] = _ABOUT
    data = mj.MjData(model)
    data.qpos[:] = scene.start_positions(placement)[0]
    mj.mj_forward(model, data)
    found = joined(model, data, 1.0)
    rates = scene.kinematics.directions * scene.kinematics.lengths[:, None]
    return Held(found.finger, found.points, found.normals, rates)


def residual(held: Held, mu: float) -> float:
    """[drive_force] The least that is left of force, torque per diameter and motor; 0 for a jam.

    Examples
    --------
    Two fingers squeeze a bar whose ends are turned by 0.3 rad: that takes mu = tan(0.3) = 0.309.

    >>> sides = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    >>> normals = -np.array([[np.cos(0.3), np.sin(0.3)], [-np.cos(0.3), np.sin(0.3)]])
    >>> bar = Held(np.array([0, 1]), sides[:2], normals, sides)
    >>> residual(bar, 0.31) < BALANCED < residual(bar, 0.30)
    True
    >>> round(least_mu(bar), 6)
    0.309336
    """
    if not len(held.finger):
        return 1.0
    across = np.column_stack([-held.normals[:, 1], held.normals[:, 0]])
    edges = np.concatenate([held.normals + mu * across, held.normals - mu * across])
    edges /= np.hypot(1.0, mu)
    arm, rate = np.tile(held.points, (2, 1)), np.tile(held.rates[held.finger], (2, 1))
    torque = arm[:, 0] * edges[:, 1] - arm[:, 1] * edges[:, 0]
    work = (rate * edges).sum(axis=1) / np.linalg.norm(held.rates)
    answer: Any = nnls(np.vstack([edges.T, torque, work]), np.array([0.0, 0.0, 0.0, -1.0]))
    return float(answer[1])


def least_mu(held: Held) -> float:
    """[1] The least coefficient at which the hand is jammed; inf if there is none.

    With more friction every cone is wider, so what balances goes on balancing: halving finds it.
    """
    if residual(held, _LARGEST) > BALANCED:
        return np.inf
    low, high = 0.0, _LARGEST
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if residual(held, middle) <= BALANCED else (middle, high)
    return high
