"""Closed forms, invariances, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely

import icage
from icage.cage import Cage
from icage.errors import GraspError, InputError, MethodError
from icage.outline import Outline
from icage.placing.misplaced import draw_misplaced
from icage.planner import plan
from models import CASES
from tests.icage.placing.beside_sampling import drawn, furthest_off, relative

ROOT = 3.0**0.5
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * ROOT]])
MIDDLES = np.array([[0.5, 0.0], [0.75, 0.25 * ROOT], [0.25, 0.25 * ROOT]])

FILES = [
    path
    for path in sorted(CASES.glob("*.json"))
    if json.loads(path.read_text())["expected"]["verdict"] != "not_a_cage"
]
GAP = 1e-3


def triangle() -> Cage:
    return plan(TRIANGLE, MIDDLES)


@pytest.mark.parametrize("opening", [0.55, 0.7, 0.85])
def test_the_triangle_at_a_known_opening(opening: float) -> None:
    """Fingers move out along the sides' normals: r = (S / sigma_0 - 1) / (2 sqrt 3)."""
    best = icage.place(triangle(), opening=opening)
    assert best.tolerance == pytest.approx((2.0 * opening - 1.0) / (2.0 * ROOT), rel=1e-9)
    assert best.placement.sigma == opening
    assert best.limited_by == "clearance"
    assert best.fingers.mean(axis=0) == pytest.approx(TRIANGLE.mean(axis=0), abs=1e-6)


def test_the_triangle_with_the_opening_free_or_erring() -> None:
    """(2 s - 1) / (2 sqrt 3) = (sqrt 3 / 2 - s) / sqrt 3 where both balance: the least circle round
    the unit hand has the radius 1 / sqrt 3."""
    free = icage.place(triangle())
    assert free.tolerance == pytest.approx((ROOT - 1.0) / (2.0 * ROOT), rel=1e-7)
    assert free.placement.sigma < 0.5 * ROOT
    size = 0.25 * (ROOT + 1.0)
    errs = icage.place(triangle(), opening_error=True)
    assert errs.placement.sigma == pytest.approx(size, rel=1e-6)
    assert errs.tolerance == pytest.approx((0.5 * ROOT - size) / ROOT, rel=1e-6)
    assert errs.limited_by == "level"
    known = icage.place(triangle(), opening=0.85, opening_error=True)
    assert known.tolerance == pytest.approx((0.5 * ROOT - 0.85) / ROOT, rel=1e-6)


def test_friction_lowers_the_level() -> None:
    cage = icage.plan(icage.load(CASES / "pliers_best.json"))
    without, rubbing = icage.place(cage), icage.place(cage, 0.3)
    assert rubbing.level == cage.friction(0.3).sigma_first
    assert rubbing.placement.sigma < rubbing.level < without.placement.sigma
    assert rubbing.tolerance < without.tolerance
    assert rubbing.mu == 0.3


def test_a_larger_opening_bears_more_where_it_may_be_chosen() -> None:
    cage = icage.plan(icage.load("wrench"))
    free = icage.place(cage)
    assert cage.sigma_first is not None
    for share in (0.3, 0.6, 0.9):
        opening = cage.sigma_0 + share * (cage.sigma_first - cage.sigma_0)
        assert icage.place(cage, opening=opening).tolerance <= free.tolerance_upper
    assert icage.place(cage, opening_error=True).tolerance <= free.tolerance_upper


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
@pytest.mark.parametrize("errs", [False, True])
def test_what_must_not_change_the_tolerance(path: Path, errs: bool) -> None:
    data = json.loads(path.read_text())
    vertices = np.array(data["outline"]["vertices"])
    contacts, radius = np.array(data["grasp"]["contacts"]), data["finger_radius"]
    base = icage.place(plan(Outline(vertices), contacts, radius), opening_error=errs).tolerance
    turn = np.array([[np.cos(2.0), -np.sin(2.0)], [np.sin(2.0), np.cos(2.0)]])
    far = 1e3 * Outline(vertices).diameter
    mirror = np.array([-1.0, 1.0])
    after = np.roll(vertices, -1, axis=0)
    finer = np.stack([vertices, vertices + 0.37 * (after - vertices)], axis=1).reshape(-1, 2)
    moved = {
        "turned": (vertices @ turn.T + 3.0, contacts @ turn.T + 3.0, radius, 1.0),
        "far away": (vertices + far, contacts + far, radius, 1.0),
        "smaller": (1e-3 * vertices, 1e-3 * contacts, 1e-3 * radius, 1e-3),
        "mirrored": (mirror * vertices, (mirror * contacts)[[1, 0, 2]], radius, 1.0),
        "subdivided": (finer, contacts, radius, 1.0),
        "begun elsewhere": (np.roll(vertices, 2, axis=0), contacts, radius, 1.0),
    }
    if not errs:  # sigma is another side then, and the same error of a finger costs other levels
        moved["relabelled"] = (vertices, np.roll(contacts, 1, axis=0), radius, 1.0)
    for name, (ring, grasp, r, factor) in moved.items():
        found = icage.place(plan(Outline(ring), grasp, r), opening_error=errs).tolerance / factor
        assert relative(found, base) <= GAP, name


def test_what_is_refused() -> None:
    cage = triangle()
    for opening in (0.4999, 0.866026, 2.0):
        with pytest.raises(InputError, match="above sigma_0 = 0.5 and below"):
            icage.place(cage, opening=opening)
    with pytest.raises(InputError, match=r"icage\.plan makes one"):
        icage.place(TRIANGLE)  # pyright: ignore[reportArgumentType]
    for wrong in (float("nan"), "wide", True):
        with pytest.raises(InputError, match="opening"):
            icage.place(cage, opening=wrong)  # pyright: ignore[reportArgumentType]
    for mu in (-0.1, float("nan"), "rough"):
        with pytest.raises(InputError, match="mu"):
            icage.place(cage, mu)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="gap"):
        icage.place(cage, gap=0.0)
    with pytest.raises(GraspError, match="slide"):
        icage.place(icage.plan(icage.load(CASES / "rectangle_notcage.json")))
    with pytest.raises(MethodError, match="contact space"):
        icage.place(icage.plan(TRIANGLE, MIDDLES, method="contact-space"))


def test_a_set_with_no_room_is_told_of() -> None:
    """A cage of discs 2e-6 deep, opened by a thousandth of that: nothing is clear by 1e-9."""
    cage = drawn(448, 0.02)
    assert cage.sigma_first is not None
    opening = cage.sigma_0 + 1e-3 * (cage.sigma_first - cage.sigma_0)
    with pytest.raises(GraspError, match="keeps clear of the object by more than 1e-09"):
        icage.place(cage, opening=opening)


def test_never_escaping() -> None:
    cage = icage.plan(icage.load(CASES / "never_escapes_a.json"))
    best = icage.place(cage, opening_error=True)
    assert best.level is None
    assert best.limited_by == "clearance"
    assert cage.sigma_largest is not None
    assert best.placement.sigma < cage.sigma_largest
    with pytest.raises(InputError, match="largest size"):
        icage.place(cage, opening=1.01 * cage.sigma_largest)


def test_a_smaller_gap_is_kept() -> None:
    cage = icage.plan(icage.load("pliers"))
    rough, fine = icage.place(cage, gap=0.1), icage.place(cage, gap=1e-5)
    assert fine.tolerance_upper <= fine.tolerance * (1.0 + 1e-5)
    assert fine.tolerance <= rough.tolerance_upper
    assert rough.boxes < fine.boxes


@pytest.mark.parametrize("errs", [False, True])
def test_misplaced_hands(errs: bool) -> None:
    cage = icage.plan(icage.load("pliers"))
    best = icage.place(cage, opening_error=errs)
    rng = np.random.default_rng(0)
    inside = draw_misplaced(best, 500, rng)
    edge = draw_misplaced(best, 500, rng, furthest=True)
    r = best.tolerance
    assert inside.shape == edge.shape == (500, 4)
    off = np.linalg.norm(cage.hand.fingers(edge) - best.fingers, axis=2).max(axis=1)
    assert off == pytest.approx(np.full(500, r), rel=1e-6)
    assert furthest_off(cage, best, inside) < r
    mean = cage.hand.fingers(inside).mean(axis=0) - best.fingers
    assert np.abs(mean).max() < 0.1 * r
    assert bool((inside[:, 3] == best.placement.sigma).all()) != errs


def test_whichever_finger_is_called_the_first() -> None:
    """The tolerance is of the hand, not of its labels: with an error of the opening, too."""
    case = icage.load(CASES / "tunnel_golden.json")
    found = [
        icage.place(icage.plan(case.outline, np.roll(case.contacts, k, axis=0)), opening_error=True)
        for k in range(3)
    ]
    for best in found[1:]:
        # each is within a thousandth of the true best one
        assert best.tolerance == pytest.approx(found[0].tolerance, rel=2e-3)
    assert min(b.tolerance_upper for b in found) >= max(b.tolerance for b in found)


def test_errors_that_reach_the_level_and_no_further() -> None:
    """All fingers off by the tolerance, away from the middle of the least circle round them."""
    cage = icage.plan(icage.load("pliers"))
    best = icage.place(cage, opening_error=True)
    assert best.limited_by == "level"
    assert best.level is not None
    fingers = best.fingers
    circle = shapely.minimum_bounding_circle(shapely.MultiPoint(fingers))
    middle = np.array([circle.centroid.x, circle.centroid.y])
    around = shapely.minimum_bounding_radius(shapely.MultiPoint(fingers))
    for share, verdict in ((0.999, "target"), (1.01, None)):
        grown = middle + (fingers - middle) * (1.0 + share * best.tolerance / around)
        sigma = float(np.hypot(*(grown[1] - grown[0])))
        assert (sigma < best.level) == (share < 1.0)
        if verdict is not None:
            assert cage.query(icage.Placement.from_contacts(grown)).verdict == verdict
