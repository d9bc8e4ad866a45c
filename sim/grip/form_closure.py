"""Is a grasp held to first order? From the contacts that the engine reports.

A contact with inward normal n at p gives the wrench w = (n_x, n_y, (p - c) x n / diameter). The
object is held by the normals alone (form closure) exactly if the w positively span the space of
wrenches: rank 3, and sum lambda_i w_i = 0 for some lambda > 0. Three fingers on edges have rank 2
(the lines meet in one point), concave corners that carry force give rank 3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.optimize import linprog

from icage.arrays import FloatArray, IntArray
from icage.errors import GeometryError
from icage.geometry.contact_types import ONE_NORMAL, Supports
from sim.world.engine import MjData, MjModel, mj
from sim.world.scene import Scene

RANK: Final = 1e-3
"""[1] Singular values below this share of the largest are 0. Three edges give 1e-6 (how well the
pose has settled), concave corners 0.05 and more."""

LEAST_SHARE: Final = 1e-6
"""[1] Every lambda must be above this, at sum lambda = 1; the LP is solved to 1e-9."""

CARRYING: Final = 1e-4
"""[1] A contact carries force if it has this share of the largest."""

_SETTLE: Final = 100
"""[step] At rest under the motor, so that the forces belong to the pose."""


@dataclass(frozen=True, slots=True)
class Touches:
    """Contacts of a closed hand, those of one finger with one normal joined; frame P, [diameter].

    Attributes
    ----------
    finger:
        (m,) 0..2.
    points, normals:
        (m, 2), normals into the object.
    forces:
        (m,) [drive_force].
    """

    finger: IntArray
    points: FloatArray
    normals: FloatArray
    forces: FloatArray

    @property
    def carrying(self) -> int:
        """Number of contacts that carry force."""
        return int((self.forces > CARRYING * self.forces.max(initial=0.0)).sum())


@dataclass(frozen=True, slots=True)
class FormClosure:
    """The test's answer; ``margin`` is the largest smallest lambda, 0 if nothing balances."""

    rank: int
    singular_values: FloatArray
    margin: float
    closed: bool
    """Whether the normals positively span the wrenches."""

    def agrees_with(self, held: Supports) -> bool:
        """Whether rank and closure are those of the contacts that the planner's target has."""
        return self.rank == (3 if held.concave_corners else 2) and self.closed == bool(
            held.concave_corners
        )


def touches(scene: Scene, qpos: FloatArray) -> Touches:
    """Contacts of the engine at qpos (6,), the motor pulling, after a moment to settle."""
    data = mj.MjData(scene.model)
    data.qpos[:] = qpos
    data.ctrl[:] = scene.closing_force
    for _ in range(_SETTLE):
        mj.mj_step(scene.model, data)
    mj.mj_forward(scene.model, data)
    return joined(scene.model, data, scene.config.drive_force)


def joined(model: MjModel, data: MjData, unit: float) -> Touches:
    """Contacts of a forwarded state, those of one finger with one normal as one; force in unit."""
    tips = {mj.mj_name2id(model, mj.mjtObj.mjOBJ_GEOM, f"finger_{k + 1}_tip"): k for k in range(3)}
    found: list[tuple[int, FloatArray, FloatArray, float]] = []
    wrench = np.zeros(6)
    for number in range(data.ncon):
        contact: Any = data.contact[number]
        mj.mj_contactForce(model, data, number, wrench)
        first, second = contact.geom.tolist()
        finger = tips[first] if first in tips else tips[second]
        normal = np.array(contact.frame[:2]) * (1.0 if first in tips else -1.0)
        normal /= np.hypot(*normal)
        place, force = np.array(contact.pos[:2]), float(wrench[0]) / unit
        for i, (k, kept_at, other, before) in enumerate(found):
            if k == finger and normal @ other >= np.cos(ONE_NORMAL):
                stronger = force > before
                at = place if stronger else kept_at
                found[i] = (k, at, normal if stronger else other, before + force)
                break
        else:
            found.append((finger, place, normal, force))
    return Touches(
        np.array([row[0] for row in found], dtype=np.int64),
        np.array([row[1] for row in found]).reshape(-1, 2),
        np.array([row[2] for row in found]).reshape(-1, 2),
        np.array([row[3] for row in found]),
    )


def wrench_matrix(points: FloatArray, normals: FloatArray, centre: FloatArray) -> FloatArray:
    """Columns (3, m) of unit wrenches about ``centre`` (2,); lengths in [diameter]."""
    arm = points - centre
    torque = arm[:, 0] * normals[:, 1] - arm[:, 1] * normals[:, 0]
    return np.vstack([normals.T, torque])


def form_closure(wrenches: FloatArray) -> FormClosure:
    """Do the columns of (3, m) positively span the space? LP: largest t with lambda_i >= t.

    max t  s.t.  W lambda = 0, sum lambda = 1, lambda_i >= t.

    Examples
    --------
    >>> form_closure(np.array([[1, -1, 0, 0], [0, 0, 1, -1], [0.2, 0.2, -0.2, -0.2]])).closed
    True
    >>> form_closure(np.array([[1.0, -0.5, -0.5], [0.0, 0.9, -0.9], [0.0, 0.0, 0.0]])).rank
    2
    """
    count = wrenches.shape[1]
    if count == 0:
        return FormClosure(0, np.zeros(0), 0.0, False)
    values: FloatArray = np.asarray(np.linalg.svd(wrenches, compute_uv=False), dtype=np.float64)
    rank = int((values > RANK * values[0]).sum())
    # the plane that the wrenches span is all they can balance in: below full rank its noise is cut
    basis = np.linalg.svd(wrenches)[0][:, :rank]
    equal = np.vstack([basis.T @ wrenches, np.ones((1, count))])
    answer: Any = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.hstack([-np.eye(count), np.ones((count, 1))]),
        b_ub=np.zeros(count),
        A_eq=np.hstack([equal, np.zeros((rank + 1, 1))]),
        b_eq=np.append(np.zeros(rank), 1.0),
        bounds=[(0.0, None)] * count + [(None, None)],
    )
    if answer.status not in (0, 2):
        raise GeometryError(f"the form-closure test failed: {answer.message}")
    margin = max(float(answer.x[-1]), 0.0) if answer.status == 0 else 0.0
    return FormClosure(rank, values, margin, rank == 3 and margin > LEAST_SHARE)
