"""The contact forces that hold a jam: how a hand that squeezes can stand still. Our own.

This shares nothing with the search for jams: contacts are looked for on the outline, and the
smallest forces inside their cones come from a linear program.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.cage import Cage
from icage.friction.levels import Jam
from icage.values import Value

_TOUCHING = 1e-6
"""[diameter] A finger this much further from an edge than from the nearest still touches it: discs
that jam on chords of an arc are that far off, and no two edges are so near without being both
touched."""

_MISS = 1e3
"""[1] What a unit of force that is out of balance costs, against one within a cone."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactForce(Value):
    """What one finger does at one place of the outline.

    Attributes
    ----------
    finger:
        1, 2, 3.
    at:
        (2,) where it touches the object, [unit].
    cone:
        (2, 2) unit vectors of the right and the left edge of the friction cone, into the object.
    force:
        (2,) on the object, for a motor that does the work of 1 for each unit of length that every
        finger moves along; (0, 0) where none is needed.
    """

    finger: int
    at: FloatArray
    cone: FloatArray
    force: FloatArray

    def __post_init__(self) -> None:
        for name in ("at", "cone", "force"):
            object.__setattr__(self, name, read_only(np.array(getattr(self, name), np.float64)))


@dataclass(frozen=True, slots=True)
class JamForces:
    """The forces of a jam, and how far they are from balancing.

    Attributes
    ----------
    contacts:
        One for every finger and edge in contact.
    residual:
        [1] What is left over of the sums of forces and moments (over the diameter), as a share of
        all forces: rounding, if the hand jams.
    """

    contacts: tuple[ContactForce, ...]
    residual: float


def jam_forces(cage: Cage, jam: Jam, mu: float) -> JamForces:
    """The smallest forces within the cones of a coefficient that hold a jam.

    Examples
    --------
    >>> from icage.planner import plan
    >>> cage = plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
    ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
    ... )
    >>> jam = cage.friction(0.3).jam
    >>> held = jam_forces(cage, jam, 0.3)
    >>> len(held.contacts), held.residual < 1e-9
    (3, True)
    """
    from scipy.optimize import linprog  # only here: it takes a tenth of a second to load

    touched = [
        (finger, at, normal)
        for finger in jam.fingers
        for at, normal in _touches(cage, jam.contacts[finger - 1])
    ]
    half = math.atan(mu)
    cones = np.array([[_turned(n, -half), _turned(n, half)] for _, _, n in touched])
    ways = cones.reshape(-1, 2)
    at = np.repeat(np.array([p for _, p, _ in touched]), 2, axis=0)
    centre = np.repeat(np.array([jam.contacts[f - 1] for f, _, _ in touched]), 2, axis=0)
    size = cage.outline.diameter
    middle = jam.contacts.mean(axis=0)
    arm = (at - middle) / size
    rows = np.stack([
        ways[:, 0], ways[:, 1], arm[:, 0] * ways[:, 1] - arm[:, 1] * ways[:, 0],
        np.sum((centre - middle) / jam.sigma * ways, axis=1),
    ])  # fmt: skip
    # the motor's work is exact, the balance is missed where it has to be
    slack = np.zeros((4, 6))
    slack[:3, :3], slack[:3, 3:] = np.eye(3), -np.eye(3)
    cost = np.concatenate([np.ones(len(ways)), np.full(6, _MISS)])
    answer = linprog(
        cost, A_eq=np.hstack([rows, slack]), b_eq=[0.0, 0.0, 0.0, -1.0], method="highs"
    )
    amount = np.zeros(len(ways)) if answer.x is None else answer.x[: len(ways)]
    total = float(amount.sum())
    missed = float(np.abs(rows[:3] @ amount).max()) / total if total > 0.0 else math.inf
    forces = (amount[:, None] * ways).reshape(-1, 2, 2).sum(axis=1)
    return JamForces(
        tuple(
            ContactForce(finger, p, cone, force)
            for (finger, p, _), cone, force in zip(touched, cones, forces, strict=True)
        ),
        missed,
    )


def _touches(cage: Cage, centre: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Where a finger at a centre touches the outline, and the inward normals there."""
    ring = cage.outline.vertices
    sides = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
    along = sides[:, 1] - sides[:, 0]
    # the feet of the centre on every edge
    share = np.einsum("ij,ij->i", centre - sides[:, 0], along) / np.einsum("ij,ij->i", along, along)
    feet = sides[:, 0] + np.clip(share, 0.0, 1.0)[:, None] * along
    gap = np.hypot(*(feet - centre).T)
    near = np.flatnonzero(gap <= gap.min() + _TOUCHING * cage.outline.diameter)
    found: list[tuple[FloatArray, FloatArray]] = []
    for k in near.tolist():
        at = feet[k]
        inward = np.array([-along[k, 1], along[k, 0]]) / np.hypot(*along[k])
        if cage.finger_radius > 0.0:
            inward = (at - centre) / np.hypot(*(at - centre))
        if not any(np.allclose(at, p) and np.allclose(inward, n) for p, n in found):
            found.append((at, inward))
    return found


def _turned(v: FloatArray, angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])
