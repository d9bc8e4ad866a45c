"""Shelves: hands that can only slide along parallel edges, below sigma_first."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

import icage
from icage.cage import Cage
from icage.formats.plan_json import plan_document, plan_summary
from icage.kernels.locate import depth_inside
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import draw_starts
from models import CASES

STEPS = ((0, 0), (8, 0), (8, 1), (6, 1), (6, 2), (5, 2), (5, 3), (2, 3), (2, 2), (0, 2))
"""A stair: edges in two directions only."""


def best(rows: np.ndarray, radius: float, top: int = 5) -> list[Cage]:
    """The best cages of an outline, those with a shelf first."""
    outline = Outline(rows)
    case = icage.Case("stair", "m", outline, radius)
    found = [plan(outline, g.contacts, radius) for g in case.grasps(top=top)]
    return sorted(found, key=lambda cage: cage.shelf is None)


@cache
def stair(radius: float) -> Cage:
    return best(np.array(STEPS, dtype=np.float64), radius)[0]


@pytest.fixture(params=[0.0, 0.2], ids=["points", "discs"])
def cage(request: pytest.FixtureRequest) -> Cage:
    return stair(request.param)


def test_a_shelf_is_below_sigma_first_and_caps_the_guaranteed_set(cage: Cage) -> None:
    assert cage.shelf is not None
    assert cage.sigma_first is not None
    assert cage.sigma_0 < cage.shelf.sigma < cage.sigma_first
    assert cage.sigma_guaranteed == cage.shelf.sigma
    starts = draw_starts(cage, "guaranteed", 50, np.random.default_rng(0)).placements
    assert (starts[:, 3] < cage.shelf.sigma).all()
    assert icage.place(cage).placement.sigma < cage.shelf.sigma


def test_the_hand_keeps_its_size_and_its_direction_along_the_slide(cage: Cage) -> None:
    assert cage.shelf is not None
    one, other = cage.shelf.contacts
    size = cage.outline.diameter
    np.testing.assert_allclose(one - one[0], other - other[0], atol=1e-9 * size)
    assert np.hypot(*(one - other)[0]) > 1e-3 * size
    assert np.hypot(*(one[1] - one[0])) == pytest.approx(cage.shelf.sigma, rel=1e-9)
    depth = depth_inside(cage.outline.vertices, cage.shelf.contacts.reshape(-1, 2), 0.0)
    assert (depth <= -cage.finger_radius + 1e-9 * size).all()


def test_no_hand_beside_the_slide_is_smaller(cage: Cage) -> None:
    """Brute force: of random hands near the middle of the slide those that are clear are larger."""
    assert cage.shelf is not None
    rng = np.random.default_rng(1)
    middle = cage.shelf.contacts.mean(axis=0)
    size = cage.outline.diameter
    d, w = complex(*middle[0]), complex(*(middle[1] - middle[0]))
    shift = size * 10.0 ** rng.uniform(-6, -2.5, (20_000, 4)) * rng.choice([-1, 1], (20_000, 4))
    d, w = d + shift[:, 0] + 1j * shift[:, 1], w + shift[:, 2] + 1j * shift[:, 3]
    fingers = d[:, None] + w[:, None] * cage.hand.z
    away = shapely.distance(cage.outline.polygon, shapely.points(fingers.real, fingers.imag))
    inside = shapely.contains_xy(cage.outline.polygon, fingers.real, fingers.imag)
    clear = ((away >= cage.finger_radius) & ~inside).all(axis=1)
    assert clear.sum() > 100
    assert np.abs(w[clear]).min() >= cage.shelf.sigma * (1.0 - 1e-9)


def test_the_least_friction_jams_there(cage: Cage) -> None:
    assert cage.shelf is not None
    level = cage.friction(1e-6)
    assert level.sigma_first is not None
    assert level.sigma_first <= cage.shelf.sigma * (1.0 + 1e-9)


def test_queries_and_documents_tell_of_it(cage: Cage) -> None:
    assert cage.shelf is not None
    middle = cage.shelf.contacts.mean(axis=0)
    out = 1e-6 * cage.outline.diameter  # a hair off the edges
    side = (middle[1] - middle[0]) * (1.0 + out / cage.shelf.sigma)
    rows = np.array([[*middle[0], np.arctan2(side[1], side[0]), np.hypot(*side)]])
    assert cage.query(rows).verdict[0] != icage.PlacementClass.TARGET
    document = plan_document(cage, (), "stair", "m")
    assert document["shelf"]["sigma"] == cage.shelf.sigma
    assert any(line.startswith("shelf ") for line in plan_summary(cage, "stair", "m"))


@pytest.mark.parametrize("radius", [0.0, 0.2], ids=["points", "discs"])
def test_it_moves_and_grows_with_the_object(radius: float) -> None:
    here = stair(radius)
    assert here.shelf is not None
    turn, scale, shift = np.exp(0.7j), 3.5, 40.0 - 11.0j
    rows = (here.outline.vertices @ [1.0, 1.0j]) * turn * scale + shift
    contacts = (here.contacts @ [1.0, 1.0j]) * turn * scale + shift
    there = plan(
        Outline(np.column_stack([rows.real, rows.imag])),
        np.column_stack([contacts.real, contacts.imag]),
        radius * scale,
    )
    assert there.shelf is not None
    assert there.shelf.sigma == pytest.approx(scale * here.shelf.sigma, rel=1e-9)


@pytest.mark.parametrize("name", ["L_best", "T_best", "triangle_eq_best", "disc_Y", "hammer_best"])
def test_a_cage_without_one(name: str) -> None:
    cage = plan(icage.load(str(CASES / f"{name}.json")))
    assert cage.shelf is None
    assert cage.sigma_guaranteed == cage.sigma_first
    assert "shelf" not in plan_document(cage, (), name, "m")


def test_what_the_contact_space_plans_has_none() -> None:
    here = stair(0.0)
    cage = plan(here.outline, here.contacts, 0.0, "contact-space")
    assert cage.shelf is None
    assert cage.sigma_guaranteed == cage.sigma_first
