"""A case with point fingers, given discs: the derived case that physics can run. Our own.

Same hand shape, and as target the least opening of that hand among the edges that the point
fingers touched, each moved outwards by the radius: sigma = |w| is convex and the edges are half
planes of (d, w), so closing the hand there from the original pose ends in that minimum. The derived
case is planned afresh, and only with that plan is physics compared. Where no disc can stand at the
target, another grasp of the same hand is taken instead, and said so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cage import Cage
from icage.case import Case
from icage.errors import InputError
from icage.geometry.least_opening import NoOpeningError, least_opening
from icage.grasps.of_one_hand import grasps_of_hand
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from sim.world.config import SimConfig
from sim.world.scene import Scene

RADII: Final = (0.02, 0.01, 0.03)
"""[diameter] Of the discs that point fingers become: the first that leaves a cage."""

WIDE: Final = 1.01
"""[1] sigma_max / sigma_0 that another grasp must have to stand in for a target that is gone."""

MOST_OTHERS: Final = 60
"""Other grasps tried at most."""

_TOUCHING: Final = 1e-6
"""[diameter] A point finger this near an edge is on it."""


class DerivedCaseError(InputError):
    """Discs of the chosen radius have no grasp at the place of the point fingers."""


@dataclass(frozen=True, slots=True)
class HandAndObject:
    """What physics simulates: the plan's object, hand and discs, unless a test plants a fault."""

    outline: Outline
    hand: HandShape
    finger_radius: float

    def scene(self, config: SimConfig | None = None) -> Scene:
        """Hand and object, compiled."""
        return Scene(self.outline, self.hand, self.finger_radius, config or SimConfig())


@dataclass(frozen=True, slots=True)
class PhysicalCase:
    """A case with discs, its cage, and what is simulated to test the cage.

    Attributes
    ----------
    derived:
        Whether the discs stand for point fingers.
    another:
        Whether its target is another grasp of the hand, no disc fitting at the case's own.
    """

    case: Case
    cage: Cage
    derived: bool
    another: bool
    simulated: HandAndObject

    @property
    def origin(self) -> str:
        """Where the case comes from, in words."""
        if not self.derived:
            return "as given"
        target = "at another grasp of that hand" if self.another else "where this hand closes"
        share = self.case.finger_radius / self.case.outline.diameter
        size = f"radius {100.0 * share:.3g} % of the diameter"
        return f"derived from point fingers: discs of {size}, {target}"

    @classmethod
    def of(
        cls, case: Case, cage: Cage, *, derived: bool = False, another: bool = False
    ) -> PhysicalCase:
        """Simulated as it was planned."""
        simulated = HandAndObject(case.outline, cage.hand, case.finger_radius)
        return cls(case, cage, derived, another, simulated)


def physical_case(
    case: Case, radii: Sequence[float] = RADII, cage: Cage | None = None
) -> PhysicalCase:
    """The case itself if it has discs, else with discs of a radius in ``radii`` [diameter].

    ``cage`` is the plan of ``case`` where it is known: it is not planned again.

    Raises
    ------
    DerivedCaseError:
        Neither the target nor another grasp of the hand is left for any radius.
    InputError:
        The case is not a cage: there is nothing to close into.
    """
    own = _cage(case, cage)
    if case.finger_radius > 0.0:
        return PhysicalCase.of(case, own)
    reasons: list[str] = []
    for radius in radii:
        try:
            done = with_discs(case, radius * case.outline.diameter)
            return PhysicalCase.of(done, _cage(done), derived=True)
        except InputError as error:
            reasons.append(str(error))
    found = _another(case, radii)
    if found is not None:
        return found
    raise DerivedCaseError(
        f"{case.name} has point fingers, and discs find no cage near their grasp "
        f"({reasons[0]}), nor near another of that hand; give the case a finger_radius and a "
        "target of its own (for a drawing or an outline: --finger-radius R)"
    )


def _another(case: Case, radii: Sequence[float]) -> PhysicalCase | None:
    """The first other grasp of the same hand, by size, at which discs find a wide enough cage."""
    hand = HandShape.from_contacts(case.contacts)
    others = grasps_of_hand(case.outline, hand)[:MOST_OTHERS]
    for contacts, radius in product(others, radii):
        try:
            done = with_discs(case.with_grasp(contacts), radius * case.outline.diameter)
            cage = _cage(done)
        except InputError:
            continue
        if cage.sigma_max is None or cage.sigma_max >= WIDE * cage.sigma_0:
            return PhysicalCase.of(done, cage, derived=True, another=True)
    return None


def _cage(case: Case, known: Cage | None = None) -> Cage:
    cage = known or plan(case.outline, case.contacts, case.finger_radius)
    if cage.status == "not_a_cage":
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
    finger, edge = _supports(case.outline, case.contacts)
    try:
        contacts = least_opening(case.outline, hand, finger, edge, case.contacts, radius)
    except NoOpeningError as error:
        raise DerivedCaseError(f"discs of radius {radius:.6g} find no grasp: {error}") from error
    try:
        return Case(case.name, case.unit, case.outline, radius, contacts, case.sources)
    except InputError as error:
        raise DerivedCaseError(f"radius {radius:.6g}: {error}") from error


def _supports(outline: Outline, contacts: FloatArray) -> tuple[IntArray, IntArray]:
    """Finger (m,) and edge (m,) wherever a point finger (3, 2) is on an edge."""
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    pairs: list[tuple[int, int]] = []
    for k, point in enumerate(contacts):
        share = np.clip(((point - a) * side).sum(axis=1) / (side**2).sum(axis=1), 0.0, 1.0)
        gap = np.hypot(*(a + share[:, None] * side - point).T)
        pairs += [(k, j) for j in np.flatnonzero(gap <= _TOUCHING * outline.diameter).tolist()]
    found = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return found[:, 0], found[:, 1]
