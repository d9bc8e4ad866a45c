"""Forces at contacts, and the sentences for contacts that are no cage. Geometry of no engine."""

from __future__ import annotations

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.outline import Outline
from icage.tolerance import CONTACT_OFF, FREE_FINGER

_BALANCE = 1e-6
"""[1] Residual of force (and torque over diameter) below which unit forces balance."""

ISOLATED = "isolated: the hand can neither open nor close at these contacts"


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
    from scipy.optimize import linprog  # only now: most grasps hold, and scipy is slow to load

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


def contacts_reason(outline: Outline, contacts: FloatArray, slide: float = 0.0) -> str:
    """Why contacts are no strict local minimum of sigma, from the balance of forces.

    ``slide`` [unit] is how far balanced contacts can slide at constant sigma.
    """
    work = balance(outline, contacts, CONTACT_OFF * outline.diameter)
    if work is None:
        return "no equilibrium: no pushing forces at these contacts balance"
    if work < -_BALANCE:
        return "stretching: the forces balance, but the hand would have to open, not to close"
    if slide:
        return slide_reason(slide, outline.diameter)
    return "no strict local minimum: the hand can close further from these contacts"


def slide_reason(length: float, diameter: float) -> str:
    """The sentence for a target on a plateau of this length, [unit]."""
    return (
        "no strict local minimum: opposing parallel edges let the object slide "
        f"({length:.4g} long, {length / diameter:.3g} of the diameter)"
    )


def no_depth_reason(opening: float) -> str:
    """The sentence for a grasp that opens at once; ``opening`` is sigma_max / sigma_0."""
    return f"no depth: the object escapes at once (sigma_max / sigma_0 - 1 = {opening - 1.0:.2g})"


def free_fingers(outline: Outline, contacts: FloatArray) -> tuple[int, ...]:
    """Fingers (of 1, 2, 3) that touch nothing."""
    return free_fingers_of(outline, contacts[None])[0]


def free_fingers_of(outline: Outline, contacts: FloatArray) -> list[tuple[int, ...]]:
    """The same for several grasps (k, 3, 2) at once."""
    gap = np.asarray(shapely.distance(shapely.points(contacts), outline.polygon.exterior))
    free = gap > FREE_FINGER * outline.diameter
    return [tuple((np.flatnonzero(row) + 1).tolist()) for row in free]
