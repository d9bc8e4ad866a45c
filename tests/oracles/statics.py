"""Is a configuration a strict local minimum of sigma? Decided from forces alone.

With d and w as unknowns every touched straight edge is one linear inequality, so the test is the
Karush-Kuhn-Tucker condition of min |w|, our own form of [Bunis2018, Sec. IV-C]: contact forces
lambda >= 0 with ``sum lambda_i row_i = (0, w)`` (squeezing, not stretching), plus a test that
nothing slides for free. Arcs of disc fingers add a curvature term.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from tests.oracles.geometry import Floats, Ring, configuration, fingers_of, row, unit_hand

Complexes = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class Touch:
    """One finger's contacts: any one of ``choices`` must hold, all normals of a choice at once.

    A point finger on a convex vertex has two choices (pass it on either side); everything else
    has one. ``curvature`` is 1/r on an arc, for every normal of the only choice.
    """

    choices: tuple[Floats, ...]
    curvature: Floats


def touch(ring: Ring, point: Floats, radius: float, tol: float) -> Touch | None:
    """Contacts of a finger centre within ``tol`` [unit] of its (offset) outline, or None."""
    feet, distance = ring.nearest_on_edges(point)
    near = np.flatnonzero(distance <= radius + tol)
    if len(near) == 0:
        return None
    if radius > 0.0:
        directions = (point - feet[near]) / distance[near, None]
        along = ((feet[near] - ring.starts[near]) * ring.tangents[near]).sum(1)
        at_end = (along <= tol) | (along >= ring.lengths[near] - tol)
        distinct: list[int] = []
        for i in range(len(near)):
            if all(float(np.hypot(*(feet[near[i]] - feet[near[j]]))) > 2 * tol for j in distinct):
                distinct.append(i)
        flat = np.einsum("ij,ij->i", directions, ring.normals[near])
        curved = np.array(
            [1.0 / radius if at_end[i] and flat[i] < 1.0 - 1e-12 else 0.0 for i in distinct]
        )
        return Touch((directions[distinct],), curved)
    at = np.flatnonzero(np.linalg.norm(ring.vertices - point, axis=1) <= tol)
    if len(at) == 1 and len(near) == 2 and not ring.concave[at[0]]:
        sides = ring.normals[[at[0] - 1, at[0]]]
        return Touch((sides[:1], sides[1:]), np.zeros(1))
    return Touch((ring.normals[near],), np.zeros(len(near)))


def squeezing_forces(rows: Floats, w: Floats) -> tuple[Floats, float]:
    """Forces lambda >= 0 nearest to ``sum lambda_i row_i = (0, w)`` and the relative miss."""
    goal = np.concatenate([[0.0, 0.0], w])
    if len(rows) == 0:
        return np.zeros(0), 1.0
    forces, miss = nnls(rows.T, goal)
    return forces, float(miss / np.hypot(*w))


def is_strict_minimum(
    ring: Ring, contacts: Floats, radius: float = 0.0, tol: float = 1e-9, margin: float = 1e-6
) -> bool:
    """Whether sigma has a strict local minimum here: ``tol`` [diameter], ``margin`` [1].

    ``margin`` keeps away from targets that a rounding error turns into something else.
    """
    hand = unit_hand(contacts)
    touches = [touch(ring, p, radius, tol * ring.diameter) for p in contacts]
    if any(ring.depth(p, radius) > tol * ring.diameter for p in contacts):
        return False
    choices = [t.choices if t else (np.zeros((0, 2)),) for t in touches]
    return all(
        _is_strict(chosen, touches, hand, configuration(contacts), radius, margin)
        for chosen in product(*choices)
    )


def _is_strict(
    chosen: tuple[Floats, ...],
    touches: list[Touch | None],
    hand: Complexes,
    q: Floats,
    radius: float,
    margin: float,
) -> bool:
    rows = np.array([row(n, hand[k]) for k, normals in enumerate(chosen) for n in normals])
    if len(rows) < 3:
        return False
    forces, miss = squeezing_forces(rows, q[2:])
    if miss > 1e-7:
        return False
    if radius == 0.0:
        return _hold_from_all_sides(np.concatenate(chosen), margin)
    curvature = np.concatenate([t.curvature for t in touches if t is not None])
    fingers = np.array([k for k, normals in enumerate(chosen) for _ in normals])
    return _curves_upwards(rows, forces, curvature, fingers, hand, margin)


def _hold_from_all_sides(normals: Floats, margin: float) -> bool:
    """Do the normals positively span the plane, no gap of directions near a half turn?"""
    angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * np.pi]))
    return bool(gaps.max() < np.pi - margin)


def _curves_upwards(
    rows: Floats,
    forces: Floats,
    curvature: Floats,
    fingers: NDArray[np.int64],
    hand: Complexes,
    margin: float,
) -> bool:
    """Second order: the Lagrangian of |w|^2 / 2 is positive on the directions forces leave free."""
    loaded = forces > 1e-9 * forces.max()
    _, values, frame = np.linalg.svd(rows[loaded])
    rank = int((values > 1e-9 * values[0]).sum())
    free = frame[rank:]
    if len(free) == 0:
        return True
    hessian = np.diag([0.0, 0.0, 1.0, 1.0])
    for i in np.flatnonzero(loaded):
        n = rows[i, :2]
        slide = row(np.array([-n[1], n[0]]), hand[fingers[i]])
        hessian -= forces[i] * curvature[i] * np.outer(slide, slide)
    bend = free @ hessian @ free.T
    return float(np.linalg.eigvalsh(bend)[0]) > margin


def opening_direction(
    ring: Ring, contacts: Floats, radius: float = 0.0, tol: float = 1e-9
) -> Floats | None:
    """Direction in (d, w), (4,), that leaves every touched edge while sigma grows least.

    Linear program: minimize w . dw subject to ``row . p >= |normal|`` for every contact; a finger
    on a convex vertex leaves along the bisector. None where the hand can neither open nor close
    (an isolated configuration). Our own.
    """
    hand, q = unit_hand(contacts), configuration(contacts)
    rows: list[Floats] = []
    for k, point in enumerate(contacts):
        found = touch(ring, point, radius, tol * ring.diameter)
        if found is None:
            continue
        one_sided = len(found.choices) == 1
        normals = found.choices[0] if one_sided else sum(found.choices)  # type: ignore[arg-type]
        rows += [row(n / np.hypot(*n), hand[k]) for n in np.atleast_2d(normals)]
    a = np.array(rows)
    rate = np.concatenate([[0.0, 0.0], q[2:] / np.hypot(*q[2:])])
    short = 1e-3 * np.ones(8)  # the shortest of equally good steps, p = p_plus - p_minus
    answer = linprog(
        np.concatenate([rate, -rate]) + short,
        A_ub=np.hstack([-a, a]), b_ub=-np.linalg.norm(a[:, :2], axis=1), method="highs",
    )  # fmt: skip
    if not answer.success:
        return None
    return np.asarray(answer.x[:4] - answer.x[4:])


def moved(contacts: Floats, step: Floats) -> Floats:
    """The fingers after (d, w) has moved by ``step``, (3, 2)."""
    return fingers_of(configuration(contacts) + step, unit_hand(contacts))
