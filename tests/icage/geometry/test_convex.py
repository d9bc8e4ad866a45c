"""Convex pieces: they tile the region exactly, stay convex, and signs are never guessed."""

from __future__ import annotations

from fractions import Fraction
from time import process_time

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from icage.errors import GeometryError
from icage.geometry.convex import merge_convex, orientation, triangulate


def star(seed: int, corners: int) -> shapely.Polygon:
    """A random star-shaped polygon, deeply toothed."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
    radius = rng.uniform(0.3, 1.0, corners)
    return shapely.Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))


def around(polygon: shapely.Polygon) -> shapely.Polygon:
    outside = shapely.box(-3.0, -3.0, 3.0, 3.0).difference(polygon)
    assert isinstance(outside, shapely.Polygon)
    return outside


def rounded(polygon: shapely.Polygon, segments: int) -> shapely.Polygon:
    """Finely split arcs: the sliver case."""
    return shapely.Polygon(polygon.buffer(0.05, quad_segs=segments).exterior)


def pairs(ring: list[int]) -> list[tuple[int, int]]:
    """The edges of a ring."""
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


REGIONS = [
    *(star(seed, corners) for seed, corners in ((0, 5), (1, 12), (2, 40), (3, 150))),
    *(around(star(seed, corners)) for seed, corners in ((4, 5), (5, 40), (6, 150))),
    rounded(star(7, 12), 64),
    around(rounded(star(8, 12), 64)),
    around(affinity.rotate(rounded(star(9, 20), 32), 33.0)),
]


def exact_area(points: list[tuple[float, float]]) -> Fraction:
    corners = [(Fraction(x), Fraction(y)) for x, y in points]
    following = corners[1:] + corners[:1]
    return (
        sum(
            (a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, following, strict=True)),
            Fraction(0),
        )
        / 2
    )


@pytest.mark.parametrize("region", REGIONS)
@pytest.mark.parametrize("cap", [3, 6, 10, 10_000])
def test_pieces_tile_the_region_and_are_convex(region: shapely.Polygon, cap: int) -> None:
    vertices, triangles = triangulate(region)
    rings = merge_convex(vertices, triangles, max_edges=cap)
    points = [(x, y) for x, y in vertices.tolist()]
    areas = [exact_area([points[i] for i in ring]) for ring in rings]
    whole = exact_area([(x, y) for x, y in shapely.get_coordinates(region.exterior)[:-1].tolist()])
    for hole in region.interiors:
        whole = abs(whole) - abs(exact_area([(x, y) for x, y in hole.coords[:-1]]))
    assert sum(areas) == abs(whole)  # in rational numbers: not a sliver is missing
    for ring, area in zip(rings, areas, strict=True):
        assert 3 <= len(ring) <= max(cap, 3)
        assert area > 0
        corners = [points[i] for i in ring]
        for k in range(len(corners)):
            assert orientation(corners[k - 2], corners[k - 1], corners[k]) >= 0
    if cap == 3:
        assert len(rings) == len(triangles)


@pytest.mark.parametrize("region", REGIONS)
def test_no_removable_diagonal_is_left(region: shapely.Polygon) -> None:
    vertices, triangles = triangulate(region)
    rings = merge_convex(vertices, triangles, max_edges=10_000)
    owner = {(a, b): k for k, ring in enumerate(rings) for a, b in pairs(ring)}
    assert len(owner) == sum(map(len, rings))
    pieces = [shapely.Polygon(vertices[ring]) for ring in rings]
    for (a, b), k in owner.items():
        j = owner.get((b, a))
        if j is not None and k < j:
            joined = shapely.union(pieces[k], pieces[j])
            missing = shapely.convex_hull(joined).area - joined.area
            assert missing > 0.0


def test_neighbours_meet_vertex_to_vertex() -> None:
    """Every edge is an edge of the region or is shared, whole, by exactly two pieces."""
    region = around(star(11, 40))
    vertices, triangles = triangulate(region)
    rings = merge_convex(vertices, triangles)
    edges = {(a, b) for ring in rings for a, b in pairs(ring)}
    single = [(a, b) for a, b in edges if (b, a) not in edges]
    assert len(single) == len(vertices)
    length = sum(float(np.linalg.norm(vertices[a] - vertices[b])) for a, b in single)
    assert length == pytest.approx(region.length, rel=1e-12)


def test_straight_corners_are_kept_as_vertices() -> None:
    square = shapely.Polygon([(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 3), (0, 3), (0, 2)])
    vertices, triangles = triangulate(square)
    assert merge_convex(vertices, triangles) == [list(range(8))]


def test_cap_is_respected_on_a_fine_circle() -> None:
    disc = shapely.Point(0.0, 0.0).buffer(1.0, quad_segs=64)
    vertices, triangles = triangulate(disc)
    sizes = [len(ring) for ring in merge_convex(vertices, triangles, max_edges=8)]
    assert max(sizes) == 8
    assert sum(size - 2 for size in sizes) == len(triangles)


def test_same_answer_whatever_the_order_of_the_triangles() -> None:
    region = around(star(12, 40))
    vertices, triangles = triangulate(region)
    rng = np.random.default_rng(1)
    shuffled = rng.permutation(np.array([np.roll(t, rng.integers(3)) for t in triangles]))
    assert merge_convex(vertices, shuffled) == merge_convex(vertices, triangles)


def test_overlapping_triangles_are_refused() -> None:
    vertices = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    with pytest.raises(GeometryError, match="same direction"):
        merge_convex(vertices, np.array([[0, 1, 2], [0, 1, 3]]))


def test_six_hundred_triangles_in_thirty_milliseconds() -> None:
    vertices, triangles = triangulate(around(star(13, 600)))
    best = min(_seconds(lambda: merge_convex(vertices, triangles)) for _ in range(5))
    assert len(triangles) >= 600
    assert best < 0.03


def _seconds(work: object) -> float:
    assert callable(work)
    start = process_time()
    work()
    return process_time() - start


near = st.integers(-3, 3)
"""Steps of one unit in the last place: samples close to the singularity on purpose."""


@settings(max_examples=300, deadline=None)
@given(
    st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0),
    st.floats(-1.0, 2.0), near, near,
)  # fmt: skip
def test_orientation_is_the_rational_sign(
    ax: float, ay: float, bx: float, by: float, t: float, dx: int, dy: int
) -> None:
    cx, cy = ax + t * (bx - ax), ay + t * (by - ay)
    cx, cy = cx + dx * np.spacing(cx), cy + dy * np.spacing(cy)
    a, b, c = (ax, ay), (bx, by), (float(cx), float(cy))
    area = exact_area([a, b, c])
    assert orientation(a, b, c) == (area > 0) - (area < 0)
    assert orientation(b, c, a) == orientation(a, b, c) == -orientation(b, a, c)
