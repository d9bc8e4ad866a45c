"""Triples of features, hands on them and the points that give a wanted hand: by brute force."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
import shapely
from scipy.optimize import nnls

from icage.cells.kernels.columns import Ending
from icage.grasps.features import EDGE, VERTEX, Features, features_of
from icage.grasps.kernels.climb import taken_over
from icage.grasps.kernels.evaluate import MET, _level, is_in_set
from icage.grasps.kernels.hands import HandLimits, first_finger, touches
from icage.grasps.kernels.shaping import _error, shaped_points
from icage.grasps.kernels.triples import (
    _clip,
    _cut,
    _near_part,
    _spread,
    _squeezing_area,
    contact_at,
    feasible_triples,
    points_of_triple,
    squeezes,
)
from icage.outline import Outline
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES

pytestmark = pytest.mark.usefixtures("plain")

ANY = HandLimits.apart(1e-3)


def features(family: str, seed: int, size: float = 1.0) -> tuple[Features, Outline]:
    ring = size * FAMILIES[family](np.random.default_rng(seed)) + size * np.array([2.0, -1.0])
    return features_of(Outline(ring)), Outline(ring)


def unit(angle: float | Floats) -> Floats:
    return np.array([np.cos(angle), np.sin(angle)]).T


def cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def balance(forces: Floats, points: Floats) -> bool:
    """Whether forces (3, 2) at points balance with shares that are not tiny, and squeeze."""
    share, miss = nnls(np.vstack([forces.T, np.ones(3)]), np.array([0.0, 0.0, 1.0]))
    work = float((share[:, None] * forces * points).sum())
    return miss < 1e-9 and share.min() > 1e-4 and work < -1e-6


def test_the_finger_of_an_edge_is_the_foot_and_of_a_vertex_the_vertex() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        point, p, normal = rng.normal(size=2), 3.0 * rng.normal(size=2), unit(rng.uniform(0, 6))
        edge = np.array(contact_at(EDGE, point, normal, *p))
        assert (edge[:2] - point) @ normal == pytest.approx(0.0, abs=1e-12)
        assert edge[:2] - p == pytest.approx(((edge[:2] - p) @ normal) * normal, abs=1e-12)
        assert edge[2:].tolist() == normal.tolist()
        corner = np.array(contact_at(VERTEX, point, normal, *p))
        assert corner[:2].tolist() == point.tolist()
        assert np.hypot(*corner[2:]) == pytest.approx(1.0)
        assert cross(corner[2:], p - point) == pytest.approx(0.0, abs=1e-12)
        assert corner[2:] @ normal > 0.0


def test_forces_squeeze_as_by_least_squares() -> None:
    rng = np.random.default_rng(2)
    told = [0, 0]
    for _ in range(400):
        p, angle = rng.normal(size=2), rng.uniform(0.0, 2.0 * np.pi, 3)
        forces = unit(angle)
        points = p - rng.normal(size=3)[:, None] * forces + 5.0  # their lines meet in p
        known = balance(forces, points)
        found = squeezes(*points.T.copy(), *forces.T.copy())
        shares = np.abs([cross(forces[k - 2], forces[k - 1]) for k in range(3)])
        if shares.min() < 1e-2:
            continue
        assert found == known
        told[int(known)] += 1
    assert min(told) > 20
    flat = unit(np.array([0.0, np.pi, 0.5 * np.pi + 1e-8]))
    assert not squeezes(np.array([-1.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0]), *flat.T.copy())


def area_of(x: Floats, y: Floats, n: int) -> shapely.Polygon:
    return shapely.Polygon(np.column_stack([x[:n], y[:n]])) if n >= 3 else shapely.Polygon()


@pytest.mark.parametrize("seed", range(8))
def test_clipped_polygons_are_shapelys(seed: int) -> None:
    rng = np.random.default_rng([seed, 5])
    n = int(rng.integers(3, 7))
    angle = np.sort(2.0 * np.pi * (np.arange(n) + 0.7 * rng.random(n)) / n)
    ring = 2.0 * unit(angle) + 3.0
    x, y = np.full(16, np.nan), np.full(16, np.nan)
    x[:n], y[:n] = ring.T
    whole = shapely.Polygon(ring)

    def half_plane(a: float, b: float, c: float) -> shapely.Polygon:
        at, way = c * np.array([a, b]) / (a * a + b * b), 50.0 * np.array([-b, a])
        return shapely.Polygon([at - way, at + way, at + way + 50.0 * np.array([a, b]),
                                at - way + 50.0 * np.array([a, b])])  # fmt: skip

    planes = np.empty((1, 2, 3))
    planes[0, :, :2] = unit(rng.uniform(0.0, 6.0, 2))
    planes[0, :, 2] = planes[0, :, :2] @ [3.0, 3.0] + rng.uniform(-1.0, 1.0, 2)
    ox, oy = np.full(16, np.nan), np.full(16, np.nan)
    m = _clip(x, y, n, *planes[0, 0], ox, oy)
    known = whole & half_plane(*planes[0, 0])
    assert area_of(ox, oy, m).symmetric_difference(known).area < 1e-9
    near = float(rng.uniform(0.3, 1.2))
    middle = ring[0] * 0.6 + 0.4 * 3.0
    nx, ny = x.copy(), y.copy()
    m = _near_part(nx, ny, n, middle, near, ox, oy)
    known = whole & shapely.box(*(middle - near), *(middle + near))
    assert area_of(nx, ny, m).symmetric_difference(known).area < 1e-9
    m = _cut(planes, 0, x, y, n, ox, oy)
    known = whole & half_plane(*planes[0, 0]) & half_plane(*planes[0, 1])
    assert area_of(x, y, m).symmetric_difference(known).area < 1e-9
    assert (m == 0) == (known.area < 1e-12)


def test_points_are_spread_evenly_over_a_polygon() -> None:
    triangle = np.array([[0.0, 0.0], [6.0, 0.0], [3.0, 12.0]])
    middle, known = np.array([3.0, 4.0]), []
    for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        ends = [a - middle, b - middle]  # three rows of small triangles: the middles of the upright
        shares = [(i + 1 / 3, j + 1 / 3) for i in range(3) for j in range(3 - i)]
        known += [middle + (s * ends[0] + t * ends[1]) / 3.0 for s, t in shares]
    assert _spread(*triangle.T.copy(), 3, 1e3) == pytest.approx(np.array(known))
    x, y = np.array([1.0, 5.0, 5.0, 1.0]), np.array([2.0, 2.0, 4.0, 4.0])
    for step, least in ((0.5, 40), (100.0, 24)):
        found = _spread(x, y, 4, step)
        assert len(found) >= least
        assert len({tuple(np.round(p, 9)) for p in found}) == len(found)
        assert ((found > [1.0, 2.0]) & (found < [5.0, 4.0])).all()
        assert found.mean(axis=0) == pytest.approx([3.0, 3.0])
        grid = np.array(
            [(a, b) for a in np.linspace(1.2, 4.8, 7) for b in np.linspace(2.2, 3.8, 5)]
        )
        gap = np.hypot(*(grid[:, None] - found[None]).transpose(2, 0, 1)).min(axis=1)
        assert gap.max() < max(step, 1.0)
    # in every corner triangle as many rows as steps fit, 16 at most, 3 at least
    assert len(_spread(x, y, 4, math.hypot(2.0, 1.0) / 4.5)) == 4 * 15
    assert len(_spread(x, y, 4, 1e-3)) == 4 * 16 * 17 // 2
    assert len(_spread(x, y, 4, 1e3)) == 4 * 6


@pytest.mark.parametrize(("family", "seed", "size"), [
    ("star", 3, 1.0), ("lattice", 2, 40.0), ("random", 5, 0.1), ("rectilinear", 1, 1.0),
])  # fmt: skip
def test_all_triples_that_squeeze_somewhere_and_no_others(
    family: str, seed: int, size: float
) -> None:
    """Against points tried one by one: of what these find nothing is missing."""
    told, outline = features(family, seed, size)
    d, middle = outline.diameter, np.asarray(outline.centroid)
    limits = HandLimits.apart(0.01 * d)
    args = (told.kind, told.point, told.normal, told.planes, middle, 3.0 * d, 1.6 * d, 0.2 * d)
    shares = [feasible_triples(*args, limits, part, 3) for part in range(3)]
    whole = feasible_triples(*args, limits, 0, 1)
    assert sorted(whole.triples.tolist()) == sorted(
        t for share in shares for t in share.triples.tolist()
    )
    for part, share in enumerate(shares):
        assert {min(t) % 3 for t in share.triples.tolist()} <= {part}
    names = {tuple(sorted(t)) for t in whole.triples.tolist()}
    assert len(names) == len(whole.triples) > 0
    for triple, p in zip(whole.triples, whole.points, strict=True):
        assert all(is_in_set(told.planes, f, *p) for f in triple)
        rows = np.array([contact_at(told.kind[f], told.point[f], told.normal[f], *p)
                         for f in triple])  # fmt: skip
        assert squeezes(*rows.T.copy())
        x, y = rows[:, 0], rows[:, 1]
        assert (x[1] - x[0]) * (y[2] - y[0]) > (x[2] - x[0]) * (y[1] - y[0])
        assert first_finger(x.copy(), y.copy(), limits) >= 0
    rng = np.random.default_rng(9)
    met: dict[tuple[int, ...], int] = {}
    for p in middle + d * rng.uniform(-1.5, 1.5, (60, 2)):
        inside = [f for f in range(len(told.kind)) if is_in_set(told.planes, f, *p)]
        for three in combinations(inside, 3):
            rows = np.array([contact_at(told.kind[f], told.point[f], told.normal[f], *p)
                             for f in three])  # fmt: skip
            area = cross(rows[1, :2] - rows[0, :2], rows[2, :2] - rows[0, :2])
            order = [0, 1, 2] if area > 0.0 else [0, 2, 1]
            hand = rows[order, :2].T.copy()
            holds = squeezes(*rows.T.copy()) and first_finger(*hand, limits) >= 0
            x, y, fx, fy = (np.empty(3) for _ in range(4))
            found = _squeezing_area(
                told.kind, told.point, told.normal, told.planes, *three, *p, limits, x, y, fx, fy
            )
            assert (found != 0.0) == holds
            if holds:
                assert found == pytest.approx(area)
                assert np.column_stack([x, y, fx, fy]).tolist() == rows[order].tolist()
                met[three] = met.get(three, 0) + 1
    assert len(met) > 3
    assert {three for three, times in met.items() if times >= 3} <= names
    outside = middle + np.array([2.9, 0.0]) * d
    for three in list(names)[:20]:
        if not all(is_in_set(told.planes, f, *outside) for f in three):
            room = [np.empty(3) for _ in range(4)]
            assert _squeezing_area(
                told.kind, told.point, told.normal, told.planes, *three, *outside, limits, *room
            ) == 0.0  # fmt: skip
    for three in list(met)[:4]:
        points, turns = points_of_triple(
            *args[:4], middle, 3.0 * d, 1.6 * d, 0.2 * d, limits, np.array(three)
        )
        assert len(points) == len(turns) > 0
        assert len(np.unique(np.round(points / d, 9), axis=0)) >= 0.5 * len(points)
        for p, turn in zip(points, turns, strict=True):
            x, y, fx, fy = (np.empty(3) for _ in range(4))
            area = _squeezing_area(
                told.kind, told.point, told.normal, told.planes, *three, *p, limits, x, y, fx, fy
            )
            assert area * turn > 0.0


@pytest.mark.parametrize(("family", "seed"), [("star", 3), ("rectilinear", 1)])
def test_points_are_looked_for_in_a_square_round_the_middle(family: str, seed: int) -> None:
    """Whose corners lie as far from the origin in x as they do not in y."""
    told, outline = features(family, seed)
    d = outline.diameter
    middle = np.asarray(outline.centroid) + 0.1 * d * np.array([1.0, -0.5])
    reach = 0.35 * d
    limits = HandLimits.apart(0.01 * d)
    args = (told.kind, told.point, told.normal, told.planes, middle, reach, reach, 0.05 * d)
    found = feasible_triples(*args, limits, 0, 1)
    assert len(found.points) > 0
    assert np.abs(found.points - middle).max() <= reach
    names = {tuple(sorted(t)) for t in found.triples.tolist()}
    corners = [np.array([a, b]) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    met: dict[tuple[int, ...], int] = {}
    for p in [middle + 0.99 * reach * c for c in corners] + list(
        middle + reach * np.random.default_rng(4).uniform(-1.0, 1.0, (40, 2))
    ):
        inside = [f for f in range(len(told.kind)) if is_in_set(told.planes, f, *p)]
        for three in combinations(inside, 3):
            room = [np.empty(3) for _ in range(4)]
            if _squeezing_area(
                told.kind, told.point, told.normal, told.planes, *three, *p, limits, *room
            ):
                met[three] = met.get(three, 0) + 1
    assert {three for three, times in met.items() if times >= 2} <= names
    for three in list(met)[:6]:
        points = points_of_triple(*args[:4], middle, reach, reach, 0.05 * d, limits,
                                  np.array(three)).points  # fmt: skip
        assert np.abs(points - middle).max() <= reach


@pytest.mark.parametrize(("family", "seed"), [("tool", 1), ("lattice", 3)])
def test_a_triple_with_a_point_near_the_middle_is_proposed(family: str, seed: int) -> None:
    """Also where the middle of its set squeezes nothing: of some the points have to be tried."""
    told, outline = features(family, seed)
    d, middle = outline.diameter, np.asarray(outline.centroid)
    limits = HandLimits.apart(0.01 * d)
    args = (told.kind, told.point, told.normal, told.planes, middle, 3.0 * d, 1.6 * d, 0.2 * d)
    names = {tuple(sorted(t)) for t in feasible_triples(*args, limits, 0, 1).triples.tolist()}
    for three in combinations(range(len(told.kind)), 3):
        points = points_of_triple(*args, limits, np.array(three)).points
        if len(points) and np.abs(points - middle).max(axis=1).min() < 1.6 * d:
            assert three in names
        if three not in names:
            assert (np.abs(points - middle).max(axis=1) > 1.6 * d - 1e-9).all()


def test_no_point_of_a_triple_whose_sets_do_not_meet() -> None:
    kind = np.zeros(3, np.int64)
    planes = np.array([[[1.0, 0, 5.0], [1.0, 0, 5.0]]] * 2 + [[[-1.0, 0, 0], [-1.0, 0, 0]]])
    found = points_of_triple(
        kind, np.zeros((3, 2)), unit(np.zeros(3)), planes, np.zeros(2), 9.0, 3.0, 0.5, ANY,
        np.arange(3),
    )  # fmt: skip
    assert found.points.shape == (0, 2)
    assert found.turns.shape == (0,)


def hand(phi_1: float, phi_2: float, size: float = 1.0) -> tuple[Floats, Floats]:
    """Counterclockwise contacts whose third finger is seen so from the first and the second."""
    t = math.sin(phi_2) / math.sin(phi_2 - phi_1)
    at = size * t * unit(phi_1)
    return np.array([0.0, size, at[0]]) + 7.0, np.array([0.0, 0.0, at[1]]) - 3.0


def test_which_finger_is_the_first_and_which_hands_may_be() -> None:
    x, y = hand(0.5, 2.6)  # the longest side is that between fingers 1 and 2: 1
    assert first_finger(x, y, ANY) == 0
    for shift in (1, 2):
        assert first_finger(np.roll(x, shift), np.roll(y, shift), ANY) == shift
    side = np.hypot(np.roll(x, -1) - x, np.roll(y, -1) - y)
    least, widest = float(side.min()), float(side.max() / side.min())
    assert first_finger(x, y, ANY._replace(least_distance=least * 0.999)) == 0
    assert first_finger(x, y, ANY._replace(least_distance=least * 1.001)) == -1
    assert first_finger(x, y, ANY._replace(widest=widest * 1.001)) == 0
    assert first_finger(x, y, ANY._replace(widest=widest * 0.999)) == -1
    angles = [0.5, math.pi - 2.6, 2.6 - 0.5]
    assert first_finger(x, y, ANY._replace(least_angle=min(angles) * 0.999)) == 0
    assert first_finger(x, y, ANY._replace(least_angle=min(angles) * 1.001)) == -1
    assert first_finger(x, y, ANY._replace(sigma_least=1.0 - 1e-9, sigma_most=1.0 + 1e-9)) == 0
    assert first_finger(x, y, ANY._replace(sigma_least=1.001)) == -1
    assert first_finger(x, y, ANY._replace(sigma_most=0.999)) == -1
    flat = hand(0.05, math.pi - 0.05)  # its height is 0.025 of its longest side
    assert first_finger(*flat, ANY) == -1
    assert first_finger(x[::-1].copy(), y[::-1].copy(), ANY) == -1  # clockwise
    round_about = unit(2.0 * np.pi / 3.0 * np.arange(3))
    assert first_finger(*round_about.T.copy(), ANY) == 0


def test_limits_that_ask_for_a_distance_only() -> None:
    asked = HandLimits.apart(0.1, 7.0)
    assert asked == (0.1, 0.0, 7.0, 0.0, math.inf, 0.0, 0.0, math.inf)
    assert HandLimits.apart(0.1).widest == math.inf


def test_a_wanted_shape_is_read_from_the_finger_that_fits_best() -> None:
    x, y = hand(0.5, 2.6)
    like = ANY._replace(phi_1=0.52, phi_2=2.59, within=0.021)
    for shift in range(3):
        assert first_finger(np.roll(x, shift), np.roll(y, shift), like) == shift
        assert first_finger(np.roll(x, shift), np.roll(y, shift), like._replace(within=0.019)) == -1
    other = ANY._replace(phi_1=0.5, phi_2=2.62, within=0.021)
    assert first_finger(x, y, other) == 0
    assert first_finger(x, y, other._replace(within=0.019)) == -1
    # sigma is then the side of the finger that is first, not the longest
    turned = ANY._replace(phi_1=math.pi - 2.6, phi_2=math.pi - 2.1, within=0.1)
    assert first_finger(x, y, turned) == 1
    second = math.hypot(x[2] - x[1], y[2] - y[1])
    assert first_finger(x, y, turned._replace(sigma_least=second * 1.001)) == -1
    assert first_finger(x, y, turned._replace(sigma_most=second * 1.001)) == 1


def test_a_finger_touches_a_segment_within_reach() -> None:
    rng = np.random.default_rng(4)
    segments = rng.normal(size=(3, 4))
    segments[2, 2:] = segments[2, :2]  # one that is a point
    lines = [shapely.LineString(s.reshape(2, 2)) for s in segments[:2]]
    for p in rng.normal(size=(80, 2)):
        gap = min(*(shapely.Point(p).distance(s) for s in lines), math.dist(p, segments[2, :2]))
        assert touches(*p, segments, gap * 1.0001)
        assert not touches(*p, segments, gap * 0.9999)
    assert not touches(0.0, 0.0, np.empty((0, 4)), 10.0)


@pytest.mark.parametrize(("family", "seed", "size"), [("star", 3, 1.0), ("random", 5, 30.0)])
def test_points_move_to_where_the_hand_is_the_wanted_one(
    family: str, seed: int, size: float
) -> None:
    """The hand of a point beside is wanted: it is found, to 1e-9, by nearly all."""
    told, outline = features(family, seed, size)
    d = outline.diameter
    args = (told.kind, told.point, told.normal, told.planes, np.asarray(outline.centroid))
    found = feasible_triples(*args, 3.0 * d, 1.6 * d, 0.2 * d, HandLimits.apart(0.05 * d), 0, 1)
    reached = moved = 0
    for triple, p in list(zip(found.triples, found.points, strict=True))[:30]:
        there = p + 0.03 * d * unit(1.0 + len(triple))
        contacts = told.contacts(triple, there)
        if np.abs(contacts - told.contacts(triple, p)).max() < 1e-6 * d:
            continue
        shape = contacts @ [1.0, 1j]
        for k in range(3):
            a, b, c = np.roll(shape, -k)
            phi_1 = float(np.angle((c - a) / (b - a)) % (2.0 * np.pi))
            phi_2 = float(np.angle((c - b) / (b - a)) % (2.0 * np.pi))
            out = np.empty(2)
            assert _error(told, triple, *there, phi_1, phi_2, out) < 1e-12
            off = _error(told, triple, *there, phi_1 - 0.02, phi_2 + 0.01, out)
            assert off <= 0.02 + 1e-12
            if off > 0.02 - 1e-12:
                assert out.tolist() == pytest.approx([0.02, -0.01])
        start = p[None].copy()
        points, off = shaped_points(told, triple[None], start, phi_1, phi_2, d)
        assert off[0] == pytest.approx(
            _error(told, triple, *points[0], phi_1, phi_2, out), abs=1e-12
        )
        assert start.tolist() == [p.tolist()]
        moved += 1
        reached += off[0] < 1e-8
    assert moved >= 5
    assert reached >= 0.8 * moved


def test_a_step_to_a_wanted_hand_is_no_longer_than_a_tenth() -> None:
    told, outline = features("star", 3)
    d = outline.diameter
    args = (told.kind, told.point, told.normal, told.planes, np.asarray(outline.centroid))
    found = feasible_triples(*args, 3.0 * d, 1.6 * d, 0.2 * d, ANY, 0, 1)
    for triple, p in list(zip(found.triples, found.points, strict=True))[:10]:
        points, _ = shaped_points(told, triple[None], p[None].copy(), 0.4, 2.0, d)
        assert np.hypot(*(points[0] - p)) <= 12 * 0.1 * d * (1.0 + 1e-9)


def test_a_point_that_leaves_a_set_is_taken_over_by_the_next_feature() -> None:
    planes = np.array([[[1.0, 0.0, k], [-1.0, 0.0, -k - 1.0]] for k in (0.0, 1.0, 2.0)])
    beside = np.array([[1, 2], [2, 0], [1, 0]])
    assert [is_in_set(planes, f, 1.5, 0.0) for f in range(3)] == [False, True, False]
    assert is_in_set(planes, 1, 1.0, 9.0)
    assert taken_over(planes_only(planes), beside, 1, 1.5, 0.0) == 1
    assert taken_over(planes_only(planes), beside, 0, 1.5, 0.0) == 1
    assert taken_over(planes_only(planes), beside, 0, 2.5, 0.0) == 2
    assert taken_over(planes_only(planes), beside, 0, 9.5, 0.0) == 0


def planes_only(planes: Floats) -> Features:
    none = np.empty(0)
    return Features(none, none, none, none, planes)


class Found:
    """What of a search the level that is ranked depends on."""

    def __init__(self, records: list[tuple[float, float]], level: float, outcome: int) -> None:
        self.records = np.array([(*r, 0.0) for r in records]).reshape(-1, 3)
        self.level, self.outcome = level, outcome


@pytest.mark.parametrize("first", [False, True])
def test_the_level_that_is_ranked(first: bool) -> None:
    """The first deep basin, or the escape; none if a basin is met at once."""
    shallow, deep = (3.0, 3.0 - 1e-12), (4.0, 2.0)
    escaped = int(Ending.ESCAPED)
    assert _level(Found([shallow], 6.0, escaped), 2.0, first, 1.0) == 6.0
    assert _level(Found([shallow, deep], 6.0, escaped), 2.0, first, 1.0) == (4.0 if first else 6.0)
    assert _level(Found([deep], 4.0, escaped), 2.0, first, 1.0) == 4.0  # at the escape: of it
    assert _level(Found([deep], 4.0 * (1.0 + 1e-12), escaped), 2.0, first, 1.0) > 4.0
    assert _level(Found([(2.0 + 1e-12, 1.0)], 6.0, escaped), 2.0, first, 1.0) == 0.0
    assert _level(Found([(2.1, 1.0)], 6.0, escaped), 2.0, first, 1.0) == (2.1 if first else 6.0)
    met = Found([shallow, deep], 4.0, MET)
    assert _level(met, 2.0, first, 1.0) == (4.0 if first else np.inf)
    # what is shallow on a large object is deep on a small one
    assert _level(Found([(3.0, 3.0 - 1e-6)], 6.0, escaped), 2.0, True, 1e5) == 6.0
    assert _level(Found([(3.0, 3.0 - 1e-6)], 6.0, escaped), 2.0, True, 1e-3) == 3.0
