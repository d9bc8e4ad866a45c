"""Starts lie in their set, clear of the object, and are uniform in it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.stats import ks_2samp

from icage import sampling as starts
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.cells.membership import TARGET, query
from icage.cells.regions import caging_regions
from icage.region_points import Area
from icage.sampling import SamplingError, StartSet, draw_starts, has_rest, safe_level
from tests.experiments.small import cage_of

SETS: list[tuple[str, StartSet]] = [
    ("T", "guaranteed"),
    ("disc_hammer", "guaranteed"),
    ("never_escapes_b", "guaranteed"),
    ("Z_twofold_multi", "guaranteed"),
    ("Z_twofold_multi", "rest"),
    ("cross_multi", "rest"),
]


def level_of(cage: Cage, which: StartSet) -> float:
    return safe_level(cage.sigma_first if which == "guaranteed" else cage.sigma_max, cage.sigma_0)


@pytest.mark.parametrize(("name", "which"), SETS)
def test_starts_lie_in_their_set_clear_of_the_object(name: str, which: StartSet):
    cage = cage_of(name)
    drawn = draw_starts(cage, which, 200, np.random.default_rng(3))
    rows = drawn.placements
    assert rows.shape == (200, 4)
    assert (rows[:, 3] < level_of(cage, which)).all()
    answers = query(cage, rows)
    if which == "guaranteed":
        assert (answers.verdict == TARGET).all()
    else:
        assert answers.in_cage.all()
        assert (answers.verdict != TARGET).all()
    fingers = shapely.points(cage.hand.fingers(rows))
    assert (
        shapely.distance(cage.outline.polygon, fingers) >= cage.finger_radius * (1 - 1e-12)
    ).all()
    assert not shapely.contains_properly(cage.outline.polygon, fingers).any()
    assert 200 / drawn.tried == drawn.acceptance_rate > 1e-3


def test_starts_follow_from_the_seed():
    cage = cage_of("Z_twofold_multi")
    one, same, other = (
        draw_starts(cage, "rest", 60, np.random.default_rng(seed)) for seed in (5, 5, 6)
    )
    assert np.array_equal(one.placements, same.placements)
    assert one.tried == same.tried
    assert not np.isin(one.placements, other.placements).any()


@pytest.mark.parametrize(
    ("name", "which", "count"),
    [("T", "guaranteed", 1), ("Z_twofold_multi", "rest", 40), ("T", "guaranteed", 3000)],
)
def test_starts_of_each_are_those_of_one(name: str, which: StartSet, count: int):
    """Whoever is beside it; 3,000 take more hands than are drawn at once."""
    cage, seeds = cage_of(name), (7, 8, 9)
    together = starts.draw_starts_of_each(
        cage, which, count, [np.random.default_rng(seed) for seed in seeds]
    )
    for seed, drawn in zip(seeds, together, strict=True):
        alone = draw_starts(cage, which, count, np.random.default_rng(seed))
        assert drawn.placements.tobytes() == alone.placements.tobytes()
        assert drawn.tried == alone.tried


def test_a_set_that_is_too_small_is_given_up_once_for_all(monkeypatch: pytest.MonkeyPatch):
    """Of many generators the first is drawn to its end, and the others have had a chunk each."""
    monkeypatch.setattr(starts, "TRIES_PER_START", 100)
    monkeypatch.setattr(starts, "_CHUNK", 10)
    looked: list[int] = []
    inside = starts.Box.of_the_set

    def nothing(box: starts.Box, cage: Cage, which: StartSet, hands: starts._Hands):
        looked.append(len(hands.kept))
        rows, places = inside(box, cage, which, hands)
        return rows[:0], places[:0]

    monkeypatch.setattr(starts.Box, "of_the_set", nothing)
    rngs = [np.random.default_rng(seed) for seed in range(8)]
    with pytest.raises(SamplingError, match="0 of 5 placements found in 500 tries"):
        starts.draw_starts_of_each(cage_of("T"), "guaranteed", 5, rngs)
    assert sum(looked) == 8 * 10 + 490


def fans(sizes: FloatArray) -> shapely.MultiPolygon:
    """Triangles in a row, of these areas."""
    return shapely.MultiPolygon(
        [
            shapely.Polygon([(2 * k, 0), (2 * k + 1, 0), (2 * k, 2 * size)])
            for k, size in enumerate(sizes.tolist())
        ]
    )


@pytest.mark.parametrize(
    "sizes",
    [
        np.ones(7),
        np.array([1.0]),
        np.geomspace(1e-9, 1.0, 60),  # many that the guide takes for one
        np.geomspace(1.0, 1e-9, 60),
        np.where(np.arange(50) == 25, 1.0, 1e-14),
    ],
    ids=["equal", "one", "growing", "shrinking", "specks"],
)
def test_triangles_are_those_of_a_bisection(sizes: FloatArray):
    area = Area.of(fans(sizes))
    shares = area.cumulative / area.cumulative[-1]
    near = [np.nextafter(shares, 0.0), shares, np.nextafter(shares, 1.0)]
    rng = np.random.default_rng(4)
    asked = np.concatenate([[0.0, np.nextafter(1.0, 0.0)], *near, rng.random(5000)])
    asked = asked[asked < 1.0]
    found = area._triangles(asked)
    true = np.searchsorted(area.cumulative, asked * area.cumulative[-1], "right")
    np.testing.assert_array_equal(found, np.minimum(true, len(sizes) - 1))


def plain_rejection(cage: Cage, which: StartSet, count: int, seed: int) -> FloatArray:
    """Placements drawn from a box in x, y, theta, sigma that is known to hold the set, no more."""
    rng = np.random.default_rng(seed)
    size = cage.outline.diameter
    first = next(r for r in caging_regions(cage) if r.finger == 1 and r.bound == "outer")
    x_0, y_0, x_1, y_1 = first.geometry.buffer(0.01 * size).bounds
    low = np.array([x_0, y_0, -np.pi, 0.95 * min(grasp.sigma for grasp in cage.grasps)])
    high = np.array([x_1, y_1, np.pi, level_of(cage, which)])
    found: list[FloatArray] = []
    for _ in range(100):
        rows = rng.uniform(low, high, (200_000, 4))
        answers = query(cage, rows)
        target = answers.verdict == TARGET
        found.append(rows[target if which == "guaranteed" else answers.in_cage & ~target])
        if sum(map(len, found)) >= count:
            return np.concatenate(found)[:count]
    raise AssertionError("plain rejection found too few")


def marginals(cage: Cage, rows: FloatArray) -> list[FloatArray]:
    """x, y, turn from the target, sigma, and finger 3, which mixes them."""
    turn = np.angle(np.exp(1j * (rows[:, 2] - cage.target_placement.theta)))
    third = cage.hand.fingers(rows)[:, 2]
    return [rows[:, 0], rows[:, 1], turn, rows[:, 3], third[:, 0], third[:, 1]]


@pytest.mark.parametrize(
    ("name", "which"),
    [("T", "guaranteed"), pytest.param("Z_twofold_multi", "rest", marks=pytest.mark.slow)],
)
def test_starts_are_uniform_like_plain_rejection(name: str, which: StartSet):
    cage, count = cage_of(name), 20_000
    plain = marginals(cage, plain_rejection(cage, which, count, seed=11))
    drawn = draw_starts(cage, which, count, np.random.default_rng(12)).placements
    for ours, theirs in zip(marginals(cage, drawn), plain, strict=True):
        assert ks_2samp(ours, theirs).pvalue > 1e-3
    # The same test sees a planted bias: forgetting that d^2 w = sigma dsigma dtheta.
    rng = np.random.default_rng(13)
    share = drawn[:, 3] / drawn[:, 3].sum()
    biased = marginals(cage, drawn[rng.choice(count, count, p=share)])
    assert min(ks_2samp(a, b).pvalue for a, b in zip(biased, plain, strict=True)) < 1e-4


def test_a_wrong_least_sigma_does_not_go_unseen(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(starts, "_LEAST_SIGMA", 1.5)
    with pytest.raises(starts.GeometryError, match="below its least sigma"):
        draw_starts(cage_of("T"), "guaranteed", 10_000, np.random.default_rng(0))


def test_drawing_gives_up_and_says_how_far_it_came(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(starts, "TRIES_PER_START", 1)
    with pytest.raises(SamplingError, match=r"\d+ of 40000 placements found in \d+ tries"):
        draw_starts(cage_of("T"), "guaranteed", 40_000, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("name", "rest"),
    [
        ("T", False),
        ("rectangle_notcage", False),
        ("L_best", False),
        ("Z_twofold_multi", True),
        ("hammer_best", True),
        ("never_escapes_a", False),
        ("never_escapes_b", True),
    ],
)
def test_which_cages_have_a_rest(name: str, rest: bool):
    cage = cage_of(name)
    assert has_rest(cage) == rest
    if not rest:
        with pytest.raises(SamplingError, match="no rest set"):
            draw_starts(cage, "rest", 5, np.random.default_rng(0))


def test_progress_adds_up():
    seen: list[int] = []
    draw_starts(cage_of("T"), "guaranteed", 3000, np.random.default_rng(0), seen.append)
    assert sum(seen) == 3000
