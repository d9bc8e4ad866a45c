"""Convex polygons, what hands share, and which pieces are near: by shapely."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely

from icage.cells.free_space import search
from icage.cells.kernels.convex_polygon import (
    Line,
    area,
    beyond,
    centroid,
    clip,
    hull,
    mean,
    new_corners,
)
from icage.cells.kernels.near import Hand, cells_near, pieces_near
from icage.cells.kernels.plateau import translations
from icage.cells.kernels.shrink import pivot, sees
from icage.kernels.locate import build_buckets, cells_of, depth_inside, locate, nodes_of
from tests.icage.cells.setting import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def convex(rng: np.random.Generator, most: int = 9) -> Floats:
    n = int(rng.integers(3, most))
    angle = np.sort(2.0 * np.pi * (np.arange(n) + 0.8 * rng.random(n)) / n)
    return np.column_stack([2.0 * np.cos(angle) + 5.0, np.sin(angle) - 3.0])


@pytest.mark.parametrize("seed", range(10))
def test_convex_polygons_are_shapelys(seed: int) -> None:
    rng = np.random.default_rng([seed, 1])
    ring = convex(rng)
    n, x, y = len(ring), *ring.T.copy()
    known = shapely.Polygon(ring)
    assert area(x, y, n) == pytest.approx(known.area)
    assert tuple(centroid(x, y, n)) == pytest.approx(known.centroid.coords[0])
    assert mean(x, n - 1) == pytest.approx(x[: n - 1].mean())
    p = rng.normal(size=2) * [3.0, 2.0] + [5.0, -3.0]
    more = known.union(shapely.Point(p)).convex_hull.area - known.area
    assert beyond(*p, x, y, n) == pytest.approx(more, abs=1e-12)
    polygon, room = new_corners(n + 6), new_corners(n + 6)
    polygon.x[:n], polygon.y[:n], polygon.done[:n] = x, y, True
    g, c = rng.normal(size=2), ring.mean(axis=0)
    e = float(rng.normal()) * 0.3
    m = clip(polygon, n, Line(e + 0.01, *g, *c, 1.0), 0.01, room)
    way = 20.0 * np.array([-g[1], g[0]])
    start = c - e * g / (g @ g)
    half = shapely.Polygon([start - way, start - way - 20 * g, start + way - 20 * g, start + way])
    kept = np.column_stack([polygon.x[:m], polygon.y[:m]])
    left = known & half
    if left.is_empty:
        assert m == 0
    else:
        assert shapely.Polygon(kept).symmetric_difference(left).area < 1e-9
        old = {tuple(q) for q in ring}
        assert [tuple(q) in old for q in kept] == polygon.done[:m].tolist()


def test_a_polygon_of_no_area_has_the_mean_of_its_corners_for_a_middle() -> None:
    x, y = np.array([1.0, 2.0, 6.0]), np.array([2.0, 4.0, 12.0])
    assert tuple(centroid(x, y, 3)) == pytest.approx((3.0, 6.0))
    assert area(x, y, 3) == 0.0
    assert area(x, y, 2) == 0.0
    assert tuple(centroid(x, y, 1)) == (1.0, 2.0)


@pytest.mark.parametrize("kind", ["any", "grid", "line", "one"])
def test_a_hull_is_shapelys(kind: str) -> None:
    rng = np.random.default_rng(len(kind))
    for _ in range(15):
        n = int(rng.integers(3, 14))
        points = rng.normal(size=(n, 2)) if kind == "any" else rng.integers(0, 4, (n, 2)) * 1.0
        if kind == "line":
            points[:, 1] = 2.0 * points[:, 0] + 1.0
        if kind == "one":
            points[:] = points[0]
        ox, oy = np.full(2 * n + 2, np.nan), np.full(2 * n + 2, np.nan)
        m = hull(points[:, 0].copy(), points[:, 1].copy(), n, ox, oy)
        found = np.column_stack([ox[:m], oy[:m]])
        known = shapely.MultiPoint(points).convex_hull
        assert {tuple(p) for p in found} == set(known.coords if known.geom_type != "Polygon"
                                                else known.exterior.coords)  # fmt: skip
        if known.geom_type == "Polygon":
            assert len(found) == len(known.exterior.coords) - 1
            assert area(*found.T.copy(), m) == pytest.approx(known.area)


@pytest.mark.parametrize("seed", range(6))
def test_pieces_near_a_point_and_cells_near_a_hand(seed: int) -> None:
    s = Setting(seed)
    for _ in range(15):
        p = s.ring[s.rng.integers(len(s.ring))] + 0.1 * s.rng.normal(size=2)
        reach = 10.0 ** s.rng.uniform(-4, -0.5)
        apart = [shape.distance(shapely.Point(p)) for shape in s.shapes]
        known = [k for k, gap in enumerate(apart) if gap <= reach]
        assert pieces_near(s.pieces, *p, reach).tolist() == known
    hand = s.hand
    for reach in (1e-9 * s.size, 0.05 * s.size):
        near = [[k for k, shape in enumerate(s.shapes)
                 if shape.distance(shapely.Point(f.real, f.imag)) <= reach]
                for f in s.fingers]  # fmt: skip
        known = [[a, b, c] for a in near[0] for b in near[1] for c in near[2]]
        cells, total = cells_near(s.pieces, s.z, hand, reach, 10**6)
        assert total == len(known)
        assert cells.tolist() == known
        none, total = cells_near(s.pieces, s.z, hand, reach, len(known) - 1)
        assert (len(none), total) == (0, len(known))
        assert len(cells_near(s.pieces, s.z, hand, reach, len(known))[0]) == len(known)


@pytest.mark.parametrize("seed", range(4))
def test_a_finger_just_inside_the_object_is_near_the_pieces_outside(seed: int) -> None:
    s = Setting(seed)
    inside = s.ring.mean(axis=0)  # towards it from an edge's middle
    edge = 0.5 * (s.ring[0] + s.ring[1])
    out = np.array([s.ring[1][1] - s.ring[0][1], s.ring[0][0] - s.ring[1][0]])
    at = edge - 30e-6 * out / np.hypot(*out)
    del inside
    hand = Hand(*at, 0.0, 0.0)
    cells, _ = cells_near(s.pieces, s.z, hand, 1e-6, 10**6)
    assert cells.tolist() == cells_near(s.pieces, s.z, hand, 1e-4, 10**6)[0].tolist()
    assert len(cells) > 0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("side", [1, 3, 16])
def test_the_piece_of_a_point(seed: int, side: int) -> None:
    s = Setting(seed)
    low = s.ring.min(axis=0) - 0.2
    size = float((np.ptp(s.ring, axis=0).max() + 0.4) / side)
    buckets = build_buckets(s.pieces, *low, size, side)
    points = low + s.rng.uniform(-0.2, 1.2, (60, 2)) * side * size
    inside = np.array([[shape.covers(shapely.Point(p)) for shape in s.shapes] for p in points])
    found = [locate(s.pieces, buckets, *p, 1e-9) for p in points]
    for row, k in zip(inside, found, strict=True):
        assert (k >= 0) == row.any()
        assert k < 0 or row[k]
    fingers = points.reshape(20, 3, 2)
    assert (
        cells_of(s.pieces, fingers, buckets, 1e-9).tolist() == np.reshape(found, (20, 3)).tolist()
    )
    assert (depth_inside(s.ring, points, 0.0) > 0.0).tolist() == [
        shapely.Polygon(s.ring).contains(shapely.Point(p)) for p in points
    ]
    gap = shapely.distance(shapely.LinearRing(s.ring), shapely.points(points))
    assert np.abs(depth_inside(s.ring, points, 0.0)) == pytest.approx(gap, abs=1e-12)
    listed = [set(buckets.items[buckets.start[q] : buckets.start[q + 1]]) for q in range(side**2)]
    for i in range(side):
        for j in range(side):
            corner = low + size * np.array([i, j])
            square = shapely.box(*corner, *(corner + size))
            for k, shape in enumerate(s.shapes):
                if shape.intersection(square).area > 1e-9:
                    assert k in listed[i * side + j]
    # a point outside of all pieces by less than the tolerance is in the nearest
    edge = 0.5 * (s.ring[0] + s.ring[1])
    out = np.array([s.ring[1][1] - s.ring[0][1], s.ring[0][0] - s.ring[1][0]])
    p = edge - 1e-5 * out / np.hypot(*out)
    assert locate(s.pieces, buckets, *p, 1e-6) == -1
    assert s.shapes[locate(s.pieces, buckets, *p, 1e-4)].distance(shapely.Point(p)) < 2e-5
    # of two pieces the one that it is deeper in
    for k, shape in enumerate(s.shapes):
        c = shape.centroid
        assert locate(s.pieces, buckets, c.x, c.y, 10.0) == k


def test_nodes_of_cells() -> None:
    s = Setting(1)
    start = cells_near(s.pieces, s.z, s.hand, 1e-9, 10**6)[0][0]
    found = search(s.space, start, 0.0, limit=40)
    m = len(s.pieces.ptr) - 1
    known = {tuple(n): k for k, n in enumerate(found.cells.tolist())}
    cells = np.concatenate([found.cells, s.rng.integers(-1, m, (60, 3))])
    for inside in (len(found.nodes), 7):
        told = nodes_of(found.keys, found.values, cells, m, inside)
        for cell, node in zip(cells.tolist(), told, strict=True):
            k = known.get(tuple(cell), -1)
            assert node == (k if k < inside else -1)


@pytest.mark.parametrize("seed", range(6))
def test_translations_of_a_hand_in_a_cell_are_what_the_pieces_share(seed: int) -> None:
    s = Setting(seed, 1.0 if seed % 2 else 30.0)
    cells, _ = cells_near(s.pieces, s.z, s.hand, 0.05 * s.size, 10**6)
    w = complex(*s.hand[2:]) * 1.1
    full = 0
    for cell in cells[:20]:
        shift = [w * complex(*z) for z in s.z]
        known = s.shapes[cell[0]]
        for k in range(3):
            moved = shapely.affinity.translate(s.shapes[cell[k]], -shift[k].real, -shift[k].imag)
            known = known & moved if k else moved
        corners = translations(s.pieces, s.z, cell, w.real, w.imag)
        if known.area > 1e-6 * s.size**2:
            full += 1
            assert shapely.Polygon(corners).symmetric_difference(known).area < 1e-9 * s.size**2
        elif known.is_empty:
            assert len(corners) < 3 or shapely.Polygon(corners).area < 1e-9 * s.size**2
    assert full > 0 or seed == 3


@pytest.mark.parametrize("seed", range(6))
def test_fingers_see_each_other_where_no_edge_is_between(seed: int) -> None:
    s = Setting(seed, 1.0 if seed % 2 else 50.0)
    solid = shapely.Polygon(s.ring)
    tol = 1e-9 * s.size
    low, span = s.ring.min(axis=0) - 0.2 * s.size, np.ptp(s.ring, axis=0) + 0.4 * s.size
    points = [p for p in low + s.rng.random((60, 2)) * span if not solid.contains(shapely.Point(p))]
    points += [0.5 * (a + b) for a, b in zip(s.ring, np.roll(s.ring, -1, axis=0), strict=True)]
    points += list(s.ring)
    barred = np.zeros(3, np.int64)
    told = [0, 0]
    for _ in range(250):
        u, v = (points[k] for k in s.rng.integers(len(points), size=2))
        known = shapely.LineString([u, v]).intersection(solid).length < 10 * tol
        found = sees(s.pieces, *u, *v, tol, barred, 1)
        deep = shapely.LineString([u, v]).intersection(solid.buffer(-1e-6 * s.size)).length
        if found:
            assert deep == 0.0
        if known and solid.distance(shapely.LineString([u, v])) > 1e-6 * s.size:
            assert found
        told[int(found)] += 1
        assert barred[0] == barred[2] == 0
    assert min(told) > 10
    edge = s.ring[:2]
    along = [edge[0] + t * (edge[1] - edge[0]) for t in (0.3, 0.7)]
    assert sees(s.pieces, *along[0], *along[1], tol, barred, 0)
    assert sees(s.pieces, *edge[0], *edge[0], tol, barred, 0)
    for _ in range(60):
        d, w = (
            complex(*points[s.rng.integers(len(points))]),
            s.size * complex(*s.rng.normal(size=2)),
        )
        at = d + w * (s.z @ [1.0, 1j])
        ends = [np.array([p.real, p.imag]) for p in at]
        if any(solid.contains(shapely.Point(p)) for p in ends):
            continue
        pairs = {frozenset(ij): sees(s.pieces, *ends[ij[0]], *ends[ij[1]], tol, np.zeros(3, int), 0)
                 for ij in combinations(range(3), 2)}  # fmt: skip
        able = [k for k in range(3) if all(seen for pair, seen in pairs.items() if k in pair)]
        found = pivot(s.pieces, s.z, d.real, d.imag, w.real, w.imag, tol, barred)
        assert (found in able) if able else found == -1
