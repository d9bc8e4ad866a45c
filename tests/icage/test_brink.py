"""Brinks: hands whose forces balance with a finger at the very end of an edge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
import shapely

import icage
from icage.brink import brink_of
from icage.cage import Cage
from icage.formats.plan_json import plan_document, plan_summary
from icage.outline import Outline
from icage.planner import plan
from icage.sampling import draw_starts
from models import CASES
from tests.oracles.polygons import star_polygon

Points = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Made:
    """A lattice polygon with a hand that balances although it is a minimum to one side only.

    Its normals meet in one point, ``deep`` inside the object under a vertex: on two edges in their
    midst, on a third one at that vertex. What it closes to from the other side is the target, for
    fingers of radius 0 and 0.15. Edge q begins at vertex q.
    """

    ring: Points
    edges: tuple[int, int]
    third: int
    at_end: bool
    deep: float
    targets: tuple[Points, Points]

    def hand(self, radius: float) -> np.ndarray:
        """The finger centres, counterclockwise."""
        ring = np.array(self.ring)
        after = np.roll(ring, -1, axis=0)
        side = (after - ring) / np.hypot(*(after - ring).T)[:, None]
        out = np.column_stack([side[:, 1], -side[:, 0]])
        vertex = (after if self.at_end else ring)[self.third]
        meet = vertex - self.deep * out[self.third]
        fingers = [vertex + radius * out[self.third]]
        for q in self.edges:
            along = (meet - ring[q]) @ side[q]
            fingers.append(ring[q] + along * side[q] + radius * out[q])
        hand = np.array(fingers)
        x, y = (hand - hand.mean(axis=0)).T
        return hand[np.argsort(np.arctan2(y, x))]


MADE = (
    Made(
        ((4, 6), (0, 6), (3, 1), (5, 3), (4, 4), (5, 6)), (0, 1), 2, True, 2.3747915791855547,
        (((1.2623519143901714, 3.8960801426830476), (4.0, 4.0), (2.2939436265206066, 6.0)),
         ((1.1911230226705902, 3.7232473674734186), (4.182514076993645, 4.02961795736232),
          (2.1695589705797422, 6.15))),
    ),
    Made(
        ((2, 0), (3, 0), (4, 3), (5, 1), (5, 0), (6, 5), (5, 5), (1, 1)), (4, 6), 0, True,
        1.5563236391538113,
        (((4.167668440202686, 2.6646631195946275), (5.598249346232269, 2.9912467311593436),
          (4.072629843581906, 4.072629843581049)),
         ((4.087057815086688, 2.4904741732016564), (5.7308016830504656, 2.8891554882134125),
          (3.9620893576138805, 4.174221391969845))),
    ),
    Made(
        ((1, 2), (0, 0), (3, 0), (3, 1), (4, 1), (2, 3), (2, 4), (0, 2), (0, 1)), (1, 4), 7, True,
        0.9793260812469121,
        (((0.49029066204986105, 0.9805813240997221), (1.293286293594809, 0.0),
          (2.85710139263362, 2.1428986073660594)),
         ((0.33003798116504823, 0.9954861589550648), (1.2636262499066597, -0.15),
          (2.9735331298391823, 2.2385989045167816))),
    ),
)  # fmt: skip
RADII = (0.0, 0.15)


@cache
def caged(number: int, which: int) -> Cage:
    made = MADE[number]
    return plan(Outline(np.array(made.ring)), np.array(made.targets[which]), RADII[which])


@pytest.fixture(
    params=[(n, w) for n in range(len(MADE)) for w in range(len(RADII))],
    ids=[f"{n}-{kind}" for n in range(len(MADE)) for kind in ("points", "discs")],
)
def which(request: pytest.FixtureRequest) -> tuple[int, int]:
    return request.param


@pytest.fixture
def cage(which: tuple[int, int]) -> Cage:
    return caged(*which)


def clear_hands(cage: Cage, hand: np.ndarray, reach: float, count: int) -> np.ndarray:
    """Sizes of random hands that are clear of the object within ``reach`` [diameter] of one."""
    rng = np.random.default_rng(1)
    size = cage.outline.diameter
    shift = reach * size * rng.uniform(-1.0, 1.0, (count, 4))
    d = complex(*hand[0]) + shift[:, 0] + 1j * shift[:, 1]
    w = complex(*(hand[1] - hand[0])) + shift[:, 2] + 1j * shift[:, 3]
    fingers = d[:, None] + w[:, None] * cage.hand.z
    away = shapely.distance(cage.outline.polygon, shapely.points(fingers.real, fingers.imag))
    inside = shapely.contains_xy(cage.outline.polygon, fingers.real, fingers.imag)
    return np.abs(w[((away >= cage.finger_radius) & ~inside).all(axis=1)])


def test_a_hand_made_to_stand_on_one_is_found(which: tuple[int, int], cage: Cage) -> None:
    hand = MADE[which[0]].hand(RADII[which[1]])
    assert cage.brink is not None
    found = cage.brink.contacts
    # the target's own finger 1 may be another one of the hand's
    turned = [np.roll(hand, k, axis=0) for k in range(len(hand))]
    off = min(float(np.abs(one - found).max()) for one in turned)
    assert off <= 1e-9 * cage.outline.diameter
    assert cage.brink.sigma == pytest.approx(np.hypot(*(found[1] - found[0])), rel=1e-9)


def test_it_caps_the_guaranteed_set(cage: Cage) -> None:
    assert cage.brink is not None
    assert cage.sigma_first is not None
    assert cage.sigma_0 < cage.brink.sigma < cage.sigma_first
    assert cage.sigma_guaranteed == cage.brink.sigma
    starts = draw_starts(cage, "guaranteed", 50, np.random.default_rng(0)).placements
    assert (starts[:, 3] < cage.brink.sigma).all()
    assert icage.place(cage).placement.sigma < cage.brink.sigma


def test_smaller_hands_are_beside_it(cage: Cage) -> None:
    """Brute force: it is no minimum, so no level may tell of it."""
    assert cage.brink is not None
    sizes = clear_hands(cage, cage.brink.contacts, 3e-2, 100_000)
    assert sizes.min() < cage.brink.sigma * (1.0 - 1e-4)
    assert all(abs(one.sigma / cage.brink.sigma - 1.0) > 1e-6 for one in cage.punctures)


def test_the_least_friction_jams_there(cage: Cage) -> None:
    assert cage.brink is not None
    level = cage.friction(1e-6)
    assert level.sigma_first is not None
    assert level.sigma_first <= cage.brink.sigma * (1.0 + 1e-6)


def test_queries_and_documents_tell_of_it(cage: Cage) -> None:
    assert cage.brink is not None
    hand = cage.brink.contacts
    side = (hand[1] - hand[0]) * (1.0 + 1e-3)
    x, y = hand[0] - 0.5e-3 * (hand[1] - hand[0])
    row = np.array([x, y, np.arctan2(side[1], side[0]), np.hypot(*side)])
    assert cage.query(row).verdict != icage.PlacementClass.TARGET
    document = plan_document(cage, (), "lattice", "m")
    assert document["brink"]["sigma"] == cage.brink.sigma
    lines = list(plan_summary(cage, "lattice", "m"))
    assert any(line.startswith("brink ") for line in lines)
    assert any("or stays on a brink" in line for line in lines)


def test_it_moves_and_grows_with_the_object(which: tuple[int, int], cage: Cage) -> None:
    assert cage.brink is not None
    turn, scale, shift = np.exp(0.7j), 3.5, 40.0 - 11.0j

    def moved(points: np.ndarray) -> np.ndarray:
        there = (points @ [1.0, 1.0j]) * turn * scale + shift
        return np.column_stack([there.real, there.imag])

    radius = RADII[which[1]]
    there = plan(Outline(moved(cage.outline.vertices)), moved(cage.contacts), scale * radius)
    assert there.brink is not None
    size = there.outline.diameter
    np.testing.assert_allclose(there.brink.contacts, moved(cage.brink.contacts), atol=1e-8 * size)


def test_other_names_of_the_fingers_change_nothing(which: tuple[int, int], cage: Cage) -> None:
    assert cage.brink is not None
    there = plan(cage.outline, np.roll(cage.contacts, 1, axis=0), RADII[which[1]])
    assert there.brink is not None
    size = cage.outline.diameter
    np.testing.assert_allclose(
        there.brink.contacts, np.roll(cage.brink.contacts, 1, axis=0), atol=1e-8 * size
    )


def test_a_foot_off_the_end_by_much_more_than_a_hair_is_none() -> None:
    """The vertex moved along its edge: the hand goes past it, or rests short of it as a grasp."""
    made = MADE[1]
    for moved, grasps in ((-0.05, 1), (0.05, 2)):
        ring = np.array(made.ring, dtype=np.float64)
        ring[1, 0] += moved
        there = plan(Outline(ring), np.array(made.targets[0]), 0.0)
        assert there.brink is None
        assert len(there.grasps) == grasps


def test_a_minimum_too_shallow_to_count_is_one() -> None:
    """A tenth of what the search proposes on stars: the foot 1e-6 beside a vertex, 2e-12 deep."""
    outline = Outline(star_polygon(np.random.default_rng([0, 8, 3])))
    contacts = [
        [-0.009375546429175263, 0.41751739659948084],
        [-0.31765081965024916, -0.37690108160589364],
        [0.36852378536333047, -0.26661320805112176],
    ]
    cage = plan(outline, contacts, 0.0)
    assert cage.brink is not None
    assert len(cage.grasps) == 1
    assert cage.brink.sigma == pytest.approx(0.8715145966727527, rel=1e-9)
    away = outline.vertices[:, None] - cage.brink.contacts
    vertex = np.hypot(away[..., 0], away[..., 1]).min()
    assert 1e-6 < vertex < 2e-6


def test_a_grasp_of_the_plan_may_be_one() -> None:
    """A minimum of chords, followed down the true curve, comes to a stop on a brink."""
    ring = [
        [0.4437915394789664, 0.034798342086403984],
        [0.200030094393338, 0.3206456538378721],
        [-0.0943384948139436, 0.7369704529807647],
        [-0.6631034649510917, 0.7467255615895141],
        [-0.6948261961468519, 0.23761357120482463],
        [-0.861873138199469, -0.378049160837765],
        [-0.19485921808936366, -0.47821352701875197],
        [0.33517358330454755, -0.5300195111302483],
        [0.5037046828189589, -0.2575698743492043],
    ]
    target = [
        [-0.5657969394209847, -0.4826678839090345],
        [0.5110869852433833, 0.0027436807169848865],
        [-0.5074044718593205, 0.8035542814478865],
    ]
    cage = plan(ring, target, 0.0594904241708276)
    assert cage.brink is not None
    assert cage.sigma_first is not None
    assert cage.brink.sigma < cage.sigma_first * (1.0 - 1e-4)
    off = [float(np.abs(one.contacts - cage.brink.contacts).max()) for one in cage.grasps]
    assert min(off) < 1e-9


NONE = ("L_best", "T_best", "triangle_eq_best", "disc_Y", "hammer_best", "notched_bar_best")
"""Of the last a finger stands on the line of an edge beyond its end, where it touches nothing."""


@pytest.mark.parametrize("name", NONE)
def test_a_cage_without_one(name: str) -> None:
    cage = plan(icage.load(str(CASES / f"{name}.json")))
    assert cage.brink is None
    assert cage.sigma_guaranteed == cage.sigma_first
    assert "brink" not in plan_document(cage, (), name, "m")


def test_the_target_is_none_on_its_own_plateau_or_beside_it() -> None:
    """Two fingers between parallel edges: everything at the least size is the target."""
    cage = plan([[0, 0], [4, 0], [4, 1], [0, 1]], [[1.0, 0.0], [3.0, 0.0], [2.0, 1.0]])
    if cage.work is not None:
        assert brink_of(cage, cage.work) is None


def test_what_the_contact_space_plans_has_none() -> None:
    here = caged(0, 0)
    cage = plan(here.outline, here.contacts, 0.0, "contact-space")
    assert cage.brink is None
    assert cage.sigma_guaranteed == cage.sigma_first
