"""The nearest grasp of a hand: what it says of contacts agrees with the plan of them."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import icage
from icage.case import Case
from icage.errors import InputError
from icage.formats.load import load
from icage.grasps.nearest import NearestGrasps
from icage.hand import HandShape
from icage.outline import Outline
from models import CASES

NAMES = ("T_best", "cross_multi", "L_best", "pliers")


def case_of(name: str) -> Case:
    path = CASES / f"{name}.json"
    return load(path if path.exists() else name)


def pulled(case: Case, finger: int, share: float) -> np.ndarray:
    """The contacts with one finger moved along where it can be, by a share of the diameter."""
    grown = case.outline.polygon
    if case.finger_radius:
        grown = grown.buffer(case.finger_radius, quad_segs=64)
    ring = grown.exterior
    contacts = case.contacts.copy()
    at = ring.project(shapely.Point(contacts[finger])) + share * case.outline.diameter
    contacts[finger] = ring.interpolate(at % ring.length).coords[0]
    return contacts


@pytest.mark.parametrize("name", NAMES)
def test_a_grasp_is_its_own_nearest(name: str) -> None:
    case = case_of(name)
    found = NearestGrasps(case.outline, case.finger_radius).of(case.contacts)
    assert found.holds
    assert found.contacts == pytest.approx(case.contacts, abs=1e-5 * case.outline.diameter)


@pytest.mark.parametrize("name", NAMES)
def test_it_holds_where_the_plan_says_so(name: str) -> None:
    case = case_of(name)
    grasps = NearestGrasps(case.outline, case.finger_radius)
    agreed = {True: 0, False: 0}
    for finger in range(len(case.contacts)):
        for share in (-0.04, -0.01, 0.003, 0.02, 0.05):
            contacts = grasps.on_curve(pulled(case, finger, share))
            try:
                status = icage.plan(case, contacts).status
            except InputError:
                with pytest.raises(InputError):
                    grasps.of(contacts)
                continue
            found = grasps.of(contacts)
            assert found.holds == (status != "not_a_cage"), (finger, share, found, status)
            agreed[found.holds] += 1
            if found.contacts is None or found.holds:
                continue
            cage = icage.plan(case, found.contacts)
            assert cage.status != "not_a_cage"
            before, after = (HandShape.from_contacts(one).phi for one in (contacts, found.contacts))
            assert after == pytest.approx(before, abs=1e-9)  # the hand is the same
            assert np.hypot(*(contacts - found.contacts).T).max() == pytest.approx(found.moved)
    assert min(agreed.values()) > 0, agreed


def test_contacts_between_parallel_edges_slide() -> None:
    bar = Outline([[0, 0], [10, 0], [10, 2], [0, 2]])
    found = NearestGrasps(bar).of(np.array([[5.0, 0.0], [6.0, 2.0], [4.0, 2.0]]))
    assert not found.holds
    assert found.contacts is None
    assert "slide" in found.why or "close further" in found.why


@pytest.mark.parametrize("radius", [0.0, 0.2])
def test_points_picked_by_eye_are_put_where_a_finger_can_be(radius: float) -> None:
    case = case_of("T_best")
    grasps = NearestGrasps(case.outline, radius)
    ring = case.outline.polygon.buffer(radius, quad_segs=4).exterior if radius else None
    ring = case.outline.polygon.exterior if ring is None else ring
    size = case.outline.diameter
    picked = shapely.get_coordinates(ring.interpolate(np.linspace(0.0, 0.99, 37), normalized=True))
    near = np.abs(shapely.distance(case.outline.polygon, shapely.points(picked)) - radius)
    picked = picked[near < 1e-3 * size]
    put = shapely.points(grasps.on_curve(picked))
    off = shapely.distance(case.outline.polygon.exterior, put) - radius
    assert np.abs(off).max() < 1e-12 * size
    far = np.array([[100.0 * size, 0.0], case.outline.centroid])
    assert (grasps.on_curve(far) == far).all()
