"""Why a set of contacts is no cage: a sentence for the user, from the mechanics of the grasp."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from icage.arrays import FloatArray
from icage.kernels.tree import births
from icage.outline import Outline
from icage.solver import Configuration, Terrain
from icage.target import cells_near, contacts_as_configuration
from icage.tolerance import CONTACT_OFF

_BALANCE = 1e-6
"""[1] Residual of force (and torque over diameter) below which unit forces balance."""


def contact_normals(outline: Outline, point: FloatArray, reach: float) -> list[FloatArray]:
    """Inward normals of the edges within ``reach`` of a point; two at a vertex."""
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    length = np.hypot(side[:, 0], side[:, 1])
    t = np.clip(((point - a) * side).sum(axis=1) / length**2, 0.0, 1.0)
    gap = np.hypot(*(a + t[:, None] * side - point).T)
    return [np.array([-side[k, 1], side[k, 0]]) / length[k] for k in np.flatnonzero(gap <= reach)]


def balance(outline: Outline, contacts: FloatArray, reach: float) -> float | None:
    """Work of closing of balanced contact forces, or None where nothing balances.

    Forces along inward normals, total size 1, with zero force and torque; the work of closing is
    -sum lambda_i (n_i . p_i), positive for squeezing and negative where the hand would have to
    open. The largest over all balanced forces is returned.
    """
    columns: list[FloatArray] = []
    work: list[float] = []
    centre = contacts.mean(axis=0)
    for p in contacts:
        for n in contact_normals(outline, p, reach):
            arm = (p - centre) / outline.diameter
            columns.append(np.array([n[0], n[1], arm[0] * n[1] - arm[1] * n[0], 1.0]))
            work.append(-float(n @ arm))
    if not columns:
        return None
    matrix = np.array(columns).T
    rhs = np.array([0.0, 0.0, 0.0, 1.0])
    slack = np.vstack([matrix[:3], -matrix[:3]])
    answer = linprog(
        -np.array(work),
        A_ub=slack,
        b_ub=np.full(6, _BALANCE),
        A_eq=matrix[3:],
        b_eq=rhs[3:],
        bounds=(0.0, None),
    )
    return float(-answer.fun) if answer.status == 0 else None


def why_not(terrain: Terrain, contacts: FloatArray) -> str:
    """The reason that the contacts are no strict local minimum of sigma."""
    here = contacts_as_configuration(terrain, contacts)
    size = terrain.pieces.diameter
    cells = cells_near(terrain, here, CONTACT_OFF * size)
    if len(cells):
        value, _ = births(terrain.pieces, terrain.z, cells, terrain.cap, terrain.worst)
        reachable = np.isfinite(value[:, 0]).any()
    else:
        reachable = False
    if not reachable:
        return "isolated: the hand can neither open nor close at these contacts"
    work = balance(terrain.outline, contacts, CONTACT_OFF * size)
    if work is None:
        return "no equilibrium: no pushing forces at these contacts balance"
    if work < -_BALANCE:
        return "stretching: the forces balance, but the hand would have to open, not to close"
    return "no strict local minimum: the hand can close further from these contacts"


def plateau_reason(ends: tuple[Configuration, Configuration], terrain: Terrain) -> str:
    """The sentence for a target on a plateau."""
    length = abs(ends[1].d - ends[0].d)
    return (
        "no strict local minimum: opposing parallel edges let the object slide "
        f"({length:.4g} long, {length / terrain.pieces.diameter:.3g} of the diameter)"
    )
