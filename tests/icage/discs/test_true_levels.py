"""Levels of disc fingers on the true curve: elements, minima, punctures and what encloses them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import icage
from icage.cage import Cage
from icage.cells.method import CELLS
from icage.contact_space.method import ContactSpace
from icage.discs.critical import CriticalHands
from icage.discs.curve import TrueCurve
from icage.discs.true_levels import true_levels
from icage.errors import GraspError
from icage.hand import HandShape
from icage.outline import Outline
from icage.placement_class import PlacementClass
from icage.planner import METHODS, plan
from icage.sampling import draw_starts
from tests.oracles.geometry import Floats, Ring
from tests.oracles.polygons import FAMILIES, rotated
from tests.oracles.statics import is_strict_minimum
from tests.oracles.targets import Target, grasp_on, random_target

seeds = st.integers(0, 2**32 - 1)
families = st.sampled_from(sorted(FAMILIES))
radii = st.floats(math.log(1e-3), math.log(0.4)).map(math.exp)
"""[diameter]"""

EXACT = 1e-9
ROUNDING = 1e-12
CASES = sorted(
    path
    for folder in ("cases", "hard")
    for path in (Path(__file__).parents[3] / "models" / folder).glob("*.json")
    if '"finger_radius": 0.0' not in path.read_text() and '"finger_radius"' in path.read_text()
)


def drawn_target(seed: int, number: int) -> Target:
    rng = np.random.default_rng([seed, number])
    return random_target(rng, radius=float(rng.uniform(0.01, 0.08)))


def cage_of(target: Target) -> Cage:
    return plan(Outline(target.vertices), target.contacts, target.radius)


def levels(cage: Cage) -> list[float]:
    return [np.inf if x is None else x for x in (cage.sigma_0, cage.sigma_first, cage.sigma_max)]


def size_of_hand(contacts: Floats) -> float:
    return float(np.hypot(*(contacts[1] - contacts[0])))


# ------------------------------------------------------------------ the curve


@settings(max_examples=60)
@given(families, seeds, radii)
def test_the_curve_is_that_of_shapely(family: str, seed: int, radius: float) -> None:
    """Area of the outer ring, to the sagitta of its buffer; every vertex at the radius."""
    ring = Ring.of(FAMILIES[family](np.random.default_rng(seed)))
    outline, r = Outline(ring.vertices), radius * ring.diameter
    curve = TrueCurve.of(outline, r)
    fine = shapely.Polygon(outline.polygon.buffer(r, quad_segs=256).exterior)
    assert curve.inner(256).area == pytest.approx(fine.area, rel=1e-5)
    inner, outer = curve.inner(8), curve.outer(8)
    assert inner.polygon.difference(outer.polygon).area <= 1e-13 * inner.area
    gaps = shapely.distance(shapely.points(inner.vertices), outline.polygon)
    assert np.abs(gaps - r).max() <= ROUNDING * ring.diameter
    clear = shapely.distance(shapely.points(outer.vertices), outline.polygon)
    assert clear.min() >= r - ROUNDING * ring.diameter
    assert curve.sagitta(8) <= r * (1.0 - math.cos(math.pi / 32)) * (1.0 + 1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_a_slot_as_wide_as_the_finger_is_closed(angle: float) -> None:
    slotted = np.array(
        [[0, 0], [6, 0], [6, 4], [4, 4], [4, 2], [2, 2], [2, 4], [0, 4]], dtype=float
    )
    outline = Outline(rotated(slotted, angle))
    inside = shapely.Point(rotated(np.array([[3.0, 3.5]]), angle)[0])
    for radius, closed in ((1.0, True), (0.99, False), (1.01, True)):
        assert TrueCurve.of(outline, radius).inner(16).polygon.contains(inside) == closed


def test_corners_two_radii_apart_do_not_break_a_plan() -> None:
    """The curve touches itself in a point, between a pocket and the outside."""
    ring = Ring.of(np.array(
        [[0, 0], [8, 0], [8, 6], [5, 5], [6, 1], [2, 1], [3, 5], [0, 6]], dtype=float
    ))  # fmt: skip
    contacts = grasp_on(ring, np.random.default_rng(2), 1.0)
    assert contacts is not None
    cage = plan(Outline(ring.vertices), contacts, 1.0)
    assert cage.status == "cage"
    assert any("not solved on the true curve" in w for w in cage.warnings)
    assert cage.sigma_first is not None
    assert cage.sigma_max is not None
    assert cage.sigma_0 < cage.sigma_first <= cage.sigma_max
    for one in (*cage.punctures, *cage.grasps):
        assert size_of_hand(one.contacts) == pytest.approx(one.sigma, rel=ROUNDING)


# ------------------------------------------------------------------ cases and random targets


def check_levels(cage: Cage, radius: float) -> None:
    ring = Ring.of(cage.outline.vertices)
    for one in (*cage.punctures, *cage.grasps):
        assert abs(size_of_hand(one.contacts) - one.sigma) <= ROUNDING * ring.diameter
        depths = [ring.depth(p, radius) for p in one.contacts]
        assert max(depths) <= EXACT * ring.diameter
    for grasp in cage.grasps:
        if grasp.plateau is None and not grasp.free_fingers:
            assert is_strict_minimum(ring, grasp.contacts, radius)
    if cage.sigma_max is not None:
        assert cage.sigma_max_lower is not None
        assert cage.sigma_max_upper is not None
        assert cage.sigma_max_lower <= cage.sigma_max * (1.0 + EXACT)
        assert cage.sigma_max <= cage.sigma_max_upper * (1.0 + EXACT)
        assert cage.sigma_max_upper / cage.sigma_max_lower - 1.0 < 1e-4
        assert cage.punctures[-1].sigma == cage.sigma_max
    if cage.sigma_first is not None:
        assert cage.punctures[0].sigma == cage.sigma_first


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_levels_of_the_shipped_cases(path: Path) -> None:
    case = icage.load(path)
    if case.finger_radius == 0.0 or case.target is None:
        pytest.skip("points")
    cage = plan(case)
    if cage.status == "not_a_cage":
        return
    check_levels(cage, case.finger_radius)
    assert not [w for w in cage.warnings if "polygon" in w]


@pytest.mark.parametrize("number", range(12))
def test_levels_of_random_targets(number: int) -> None:
    target = drawn_target(41, number)
    try:
        cage = cage_of(target)
    except GraspError:
        pytest.skip("a contact in a pocket that is closed")
    assert cage.status != "not_a_cage"
    check_levels(cage, target.radius)


def test_a_shallow_minimum_that_chords_hide_is_found() -> None:
    """Chords of 8 and 16 segments have no minimum there, tangents and finer chords do."""
    target = drawn_target(7, 121)
    cage = cage_of(target)
    assert cage.sigma_first == pytest.approx(0.4764218839638767, rel=EXACT)
    curve = TrueCurve.of(cage.outline, target.radius)
    coarse = CELLS.local_cage(curve.inner(8), cage.hand, cage.contacts, 1e-5, 1e-3)
    assert coarse is not None
    assert coarse.sigma_first > 0.53


def test_minima_that_only_chords_have_do_not_count() -> None:
    target = drawn_target(8, 25)
    cage = cage_of(target)
    assert len(cage.grasps) == 1
    assert cage.sigma_first == cage.sigma_max
    curve = TrueCurve.of(cage.outline, target.radius)
    chords = CELLS.local_cage(curve.inner(64), cage.hand, cage.contacts, 1e-2, 1e-1)
    assert chords is not None
    assert chords.sigma_first < 0.99 * cage.sigma_first
    # and a query agrees: whoever closes from between them ends in the target
    rows = np.array([g.placement.as_array() for g in chords.cage(
        cage.contacts, cage.outline, target.radius).grasps])  # fmt: skip
    rows[:, 3] *= 1.0 + 1e-4
    answers = cage.query(rows)
    free = answers.verdict != 4
    assert free.any()
    assert set(answers.verdict[free].tolist()) == {0}


@pytest.mark.parametrize("number", [3, 7, 121])
def test_levels_do_not_depend_on_where_the_object_is(number: int) -> None:
    target = drawn_target(7, number)
    here = levels(cage_of(target))
    for angle, shift, unit in ((1.0, (0.0, 0.0), 1.0), (2.5, (300.0, -50.0), 1e3)):
        there = plan(
            Outline(unit * rotated(target.vertices, angle, shift)),
            unit * rotated(target.contacts, angle, shift),
            unit * target.radius,
        )
        assert np.array(levels(there)) / unit == pytest.approx(here, rel=EXACT)
    other = plan(
        Outline(np.roll(target.vertices, 2, axis=0)), np.roll(target.contacts, 1, axis=0),
        target.radius,
    )  # fmt: skip
    # sigma is another side of the triangle now
    share = size_of_hand(other.contacts) / here[0]
    assert np.array(levels(other)) / share == pytest.approx(here, rel=EXACT)


@pytest.mark.parametrize("number", [0, 4, 121])
def test_both_methods_lead_to_the_same_hands(number: int) -> None:
    target = drawn_target(7, number)
    cells = cage_of(target)
    paper = plan(Outline(target.vertices), target.contacts, target.radius, ContactSpace())
    assert levels(paper) == pytest.approx(levels(cells), rel=EXACT)


PLUS = np.array(
    [[1, -2], [1, -1], [3, -1], [3, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 1], [-1, 1],
     [-1, 0], [0, 0], [0, -2]], dtype=float,
)  # fmt: skip


@pytest.mark.parametrize("number", range(10))
def test_of_two_nearly_equal_punctures_on_one_way_the_higher_is_the_level(number: int) -> None:
    """An inner polygon through the contacts of the lower one has the higher one below it.

    Corners are moved by 1e-6 to 1e-9. sigma_max may then be too low by as much, with an upper bound
    that is 8e-6 above it; polygons that go through the contacts of both enclose it to 1e-8.
    """
    moves = np.random.default_rng(number).uniform(-1.0, 1.0, PLUS.shape)
    ring = PLUS + moves * 10.0 ** -(6 + number % 4)
    radius = 0.04157640941816814
    contacts = np.array(
        [[2.0406749940317317, 1.0086106144162725], [-radius, 1.0 + radius], [-radius, -radius]]
    )
    cages = [plan(ring, contacts, radius, method=method) for method in METHODS]
    for cage in cages:
        assert levels(cage) == pytest.approx(levels(cages[0]), rel=EXACT)
        assert cage.sigma_max is not None
        assert cage.sigma_max_lower is not None
        assert cage.sigma_max_upper is not None
        assert cage.sigma_max_upper / cage.sigma_max - 1.0 < EXACT
        assert cage.sigma_max / cage.sigma_max_lower - 1.0 < 2e-8


@pytest.mark.parametrize("unit", [1.0, 1e-5])
def test_of_two_nearly_equal_ways_out_the_lower_one_is_the_level(unit: float) -> None:
    """A polygon's puncture was solved to the other one, 2e-6 higher, and drawn through in vain."""
    ring = unit * np.array(
        [[1.1884227240383039, 0.0240551077532889], [0.99035227003192, 0.0240551077532889],
         [0.198070454006384, 0.02061866378853334], [0.0, 0.01374577585902223],
         [0.5942113620191519, 0.003436443964755557], [1.1884227240383039, 0.0],
         [1.1884227240383039, 0.003436443964755557], [0.99035227003192, 0.02061866378853334],
         [0.396140910412768, 0.01374577585902223]]
    )  # fmt: skip
    outline = Outline(ring)
    radius = 0.06379160915434112 * outline.diameter
    contacts = outline.diameter * np.array(
        [[1.0637247250289243, 0.0011565629137616318], [0.9332709081496117, 0.08403146014499699],
         [0.9328975356554494, -0.06340499565437042]]
    )  # fmt: skip
    for method in METHODS:
        cage = plan(outline, contacts, radius, method=method)
        assert cage.sigma_max == pytest.approx(0.1549568299049862 * outline.diameter, rel=EXACT)
        assert cage.sigma_max_upper is not None
        assert cage.sigma_max_upper <= cage.sigma_max * (1.0 + EXACT)


def test_a_target_further_off_than_is_promised_is_none() -> None:
    """The object is a needle, 2e6 times as long as thick; a minimum of a chord was 6e-5 away."""
    ring = np.array(
        [[-0.1372088099, -0.0021859027], [0.1210458457, -0.0015090024], [0.1155018538, 0.407900591],
         [0.4919577213, 0.452100878], [0.4733504083, 0.524593886], [0.1791156205, 0.53278174],
         [0.1817216075, 0.4826046617], [-0.1877034629, 0.4868155351], [-0.164137608, 0.5300153886],
         [-0.5080422787, 0.5259006168], [-0.461571171, 0.4598835215], [-0.1328088962, 0.4080373022]]
    ) * np.array([1.0, 1e-6])  # fmt: skip
    outline = Outline(ring)
    radius = 0.03427086798007298 * outline.diameter
    contacts = outline.diameter * np.array(
        [[0.12105419295614518, -0.034270459427572814], [0.21169248239131272, -0.03427044878558596],
         [0.17911460069107848, 0.03427135061444986]]
    )  # fmt: skip
    for method in METHODS:
        cage = plan(outline, contacts, radius, method=method)
        assert cage.status == "not_a_cage"


# ------------------------------------------------------------------ what is not solved is said


def test_what_cannot_be_solved_keeps_its_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    target = drawn_target(7, 4)
    solved = cage_of(target)
    monkeypatch.setattr(CriticalHands, "puncture", lambda *_: None)
    cage = cage_of(target)
    assert any("not solved on the true curve" in w for w in cage.warnings)
    assert cage.sigma_max is not None
    assert cage.sigma_max_upper is not None
    assert solved.sigma_max is not None
    assert cage.sigma_max <= solved.sigma_max * (1.0 + EXACT)
    assert cage.sigma_max_upper >= solved.sigma_max * (1.0 - EXACT)


def test_the_levels_of_one_candidate() -> None:
    """What the grasp search asks: a local cage on some inner polygon, solved."""
    target = drawn_target(7, 0)
    whole = cage_of(target)
    outline = whole.outline
    hand = HandShape.from_contacts(target.contacts)
    curve = TrueCurve.of(outline, target.radius)
    polygon = curve.inner(16, curve.on_arcs(target.contacts))
    local = CELLS.local_cage(polygon, hand, target.contacts, 1e-3, 1e-2)
    assert local is not None
    found = true_levels(
        CriticalHands(outline, target.radius, hand),
        local.cage(target.contacts, outline, target.radius),
        curve.sagitta(16),
    )
    assert found.first_solved
    assert found.max_solved
    assert [found.sigma_0, found.sigma_first, found.sigma_max] == pytest.approx(
        levels(whole), rel=EXACT
    )


def test_what_the_polygon_joins_too_early_is_not_the_targets() -> None:
    """Two punctures of the polygon are one on the true curve; behind both is a smaller hand."""
    target = random_target(np.random.default_rng(3), "spiral", 0.04)
    assert target is not None
    cage = plan(Outline(target.vertices), target.contacts, target.radius)
    assert cage.sigma_first == cage.sigma_max
    work = cage.work
    assert work is not None
    assert work.polygon_first is not None
    assert work.polygon_first < cage.sigma_first * (1.0 - 1e-5)
    starts = draw_starts(cage, "guaranteed", 100, np.random.default_rng(0)).placements
    assert starts[:, 3].min() >= cage.sigma_0 * (1.0 - 1e-9)
    # the hand of the other basin that was once called target
    other = np.array(
        [[0.5689344908572009, -0.04864633416535902], [0.15231566002154015, -0.2053903134955949]]
    )
    side = other[1] - other[0]
    row = [*other[0], np.arctan2(side[1], side[0]), np.hypot(*side)]
    assert cage.query(np.array([row])).verdict[0] != PlacementClass.TARGET
    for region in cage.regions("sigma_first"):
        assert region.area < 1e-4 * cage.outline.diameter**2


def test_a_hand_that_is_tiny_beside_its_object_has_a_bracket() -> None:
    """A corner a million hands away: coordinates are rounded, the inner level is above."""
    far = 1799999.9999991583
    outline = Outline(
        [
            (-0.5, 0),
            (0.5, 0),
            (0.5, 2.4),
            (far, 2.4),
            (1.8, 3.4),
            (-1.8, 3.4),
            (-1.8, 2.4),
            (-0.5, 2.4),
        ]
    )
    contacts = [
        (0.602621878758869, 2.297378121241131), (0.11537121366031844, 3.5026218787588688),
        (-0.602621878758869, 2.297378121241131),
    ]  # fmt: skip
    cage = plan(outline, contacts, 0.10262187875886895)
    assert cage.status == "cage"
    assert cage.sigma_max is not None
    assert cage.sigma_max_lower is not None
    assert cage.sigma_max_upper is not None
    assert cage.sigma_max_lower <= cage.sigma_max <= cage.sigma_max_upper
    # both bounds are those of coordinates of this size, not better than a billionth of them
    assert cage.sigma_max_upper - cage.sigma_max_lower < 1e-9 * outline.diameter
