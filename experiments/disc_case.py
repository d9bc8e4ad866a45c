"""A case with point fingers, given discs: the derived case that physics can run. Our own.

Same hand shape, and as target the least opening of that hand among the edges that the point
fingers touched, each moved outwards by the radius: sigma = |w| is convex and the edges are half
planes of (d, w), so closing the hand there from the original pose ends in that minimum. The derived
case is planned afresh, and only with that plan is physics compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.errors import InputError
from icage.formats.case_json import Case
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan

RADII: Final = (0.02, 0.01, 0.03)
"""[diameter] Of the discs that point fingers become: the first that leaves a cage."""

_TOUCHING: Final = 1e-6
"""[diameter] A point finger this near an edge is on it."""


_AT_MINIMUM: Final = (0, 8)
"""SLSQP has converged, or can go no lower for rounding; the planner has the last word."""


class DerivedCaseError(InputError):
    """Discs of the chosen radius have no grasp at the place of the point fingers."""


@dataclass(frozen=True, slots=True)
class PhysicalCase:
    """A case with discs, its cage, and whether it was derived from point fingers."""

    case: Case
    cage: Cage
    derived: bool


def physical_case(case: Case, radii: Sequence[float] = RADII) -> PhysicalCase:
    """The case itself if it has discs, else with discs of a radius in ``radii`` [diameter].

    Raises
    ------
    DerivedCaseError:
        The derived target is gone for every radius.
    InputError:
        The case is not a cage: there is nothing to close into.
    """
    if case.finger_radius > 0.0:
        return PhysicalCase(case, _cage(case), derived=False)
    reasons: list[str] = []
    for radius in radii:
        try:
            done = with_discs(case, radius * case.outline.diameter)
            return PhysicalCase(done, _cage(done), derived=True)
        except InputError as error:
            reasons.append(str(error))
    raise DerivedCaseError(
        f"{case.name} has point fingers, and discs find no cage near their grasp "
        f"({reasons[0]}); give the case a finger_radius and a target of its own"
    )


def _cage(case: Case) -> Cage:
    cage = plan(case.outline, case.contacts, case.finger_radius)
    if cage.verdict == "not_a_cage":
        raise InputError(
            f"{case.name} with fingers of radius {case.finger_radius:.6g} {case.unit} is not a "
            f"cage: {cage.why}"
        )
    return cage


def with_discs(case: Case, radius: float) -> Case:
    """The derived case, not planned yet; ``radius`` in its unit.

    Raises
    ------
    DerivedCaseError:
        No minimum is found, or a disc cannot stand there.
    """
    hand = HandShape.from_contacts(case.contacts)
    contacts = _least_opening(case.outline, hand, case.contacts, radius)
    try:
        return Case(case.name, case.unit, case.outline, radius, contacts, case.sources)
    except InputError as error:
        raise DerivedCaseError(f"radius {radius:.6g}: {error}") from error


def _least_opening(
    outline: Outline, hand: HandShape, contacts: FloatArray, radius: float
) -> FloatArray:
    """Finger centres (3, 2) of the smallest hand outside the moved edges.

    min |w|^2  s.t.  n . (d + w z_k - a) >= r for every edge (a, n) that finger k touches;
    relative to the contacts' middle, in diameters.
    """
    size, middle = outline.diameter, contacts.mean(axis=0)
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    out = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
    rows: list[list[float]] = []
    levels: list[float] = []
    for k, point in enumerate(contacts):
        share = np.clip(((point - a) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
        gap = np.hypot(*(a + share[:, None] * side - point).T)
        for j in np.flatnonzero(gap <= _TOUCHING * size).tolist():
            (x, y), z = out[j], complex(hand.z[k])
            rows.append([x, y, x * z.real + y * z.imag, y * z.real - x * z.imag])
            levels.append((radius + out[j] @ (a[j] - middle)) / size)
    matrix, level = np.array(rows).reshape(-1, 4), np.array(levels)
    d = complex(*(contacts[0] - middle)) / size
    w = complex(*(contacts[1] - contacts[0])) / size
    grown = 1.0 + 4.0 * radius / (size * abs(w))
    found: Any = minimize(
        lambda v: v[2] ** 2 + v[3] ** 2,
        np.array([d.real, d.imag, w.real, w.imag]) * grown,
        jac=lambda v: np.array([0.0, 0.0, 2.0 * v[2], 2.0 * v[3]]),
        constraints={"type": "ineq", "fun": lambda v: matrix @ v - level, "jac": lambda v: matrix},
        method="SLSQP",
        options={"maxiter": 200, "ftol": 1e-15},
    )
    if found.status not in _AT_MINIMUM or (matrix @ found.x - level).min() < -_TOUCHING:
        raise DerivedCaseError(f"discs of radius {radius:.6g} find no grasp: {found.message}")
    x, y, u, v = found.x.tolist()
    places = (complex(x, y) + complex(u, v) * hand.z) * size
    return np.column_stack([places.real, places.imag]) + middle
