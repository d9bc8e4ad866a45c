"""The grasp of the same kind for other fingers, or for a slightly different object. Our own.

The hand keeps its shape, its fingers the edges (or corners) that they touch; what changes is how
far it is open and where it stands. From one radius to another the grasp is followed in as many
steps as it takes, for a large step may lead the fingers past a neighbouring grasp.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.case import Case
from icage.checks import an_instance
from icage.discs.true_curve import grasp_on_curve
from icage.errors import GraspError, InputError
from icage.geometry.contact_types import feet
from icage.geometry.least_opening import NoOpeningError, followed_opening
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan

_STEPS: Final = (1, 8, 64)
"""Into how many steps the way to the new radius is cut, until one number does."""

_TOUCHING: Final = 1e-5
"""[diameter] A finger this near the distance of its radius touches."""

_ALIKE: Final = 0.9
"""[1] Cosine between an edge and the one that stands for it on another outline, at least."""


def regrasp(
    case: Case, *, finger_radius: float | None = None, outline: Outline | None = None
) -> Case:
    """The case with its grasp at the nearest grasp of the same kind for another radius or outline.

    Parameters
    ----------
    case:
        With a target grasp.
    finger_radius:
        [unit] Of the new fingers; the case's own if None.
    outline:
        An object of slightly different shape, in the same place; the case's own if None.

    Raises
    ------
    GraspError:
        The case has no grasp, or no cage of the same hand shape is found on the same edges.
    InputError:
        Neither a radius nor an outline is given.

    Examples
    --------
    >>> import icage
    >>> pliers = icage.load("pliers")
    >>> thin = regrasp(pliers, finger_radius=5.0)
    >>> thin
    <Case pliers/1_best: 51 vertices, 180 x 147.887 mm, finger radius 5 mm, sigma_0 48.0955 mm>
    >>> [round(icage.plan(regrasp(pliers, finger_radius=r)).sigma_0, 3) for r in (4.0, 6.0, 7.0)]
    [45.749, 50.442, 52.788]
    """
    an_instance(case, Case, "case")
    _ = case.contacts  # says that there is no grasp
    if outline is not None:
        an_instance(outline, Outline, "outline")
    if finger_radius is None and outline is None:
        raise InputError("regrasp needs a finger_radius or an outline to go to")
    wanted = replace(
        case,
        outline=case.outline if outline is None else outline,
        finger_radius=case.finger_radius if finger_radius is None else finger_radius,
        target=None,
    )
    reasons: list[str] = []
    for steps in _STEPS:
        try:
            return _checked(wanted, _followed(case, wanted, steps))
        except (GraspError, NoOpeningError) as error:
            reasons.append(str(error))
    raise GraspError(
        f"{case.name}: no grasp of the same kind for finger radius {wanted.finger_radius:.6g} "
        f"{case.unit} was found ({reasons[-1]}); Case.grasps() looks for others"
    )


def _checked(wanted: Case, contacts: FloatArray) -> Case:
    """The case, if its contacts are a cage."""
    found = wanted.with_grasp(contacts)
    cage = plan(found)
    if cage.status == "not_a_cage":
        raise GraspError(f"the contacts found are no cage: {cage.why}")
    return found.with_grasp(cage.contacts)


def _followed(case: Case, wanted: Case, steps: int) -> FloatArray:
    """Contacts at the end of the way; the outline changes at its first step."""
    finger, edge = _touched(case.outline, case.contacts, case.finger_radius)
    edge = _same_edges(case.outline, wanted.outline, edge)
    contacts, hand = case.contacts, case.hand
    for radius in np.linspace(case.finger_radius, wanted.finger_radius, steps + 1)[1:].tolist():
        contacts = _nearest(wanted.outline, hand, finger, edge, contacts, radius)
    return contacts


def _nearest(
    outline: Outline, hand: HandShape, finger: IntArray, edge: IntArray, contacts: FloatArray,
    radius: float,
) -> FloatArray:  # fmt: skip
    """The grasp next to these contacts: least opening over the edges, or on the true curve."""
    try:
        opening, _, _ = followed_opening(outline, hand, finger, edge, contacts, radius)
        return opening if radius == 0.0 else grasp_on_curve(outline, radius, opening, hand)
    except (GraspError, NoOpeningError):
        if radius == 0.0:
            raise
        return grasp_on_curve(outline, radius, contacts, hand)


def _touched(outline: Outline, contacts: FloatArray, radius: float) -> tuple[IntArray, IntArray]:
    """Finger (m,) and edge (m,), from vertex ``edge``, wherever a finger touches one."""
    pairs: list[tuple[int, int]] = []
    for k, point in enumerate(contacts):
        foot, _ = feet(outline, point)
        gap = np.hypot(*(point - foot).T)
        near = np.flatnonzero(np.abs(gap - radius) <= _TOUCHING * outline.diameter)
        pairs += [(k, j) for j in near.tolist()]
    found = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return found[:, 0], found[:, 1]


def _same_edges(old: Outline, new: Outline, edges: IntArray) -> IntArray:
    """The edges of a new outline that stand for some of the old one."""
    if old is new or len(old) == len(new):
        return edges
    start, side = new.vertices, np.roll(new.vertices, -1, axis=0) - new.vertices
    direction = side / np.hypot(*side.T)[:, None]
    found: list[int] = []
    for j in edges.tolist():
        a, b = old.vertices[j], old.vertices[(j + 1) % len(old)]
        along = (b - a) / np.hypot(*(b - a))
        alike = direction @ along >= _ALIKE
        if not alike.any():
            raise GraspError(f"the new outline has no edge like edge {j} of the old one")
        away = np.hypot(*(start + 0.5 * side - 0.5 * (a + b)).T)
        found.append(int(np.where(alike, away, np.inf).argmin()))
    return np.array(found, dtype=np.int64)
