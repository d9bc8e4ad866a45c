"""Contacts that somebody points at: do they hold, and which grasp of this hand is the nearest?

Three points picked by hand almost never balance to the last digit. The hand that stands on them
has a shape, though, and its grasp beside them is what was meant. Our own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.cells.free_space import FreeSpace
from icage.cells.target import contacts_as_configuration, find_target
from icage.contacts import as_contacts, check_contacts
from icage.discs.offsets import offsets
from icage.discs.true_curve import grasp_on_curve
from icage.errors import GeometryError, GraspError
from icage.geometry.near_frame import NearFrame
from icage.geometry.statics import contacts_reason, slide_reason
from icage.hand import HandShape
from icage.library_faults import geometry_told
from icage.outline import Outline
from icage.tolerance import CONTACT_OFF, TARGET_SHIFT, TARGET_TURN

REACHES: Final = ((TARGET_SHIFT, TARGET_TURN), (0.02, 0.1), (0.05, 0.3), (0.1, 0.6))
"""[diameter], [rad] How far a finger may move and the hand turn to a grasp, one after another."""

_SEGMENTS: Final = 8
"""Chords of a quarter of an arc, where discs are looked at on a polygon first."""

_NEAR_CURVE: Final = 1e-3
"""[diameter] Points picked this near to where a finger can stand are moved there."""


@dataclass(frozen=True, slots=True)
class NearestGrasp:
    """What is at some contacts, and next to them.

    Attributes
    ----------
    why:
        Why the contacts themselves are no grasp, a sentence; empty where they are one.
    contacts:
        (3, 2) finger centres of the nearest grasp of the same hand that all fingers touch, [unit];
        None if there is none within reach. The contacts themselves where they are a grasp.
    moved:
        [unit] How far the finger is away from there that is furthest.
    turned:
        [rad] How far the hand turns to there.
    """

    why: str
    contacts: FloatArray | None = None
    moved: float = 0.0
    turned: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether the contacts themselves are a grasp."""
        return not self.why


class NearestGrasps:
    """Looks for the grasps of one object and one radius [unit] of fingers, 0 for points.

    Raises
    ------
    GraspError, GeometryError:
        The object cannot be grown by this radius.

    Examples
    --------
    >>> triangle = Outline([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    >>> middles = [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]]
    >>> NearestGrasps(triangle).of(middles).holds
    True
    >>> near = NearestGrasps(triangle).of([[0.52, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])
    >>> near.why
    'no equilibrium: no pushing forces at these contacts balance'
    >>> round(near.moved, 3)
    0.007
    """

    def __init__(self, outline: Outline, radius: float = 0.0) -> None:
        self.outline, self.radius = outline, radius
        self._frame = NearFrame.of(outline)
        near = self._frame.outline_into(outline)
        self._polygon = offsets(near, radius, _SEGMENTS).inner if radius > 0.0 else near

    def on_curve(self, contacts: FloatArray) -> FloatArray:
        """Points (n, 2) picked by eye, each moved to where a finger that touches can be.

        One further from there than 1e-3 of the diameter stays where it is.
        """
        ring = self.outline.polygon.exterior
        points = shapely.points(contacts)
        feet = shapely.get_coordinates(shapely.line_interpolate_point(ring, ring.project(points)))
        away = contacts - feet
        far = np.hypot(*away.T)
        near = np.abs(far - self.radius) <= _NEAR_CURVE * self.outline.diameter
        with np.errstate(invalid="ignore", divide="ignore"):
            unit = np.where(far[:, None] > 0.0, away / far[:, None], 0.0)
        return np.where(near[:, None], feet + self.radius * unit, contacts)

    @geometry_told()
    def of(self, contacts: FloatArray) -> NearestGrasp:
        """The grasp at contacts (3, 2), or next to them.

        Raises
        ------
        GraspError, HandError:
            No hand with such fingers can stand there.
        """
        contacts = as_contacts(contacts)
        check_contacts(self.outline, contacts, self.radius)
        space = FreeSpace.around(self._polygon, HandShape.from_contacts(contacts))
        why = ""
        for reach, turn in REACHES:
            found = self._within(space, contacts, reach, turn)
            if isinstance(found, NearestGrasp):
                near = found.moved <= TARGET_SHIFT * self.outline.diameter
                if near and found.turned <= TARGET_TURN:
                    return found
                return replace(found, why=why or self._reason(contacts))
            if found:
                return NearestGrasp(why or found)
            why = why or self._reason(contacts)
        return NearestGrasp(why)

    def _within(
        self, space: FreeSpace, contacts: FloatArray, reach: float, turn: float
    ) -> NearestGrasp | str:
        """The nearest grasp; why there is none that counts; or an empty text: none as near."""
        wanted = contacts_as_configuration(space, self._frame.into(contacts))
        try:
            target = find_target(space, wanted, reach=reach, turn=turn)
        except GeometryError:  # too many cells meet within such a reach
            return ""
        if target is None:
            return ""
        size = self.outline.diameter
        if target.plateau is not None:
            return slide_reason(abs(target.plateau[1].d - target.plateau[0].d), size)
        grasp = self._frame.back(space.contacts(target.at))
        if self.radius > 0.0:
            try:
                grasp = grasp_on_curve(self.outline, self.radius, grasp, space.hand)
            except GraspError:
                return ""
        if self._off(grasp) > CONTACT_OFF * size:
            return ""  # a grasp of some of the fingers: there is no contact for the others
        moved = float(np.hypot(*(grasp - contacts).T).max())
        a, b = ((pair[1] - pair[0]) @ [1.0, 1.0j] for pair in (contacts, grasp))
        return NearestGrasp("", grasp, moved, abs(float(np.angle(b / a))))

    def _off(self, contacts: FloatArray) -> float:
        """How far the finger is from touching that is furthest from it."""
        far = shapely.distance(self.outline.polygon.exterior, shapely.points(contacts))
        return float(np.abs(np.asarray(far) - self.radius).max())

    def _reason(self, contacts: FloatArray) -> str:
        return contacts_reason(self._polygon, self._frame.into(contacts))
