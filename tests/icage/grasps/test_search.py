"""The search for grasps: stopped at any time, within the limits of a real hand, ideas apart."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
import shapely
import shapely.ops

from icage import Case, HandLimits, InputError, Outline, plan
from icage.errors import GraspError
from icage.grasps import stages
from icage.grasps.crew import Crew
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.findings import apart, groups
from icage.grasps.of_case import best_of_case
from icage.grasps.search import best_grasps, ranked_grasps
from icage.grasps.wanted import ANY_HAND, Wanted

KEY = Outline(
    [(0, 0), (6, 0), (6, 1), (5, 1), (5, 2.2), (4, 2.2), (4, 1), (2.5, 1), (2.5, 3), (3.5, 3.6),
     (3.5, 5), (1, 5), (1, 3.4), (1.6, 3), (1.6, 1), (0, 1)]
)  # fmt: skip
RADIUS = 0.1


def draws(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def angles(contacts: np.ndarray) -> list[float]:
    found = []
    for k in range(len(contacts)):
        a, b = contacts[k - 2] - contacts[k], contacts[k - 1] - contacts[k]
        found.append(math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b)))
    return found


def sides(contacts: np.ndarray) -> np.ndarray:
    return np.hypot(*(contacts - np.roll(contacts, -1, axis=0)).T)


# ------------------------------------------------------------------ limits of a real hand


@pytest.mark.parametrize("radius", [0.0, RADIUS])
def test_no_grasp_is_flatter_or_tighter_than_asked(radius: float) -> None:
    limits = HandLimits(least_angle=math.radians(25.0), least_gap=0.6)
    found = best_grasps(
        KEY, finger_radius=radius, wanted=Wanted(limits=limits), rng=draws(), workers=2
    )
    assert len(found) >= 3
    for grasp in found:
        assert min(angles(grasp.contacts)) >= limits.least_angle - 1e-6
        assert sides(grasp.contacts).min() >= 0.6 + 2.0 * radius - 1e-6


def test_the_default_is_a_hand_that_can_be_built() -> None:
    for grasp in best_grasps(KEY, rng=draws()):
        assert min(angles(grasp.contacts)) >= math.radians(15.0) - 1e-9
        assert sides(grasp.contacts).min() >= 0.02 * KEY.diameter * (1.0 - 1e-9)


def test_fingers_1_and_2_are_furthest_apart() -> None:
    for grasp in best_grasps(KEY, rng=draws()):
        assert sides(grasp.contacts)[0] == pytest.approx(sides(grasp.contacts).max())
        assert grasp.sigma_0 == pytest.approx(sides(grasp.contacts)[0], rel=1e-12)


def test_sigma_of_the_hand_is_kept_and_cages_count_up_to_its_end() -> None:
    wide = Wanted("cage", limits=HandLimits(sigma_least=1.5, sigma_most=2.5))
    found = ranked_grasps(KEY, wanted=wide, rng=draws()).candidates
    assert found
    for grasp in found[:50]:
        assert 1.5 <= grasp.sigma_0 < 2.5
        assert grasp.level <= 2.5 * (1.0 + 1e-12)
        cage = plan(KEY, grasp.contacts)
        top = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
        assert top is not None
        assert grasp.level == pytest.approx(min(2.5, top), rel=1e-9)


@pytest.mark.parametrize("stretch", [(14.0, 22.0), (20.0, 4.0)])
@pytest.mark.parametrize("radius", [0.0, RADIUS])
def test_no_finger_touches_a_stretch_to_avoid(radius: float, stretch: tuple[float, float]) -> None:
    wanted = Wanted(avoid=(stretch,), limits=ANY_HAND)
    found = ranked_grasps(KEY, finger_radius=radius, wanted=wanted, rng=draws())
    free = ranked_grasps(KEY, finger_radius=radius, wanted=Wanted(limits=ANY_HAND), rng=draws())
    length = KEY.polygon.exterior.length
    ring = shapely.LinearRing(KEY.vertices)
    start, end = stretch
    parts = [(start, end)] if start < end else [(start, length), (0.0, end)]
    lines = [shapely.ops.substring(ring, low, high) for low, high in parts]
    met = 0
    for grasps, may in ((found, False), (free, True)):
        assert grasps.candidates
        for grasp in grasps.candidates[:: max(1, len(grasps.candidates) // 300)]:
            gap = min(shapely.Point(p).distance(line) for p in grasp.contacts for line in lines)
            met += gap <= radius + 1e-9
            assert may or gap > radius
    assert met > 0  # some would have


def test_a_stretch_beyond_the_outline_is_refused() -> None:
    with pytest.raises(InputError, match="arclengths run from 0 to"):
        ranked_grasps(KEY, wanted=Wanted(avoid=((0.0, 1e3),)), rng=draws())


def test_grasps_smaller_or_shallower_than_the_tolerance_never_rank() -> None:
    found = ranked_grasps(KEY, wanted=Wanted(limits=ANY_HAND, tolerance=0.1), rng=draws())
    for grasp in found.candidates:
        assert sides(grasp.contacts).min() >= 1.0 - 1e-9
        assert grasp.level - grasp.sigma_0 >= 0.1


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"least_angle": 1.2}, "at most 60"),
        ({"least_angle": -0.1}, "at most 60"),
        ({"least_gap": -1.0}, "0 or more"),
        ({"least_gap": math.nan}, "finite"),
        ({"sigma_least": 3.0, "sigma_most": 2.0}, "0 <= least < most"),
    ],
)
def test_limits_that_no_hand_can_meet(wrong: dict[str, float], says: str) -> None:
    with pytest.raises(InputError, match=says):
        HandLimits(**wrong)


@pytest.mark.parametrize(
    "wrong",
    [{"avoid": [(0, 0, 1)]}, {"avoid": [3]}, {"avoid": [(-1, 2)]}, {"tolerance": -1.0},
     {"seconds": 0.0}, {"limits": 3}],
)  # fmt: skip
def test_wrong_wishes_have_one_clear_error(wrong: dict[str, object]) -> None:
    with pytest.raises(InputError):
        Case("key", "mm", KEY).grasps(**wrong)  # type: ignore[arg-type]


def test_a_wanted_shape_where_no_contact_can_move() -> None:
    """Three fingers in concave vertices: the shape is what it is, wherever the forces meet."""
    turn = np.arange(6) * np.pi / 3.0
    ring = np.where(np.arange(6) % 2, 0.45, 1.0)[:, None] * np.column_stack(
        [np.cos(turn), np.sin(turn)]
    )
    for phi, found in (((60.0, 120.0), True), ((70.0, 130.0), False)):
        near = (*map(math.radians, phi), math.radians(4.0))
        bench = GraspEvaluator(Outline(ring), 0.0, Wanted(near=near, corners=3, limits=ANY_HAND))
        triples, points = bench.triples()
        assert len(triples)
        assert bool(len(bench.shaped(triples, points)[0])) == found


# ------------------------------------------------------------------ stopped at any time


def test_the_best_so_far_is_kept_when_the_time_is_over() -> None:
    case = Case("key", "mm", KEY)
    scores: list[float] = []

    def note(_stage: str, _done: int, _total: int, best: float | None) -> None:
        if best is not None:
            scores.append(best)

    whole = best_of_case(case, 3, Wanted(), draws(), 2, note)
    assert whole.ended is None
    assert scores == sorted(scores)
    short = best_of_case(case, 3, Wanted(), draws(), 2, seconds=1e-9)
    assert short.ended == "out of time"
    assert len(short.cages) > 0
    assert short.compared < whole.compared


@pytest.mark.parametrize("after", [1, 4])
def test_ctrl_c_keeps_what_there_is(after: int) -> None:
    seen = 0

    def interrupt(_stage: str, _done: int, _total: int, best: float | None) -> None:
        nonlocal seen
        seen += best is not None
        if seen >= after:
            raise KeyboardInterrupt

    found = ranked_grasps(KEY, rng=draws(), progress=interrupt)
    assert found.ended == "interrupted"
    assert found.candidates
    assert plan(KEY, found.candidates[0].contacts).status != "not_a_cage"


def test_nothing_found_in_time_is_said() -> None:
    def interrupt(_stage: str, _done: int, _total: int, _best: float | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(GraspError, match="the search was interrupted"):
        ranked_grasps(KEY, rng=draws(), progress=interrupt)


# ------------------------------------------------------------------ the list


def test_no_two_entries_are_one_idea_and_all_others_are_counted() -> None:
    found = ranked_grasps(KEY, rng=draws())
    contacts = np.array([c.contacts for c in found.candidates])
    every = groups(contacts, KEY.diameter, len(contacts))
    assert sorted(np.concatenate(every).tolist()) == list(range(len(contacts)))
    for one, other in combinations(every, 2):
        assert apart(contacts[one[0]], contacts[other[0]][None])[0] >= 0.08 * KEY.diameter
    planned = best_of_case(Case("key", "mm", KEY), 5, Wanted(), draws())
    assert len(planned.alike) == len(planned.cages) == 5
    assert planned.alike[0] == len(every[0]) - 1


@pytest.mark.parametrize("aim", ["first", "cage"])
@pytest.mark.parametrize("radius", [0.0, RADIUS])
def test_the_level_at_which_a_search_ends_is_that_of_the_plan(aim: str, radius: float) -> None:
    """The early end loses nothing: a batch of candidates against one plan each."""
    bench = GraspEvaluator(KEY, radius, Wanted(aim, limits=ANY_HAND))  # type: ignore[arg-type]
    found = bench.grasps(*bench.triples())
    assert len(found) >= 20
    for row in np.linspace(0, len(found) - 1, 20).astype(int):
        cage = plan(bench.outline, found.contacts[row])
        top = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
        level = cage.sigma_first if aim == "first" and cage.sigma_first is not None else top
        assert found.sigma_0[row] == pytest.approx(cage.sigma_0, rel=1e-9)
        assert found.level[row] == pytest.approx(level, rel=1e-9)


@pytest.mark.parametrize("radius", [0.0, RADIUS])
def test_no_random_grasp_is_better(radius: float) -> None:
    """A thousand points of concurrency of random triples, against the whole search."""
    wanted = Wanted(limits=ANY_HAND)
    best = ranked_grasps(KEY, finger_radius=radius, wanted=wanted, rng=draws()).candidates[0]
    bench = GraspEvaluator(KEY, radius, wanted)
    triples, points = bench.triples()
    rng = draws(1)
    rows = rng.integers(0, len(triples), 1000)
    near = points[rows] + 0.1 * KEY.diameter * rng.standard_normal((1000, 2))
    tried = bench.grasps(triples[rows], near)
    assert len(tried) >= 100
    assert tried.score.max() <= best.score * (1.0 + 1e-9)


def test_a_search_that_is_larger_than_allowed_is_broken_off_and_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("icage.grasps.evaluator._SEARCH_LIMIT", 8)
    bench = GraspEvaluator(KEY, 0.0, Wanted("cage", limits=ANY_HAND))
    bench.grasps(*bench.triples())
    assert bench.broken_off > 0


def test_triples_left_out_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "_MOST_TRIPLES", 10)
    found = ranked_grasps(KEY, rng=draws())
    assert found.triples_left_out == found.triples - 10 > 0


def test_a_crew_does_all_the_work_in_order() -> None:
    with Crew(3, lambda *_: None) as crew:
        assert list(crew.map(lambda k: k * k, list(range(50)), "squares")) == [
            k * k for k in range(50)
        ]
