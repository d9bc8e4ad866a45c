"""A target grasp that was found: where the fingers stand, and how far the hand may open from it."""

from __future__ import annotations

from dataclasses import dataclass

from icage.arrays import FloatArray, read_only
from icage.contacts import as_contacts
from icage.hand import HandShape, Placement
from icage.values import Value


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Grasp(Value):
    """An immobilizing grasp with the levels of its cage, as ``Case.grasps`` lists them.

    Attributes
    ----------
    contacts:
        (3, 2) finger centres, counterclockwise, [unit] of the case, read-only.
    sigma_0, sigma_first, sigma_max:
        [unit] Size of the hand in the grasp, the first level at which closing may end elsewhere,
        the level at which the object can escape; None where there is no such level.
    score:
        [1] The ratio by which the list is ranked, e.g. sigma_first / sigma_0.
    """

    contacts: FloatArray
    sigma_0: float
    sigma_first: float | None
    sigma_max: float | None
    score: float

    def __post_init__(self) -> None:
        contacts = as_contacts(self.contacts)
        object.__setattr__(self, "contacts", read_only(contacts))

    @property
    def hand(self) -> HandShape:
        """Shape of the hand that stands on the contacts."""
        return HandShape.from_contacts(self.contacts)

    @property
    def placement(self) -> Placement:
        """The grasp as a placement of the hand in the object's frame."""
        return Placement.from_contacts(self.contacts)

    def __repr__(self) -> str:
        phi_1, phi_2 = self.hand.phi_deg
        hand = f"phi {phi_1:.1f}, {phi_2:.1f} deg"
        return f"<Grasp sigma_0 {self.sigma_0:.6g}, score {self.score:.5g}, {hand}>"
