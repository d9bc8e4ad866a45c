"""Corners found among vertices, slots of pieces, trees of boxes, and caps that stand clear."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.geometry.kernels.boxes import DEEP, close_tree, empty_tree, next_in_box, put_in
from icage.geometry.kernels.pieces import BOX, WALL, numbered, slots_of
from icage.geometry.kernels.round_chains import (
    _clear,
    _clear_of_segment,
    _clear_of_triangle,
    _groups,
    round_stretches,
    under_apexes,
)
from icage.geometry.round_chains import turns
from icage.kernels.widest import largest_square
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def closed(points: Floats, triangles: np.ndarray) -> Floats:
    """Triangles as the library gives them: rings of four points."""
    return points[triangles[:, [0, 1, 2, 0]]].reshape(-1, 2)


def test_corners_are_found_among_vertices_and_turned_counterclockwise() -> None:
    rng = np.random.default_rng(3)
    points = rng.integers(-4, 5, (60, 2)) * 0.1
    points[5] = -0.0
    _, first = np.unique(points + 0.0, axis=0, return_index=True)
    distinct = points[np.sort(first)]
    x, y = distinct.T.copy()
    triangles = np.array([rng.choice(len(distinct), 3, replace=False) for _ in range(100)])
    found = numbered(x, y, closed(distinct + 0.0, triangles))
    assert found.known
    unsure = set(found.unsure.tolist())
    assert 0 < len(unsure) < 60
    for t, (given, origin) in enumerate(zip(triangles, found.origin.reshape(-1, 3), strict=True)):
        assert set(given) == set(origin)
        a, b, c = distinct[origin]
        area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
        if t in unsure:
            assert abs(area) < 1e-12
            assert given.tolist() == origin.tolist()
        else:
            assert area > 0.0
    # of two vertices at one place the first; a point that is none is told
    twice = np.concatenate([distinct, distinct[:7]])
    again = numbered(*twice.T.copy(), closed(distinct, triangles))
    assert again.origin.tolist() == found.origin.tolist()
    moved = closed(distinct, triangles)
    moved[5, 1] = np.nextafter(moved[5, 1], 1.0)
    assert not numbered(x, y, moved).known


def test_slots_are_the_edges_of_pieces() -> None:
    """A box with corners 0 to 3 round a wall from 4 to 5: two pieces beside each other."""
    x = np.array([0.0, 4.0, 4.0, 0.0, 0.0, 4.0])
    y = np.array([0.0, 0.0, 3.0, 3.0, 1.0, 1.0])
    origin = np.array([0, 1, 5, 0, 5, 4, 2, 3, 4])
    #        half edges 0 -> 1, 1 -> 5, 5 -> 0, 0 -> 5, 5 -> 4, 4 -> 0, 2 -> 3, 3 -> 4, 4 -> 2
    twin = np.array([-1, -1, 3, 2, -1, -1, -1, -1, -1])
    edges, ptr = np.array([0, 1, 2, 3, 4, 5, 6, 7, 8]), np.array([0, 3, 6, 9])
    slots = slots_of(x, y, origin, twin, edges, ptr)
    assert slots.vertex.tolist() == origin.tolist()
    expected = [BOX, WALL, 1, 0, WALL, WALL, BOX, WALL, WALL]
    assert slots.neighbour.tolist() == expected
    walls = list(zip(slots.wall_from.tolist(), slots.wall_to.tolist(), strict=True))
    assert walls == [(1, 5), (5, 4), (4, 0), (3, 4), (4, 2)]
    normal = slots.normal_x + 1j * slots.normal_y
    assert normal[:2].tolist() == [1j, -1.0]
    assert normal[2] == pytest.approx((1 - 4j) / np.sqrt(17.0))  # left of the way from 5 to 0
    joined = slots_of(x, y, origin, twin, np.array([0, 1, 4, 5, 6, 7, 8]), np.array([0, 4, 7]))
    assert joined.vertex.tolist() == [0, 1, 5, 4, 2, 3, 4]
    assert joined.neighbour.tolist() == [BOX, WALL, WALL, WALL, BOX, WALL, WALL]


@pytest.mark.parametrize("count", [1, 2, 3, 7, 16, 33])
def test_a_tree_finds_every_box_that_meets_one(count: int) -> None:
    rng = np.random.default_rng(count)
    low = rng.integers(0, 9, (count, 2)).astype(float)
    high = low + rng.integers(0, 4, (count, 2))
    tree = empty_tree(count)
    for k in range(count):
        put_in(tree, k, *low[k])
        put_in(tree, k, *high[k])
    close_tree(tree)
    stack = np.empty(DEEP, np.int64)
    for _ in range(40):
        a = rng.integers(-1, 11, 2).astype(float)
        b = a + rng.integers(0, 5, 2)
        stack[0] = 1
        found = []
        thing, waiting = next_in_box(tree, stack, 1, np.concatenate([a, b]))
        while thing >= 0:
            found.append(thing)
            thing, waiting = next_in_box(tree, stack, waiting, np.concatenate([a, b]))
        meet = (low <= b).all(axis=1) & (high >= a).all(axis=1)  # a common edge or corner too
        assert sorted(found) == np.flatnonzero(meet).tolist()


def test_triangles_clear_of_segments_and_of_each_other() -> None:
    """On a grid of whole numbers signs are certain, but for lines that are none."""
    rng = np.random.default_rng(5)
    seen = {True: 0, False: 0}
    for _ in range(600):
        points = rng.integers(0, 7, (6, 2)).astype(float)
        one, other = shapely.Polygon(points[:3]), shapely.Polygon(points[3:])
        if not (one.exterior.is_ccw and other.exterior.is_ccw and one.area and other.area):
            continue
        x, y = points.T.copy()
        edge = shapely.LineString(points[3:5])
        clear = bool(_clear_of_segment(x, y, np.arange(3), 3, 4))
        assert clear == one.disjoint(edge)
        apart = bool(_clear_of_triangle(x, y, np.arange(3), np.arange(3, 6)))
        assert apart == one.disjoint(other)
        seen[clear] += 1
        seen[apart] += 1
    assert min(seen.values()) > 50
    # what a float cannot tell is not clear: a corner on a line, but for rounding
    x = np.array([0.1, 0.7, 0.2, 0.3, 0.9])
    assert not _clear_of_segment(x, np.array([0.1, 0.7, 0.9, 0.3, 0.9]), np.arange(3), 3, 4)


def blob(n: int) -> Floats:
    angle = 2.0 * np.pi * np.arange(n) / n
    away = 1.0 + 0.2 * np.cos(3.0 * angle) + 0.1 * np.sin(5.0 * angle)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * away[:, None]


@pytest.mark.parametrize("n", [100, 150, 400])
def test_stretches_turn_left_and_see_their_apex(n: int) -> None:
    ring = blob(n)
    turn = turns(ring)
    firsts, lasts = _groups(turn)
    assert len(firsts) > 2
    for first, last in zip(firsts, lasts, strict=True):
        inside = turn[np.arange(first + 1, last + 1) % n]
        assert (inside > 0.0).all()
        assert np.radians(0.05) <= inside.sum() <= np.radians(25.0) * 1.4
        assert 4 <= last - first <= round(12 * 1.4)
    assert (firsts[1:] >= lasts[:-1]).all()
    found = round_stretches(ring, turn)
    body = shapely.Polygon(ring)
    for first, last, apex in zip(*found, strict=True):
        chain = ring[np.arange(first + 1, last + 1) % n]
        fan = shapely.Polygon([*chain[::-1], apex])
        assert fan.exterior.is_ccw
        assert fan.intersection(body).area < 1e-15
    caps = [
        shapely.Polygon([ring[(a + 1) % n], p, ring[b % n]]) for a, b, p in zip(*found, strict=True)
    ]
    for k, cap in enumerate(caps):
        assert not any(cap.intersects(other) for other in caps[:k])
    coarse, fans = under_apexes(n, found.first, found.last)
    points = np.vstack([ring, found.apex])
    outer = shapely.Polygon(points[coarse])
    assert outer.is_valid
    area = sum(shapely.Polygon(points[f]).area for f in fans)
    assert outer.area == pytest.approx(body.area + area, rel=1e-12)
    assert all(shapely.Polygon(points[f]).exterior.is_ccw for f in fans)


def test_caps_give_way_to_the_ring_and_to_earlier_ones() -> None:
    """Two of three caps face each other over a slot."""
    body = np.array([[0, 0], [6, 0], [6, 5], [4, 5], [4, 1], [2, 1], [2, 5], [0, 5]], float)
    n = len(body)
    first, last = np.array([0, 2, 4]), np.array([2, 4, 6])  # over the edges 1, 3 and 5
    for apexes, expected in (
        ([[7.0, 2.0], [3.0, 3.0], [2.5, 3.0]], [True, True, True]),
        ([[7.0, 2.0], [3.0, 3.0], [3.5, 3.0]], [True, True, False]),  # the later one goes
        ([[7.0, 2.0], [1.5, 3.0], [3.5, 3.0]], [True, False, True]),  # one that has gone is no bar
        ([[7.0, 2.0], [2.0, 3.0], [2.5, 3.0]], [True, False, True]),  # touches the ring
    ):
        x, y = np.vstack([body, apexes]).T.copy()
        caps = [
            shapely.Polygon([body[(a + 1) % n], p, body[b % n]])
            for a, b, p in zip(first, last, apexes, strict=True)
        ]
        ring = shapely.linestrings(np.stack([body, np.roll(body, -1, axis=0)], axis=1))
        clear: list[bool] = []
        for k, cap in enumerate(caps):
            beyond = [(e - first[k]) % n > last[k] - first[k] for e in range(n)]
            free = not any(cap.intersects(ring[e]) for e in range(n) if beyond[e])
            free &= not any(cap.intersects(caps[j]) for j in range(k) if clear[j])
            clear.append(free)
        assert _clear(x, y, n, first, last).tolist() == clear == expected


def test_largest_distance_of_points() -> None:
    rng = np.random.default_rng(6)
    for n in (1, 2, 3, 20, 60):
        for shape in (rng.normal(size=(n, 2)), blob(n), blob(n) * [1.0, 0.0]):
            points = shape + rng.normal(size=2)
            off = points[:, None] - points[None]
            assert largest_square(*points.T.copy()) == (off**2).sum(axis=2).max()
