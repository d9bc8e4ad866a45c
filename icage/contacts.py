"""Can three points be the finger centres of a grasp of this outline? What is wrong if not."""

from __future__ import annotations

import math
from numbers import Real

import numpy as np
import shapely
from numpy.typing import ArrayLike

from icage.arrays import FloatArray, real_numbers
from icage.errors import GraspError
from icage.geometry.kernels.ways_off import all_can_leave
from icage.geometry.near_frame import NearFrame
from icage.hand import HandShape
from icage.library_faults import geometry_told
from icage.outline import Outline
from icage.tolerance import CONTACT_OFF, SAME_POINT

LARGEST_RADIUS = 10.0
"""[diameter] Largest finger radius accepted: beyond it the object is a speck among fingers."""

SMALLEST_RADIUS = SAME_POINT
"""[diameter] Least finger radius but 0: a smaller disc lies within the point that it stands for."""

_QUADRANT = 64
"""Segments a quadrant of the offset that tells a closed pocket from the outside."""

_SPARE = 1e-9
"""[diameter] What a disc that leaves has to spare, far above rounding."""

_NEARLY = 0.9
"""[CONTACT_OFF] How far from its centre a disc may begin to leave: less than what is a pocket."""


def as_contacts(contacts: ArrayLike) -> FloatArray:
    """Finger centres as an array (3, 2) of its own, or a GraspError that says what was found.

    Examples
    --------
    >>> as_contacts([[0, 0], [1, 0], [0, 1]]).shape
    (3, 2)
    """
    try:
        points = real_numbers(contacts)
    except (TypeError, ValueError, OverflowError) as error:
        raise GraspError(
            f"contacts are a {type(contacts).__name__}; three finger centres [x, y] are needed"
        ) from error
    if points.shape != (3, 2):
        raise GraspError(
            f"contacts have the shape {points.shape}; three finger centres [x, y], shape (3, 2), "
            "are needed"
        )
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise GraspError(f"contact {bad[0] + 1} is {points[bad[0]].tolist()}; it must be finite")
    return points


def check_radius(finger_radius: object) -> float:
    """The radius as a float, or a GraspError: a finite number, 0 or more, is needed."""
    if isinstance(finger_radius, bool) or not isinstance(finger_radius, Real):
        raise GraspError(f"finger_radius is {finger_radius!r}; a number is needed")
    radius = float(finger_radius)
    if not math.isfinite(radius) or radius < 0.0:
        raise GraspError(f"finger_radius is {radius}; a finite number, 0 or more, is needed")
    return radius


def check_disc(outline: Outline, finger_radius: float, unit: str = "") -> None:
    """Refuse discs that are smaller than what is taken for a point: a GraspError.

    ``finger_radius`` [unit] is 0 or more.
    """
    least = SMALLEST_RADIUS * outline.diameter
    if 0.0 < finger_radius < least:
        unit = f" {unit}" if unit else ""
        raise GraspError(
            f"finger_radius is {finger_radius:.3g}{unit}; 0 for point fingers, or at least "
            f"{least:.3g}{unit} ({SMALLEST_RADIUS:g} diameters of the outline) is needed"
        )


@geometry_told()
def check_contacts(
    outline: Outline, contacts: FloatArray, finger_radius: float, unit: str = ""
) -> None:
    """Refuse contacts that no hand with these fingers can have on this outline.

    Parameters
    ----------
    outline:
        The object.
    contacts:
        (3, 2) finger centres, fingers 1, 2, 3.
    finger_radius:
        [unit] r >= 0; the centres are at distance r from the outline.
    unit:
        What lengths are in, for the messages.

    Raises
    ------
    GraspError:
        Radius out of range, a centre off the offset by more than 1e-6 of the diameter, inside the
        object or in a pocket closed to the finger, two discs that overlap.
    HandError:
        Clockwise, collinear or coincident contacts.
    """
    check_disc(outline, finger_radius, unit)
    limit = LARGEST_RADIUS * outline.diameter
    unit = f" {unit}" if unit else ""
    if not 0.0 <= finger_radius <= limit:
        raise GraspError(
            f"finger_radius is {finger_radius:g}{unit}; 0 to {limit:g}{unit} is allowed "
            f"({LARGEST_RADIUS:g} diameters of the outline)"
        )
    HandShape.from_contacts(contacts)
    _check_size(outline, contacts, unit)
    _check_sides(contacts, finger_radius, unit)
    _check_distances(outline, contacts, finger_radius, unit)
    if finger_radius > 0.0:
        _check_pockets(outline, contacts, finger_radius, unit)


_SIDES = ((0, 1), (1, 2), (0, 2))

SMALLEST_HAND = 2e-7
"""[diameter] Least longest side of a hand, twice SLIDE_GIVE over PLATEAU: a smaller one, turned as
far as SLIDE_GIVE lets it, slides by more than PLATEAU, and methods differ in whether it holds."""

_TOUCHING = 1e-12
"""[1] Discs that overlap by this share of their diameter touch: the rounding of two centres."""


def _check_size(outline: Outline, contacts: FloatArray, unit: str) -> None:
    longest = max(float(np.hypot(*(contacts[j] - contacts[i]))) for i, j in _SIDES)
    least = SMALLEST_HAND * outline.diameter
    if longest < least:
        raise GraspError(
            f"the fingers are at most {longest:.3g}{unit} apart; at least {least:.3g}{unit} "
            f"({SMALLEST_HAND:g} of the object's diameter) is needed"
        )


def _check_sides(contacts: FloatArray, r: float, unit: str) -> None:
    for i, j in _SIDES:
        side = float(np.hypot(*(contacts[j] - contacts[i])))
        if side < 2.0 * r * (1.0 - _TOUCHING):
            raise GraspError(
                f"the discs of fingers {i + 1} and {j + 1} overlap: side {i + 1}-{j + 1} is "
                f"{side:.9g}{unit}, at least 2 x finger_radius = {2.0 * r:.9g}{unit} is needed"
            )


def _check_distances(outline: Outline, contacts: FloatArray, r: float, unit: str) -> None:
    allowed = CONTACT_OFF * outline.diameter
    points = shapely.points(contacts)
    distances = np.asarray(shapely.distance(outline.polygon.exterior, points))
    inside = np.asarray(shapely.contains_properly(outline.polygon, points))
    allowed_place = f"{_at(r, unit)} (to {allowed:.3g}{unit})"
    for k in range(3):
        distance, place = float(distances[k]), f"contact {k + 1} at {contacts[k].tolist()}"
        if inside[k] and distance > allowed:
            raise GraspError(
                f"{place} lies inside the outline, {distance:.6g}{unit} from it; "
                f"a finger centre must be {allowed_place}"
            )
        if abs(distance - r) <= allowed:
            continue
        if distance < r:
            raise GraspError(
                f"{place} is {distance:.9g}{unit} from the outline, nearer than finger_radius = "
                f"{r:.9g}{unit}: the disc enters the object or does not fit into the pocket there"
            )
        raise GraspError(
            f"{place} is {distance:.9g}{unit} from the outline; "
            f"a finger centre must be {allowed_place}"
        )


def _at(r: float, unit: str) -> str:
    return "on it" if r == 0.0 else f"finger_radius = {r:.9g}{unit} away from it"


def _check_pockets(outline: Outline, contacts: FloatArray, r: float, unit: str) -> None:
    """A centre inside the exterior ring of the offset stands in a pocket no disc can enter."""
    size = outline.diameter
    x, y = np.array(outline.vertices.T, order="C")
    # a centre so near to one from which a disc can leave lies too shallow to be in a pocket below
    if all_can_leave(x, y, contacts.copy(), r + _SPARE * size, _NEARLY * CONTACT_OFF * size):
        return
    frame = NearFrame.of(outline)
    offset = frame.outline_into(outline).polygon.buffer(r, quad_segs=_QUADRANT)
    exterior = shapely.Polygon(shapely.get_exterior_ring(offset))
    # The chords of the offset's arcs lie inside it by at most this much.
    chord = 2.0 * r * (1.0 - np.cos(np.pi / (4 * _QUADRANT))) + CONTACT_OFF * outline.diameter
    points = shapely.points(frame.into(contacts))
    within = np.asarray(shapely.contains_properly(exterior, points))
    depths = np.asarray(shapely.distance(exterior.exterior, points))
    for k in np.flatnonzero(within & (depths > chord)).tolist():
        raise GraspError(
            f"contact {k + 1} at {contacts[k].tolist()} lies in a pocket that finger_radius = "
            f"{r:.9g}{unit} closes off: the disc cannot come in from outside"
        )
