"""The readable equations: they agree with the compiled kernels, and with each other."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.contact_space.boundary import Boundary
from icage.contact_space.equilibria import pair_grasps, three_finger_kind
from icage.contact_space.exploration import Plane
from icage.contact_space.formation_scale import ScaleForm, formation_scale, rho
from icage.contact_space.free_regions import exterior_rings, regions_of_rectangle
from icage.contact_space.kernels.rectangle import least_on_edge, scale_at, third_finger
from icage.contact_space.nodes import lambda_crit, nodes_of_region
from icage.contact_space.obstacles import interior_pieces, obstacles, rectangle_obstacle
from icage.contact_space.sectors import _CORNER, common_area, concurrency_point, sector_at
from icage.contact_space.third_finger import Parallelogram
from icage.errors import GeometryError
from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.targets import random_target

SEEDS = range(4)
"""Random targets that every law is tried on."""


def setting(seed: int, longest: int = 30) -> tuple[Plane, Boundary, np.random.Generator]:
    rng = np.random.default_rng([seed, 3])
    while True:
        target = random_target(rng)
        if len(target.vertices) <= longest:
            break
    outline = Outline(target.vertices)
    plane = Plane.around(outline, HandShape.from_contacts(target.contacts))
    return plane, Boundary.of(outline), rng


def rectangles(boundary: Boundary, rng: np.random.Generator, count: int) -> list[tuple[int, ...]]:
    n = len(boundary)
    return [tuple(int(v) for v in rng.integers([3, n, n])) for _ in range(count)]


@pytest.mark.parametrize("seed", SEEDS)
def test_points_scale_and_third_finger_are_those_of_the_kernels(seed: int):
    plane, boundary, rng = setting(seed)
    space, size = plane.space, plane.outline.diameter
    assert len(boundary) == space.edges
    for i, j, k in rectangles(boundary, rng, 40):
        along = rng.random(2) * boundary.length[[j, k]]
        s = boundary.s_0[[j, k]] + along
        finger = Parallelogram.over(boundary, plane.hand, i, j, k).at(s) - plane.origin
        compiled = third_finger(space, i, j, k, *along)
        assert finger == pytest.approx(np.array(compiled), abs=1e-12 * size * 100)
        sigma = scale_at(space, i, j, k, *along)
        tiny = 1e-12 * size * max(1.0, rho(plane.hand, i))
        assert formation_scale(boundary, plane.hand, i, *s) == pytest.approx(sigma, abs=tiny)
        form = ScaleForm.of(boundary, plane.hand, i, j, k)
        assert form(s) == pytest.approx(sigma, abs=10 * tiny)
        # all three fingers stand as the hand's shape says
        p, q = boundary.at(s)
        ordered = np.roll([p, q, finger + plane.origin], i, axis=0)
        assert HandShape.from_contacts(ordered).z_3 == pytest.approx(plane.hand.z_3, rel=1e-6)


def test_arclength_runs_round_the_boundary():
    boundary = Boundary.of(Outline([[0, 0], [1, 0], [2, 0], [2, 2], [0, 2]]))
    assert boundary.s_0.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]  # the straight vertex is no edge end
    s = np.array([0.5, 2.0, 5.0, 8.5])
    assert boundary.at(s).tolist() == [[0.5, 0.0], [2.0, 0.0], [1.0, 2.0], [0.5, 0.0]]
    assert boundary.nearest(np.array([2.25, 1.0])) == (1, 3.0, 0.25)


@pytest.mark.parametrize("seed", SEEDS)
def test_eq_4_inverts_eq_3(seed: int):
    plane, boundary, rng = setting(seed)
    for i, j, k in rectangles(boundary, rng, 40):
        finger = Parallelogram.over(boundary, plane.hand, i, j, k)
        if finger.singular:
            continue
        s = finger.s_0 + rng.random((5, 2)) * finger.size
        close = 1e-12 * boundary.perimeter * np.linalg.cond(finger.t)
        assert np.abs(finger.pull_back(finger.at(s)) - s).max() <= close


@pytest.mark.parametrize("seed", SEEDS)
def test_regions_are_those_of_the_kernels(seed: int):
    plane, boundary, rng = setting(seed)
    size = plane.outline.diameter
    compared = 0
    rings = exterior_rings(plane)
    for i, j, k in rectangles(boundary, rng, 60):
        finger = Parallelogram.over(boundary, plane.hand, i, j, k)
        for c, piece in enumerate(rings):
            corners = plane.corners(np.array([i, j, k, c]))
            part = finger.clipped(piece)
            ours = shapely.MultiPoint(part).convex_hull
            theirs = shapely.MultiPoint(corners + finger.s_0).convex_hull
            thin = max(ours.area, theirs.area) <= 1e-9 * size**2
            compared += not thin
            assert thin or shapely.hausdorff_distance(ours, theirs) <= 1e-8 * size
    assert compared > 20


@pytest.mark.parametrize("seed", SEEDS)
def test_extrema_of_edges_are_those_of_the_kernels(seed: int):
    plane, boundary, rng = setting(seed)
    for i, j, k in rectangles(boundary, rng, 40):
        form = ScaleForm.of(boundary, plane.hand, i, j, k)
        ends = rng.random((2, 2)) * boundary.length[[j, k]]
        least, s, u = least_on_edge(plane.space, i, j, k, *ends[0], *ends[1])
        here = lambda_crit(form, *(ends + boundary.s_0[[j, k]]))
        if here is None:
            continue
        at = ends[0] + np.clip(here, 0.0, 1.0) * (ends[1] - ends[0])
        assert form(at + boundary.s_0[[j, k]]) == pytest.approx(least, rel=1e-9, abs=1e-12)
        if abs(j - k) > 0:
            assert at == pytest.approx(np.array([s, u]), abs=1e-6 * boundary.perimeter)


@pytest.mark.parametrize("seed", SEEDS)
def test_obstacle_and_free_regions_tile_a_rectangle(seed: int):
    plane, boundary, rng = setting(seed)
    pieces = interior_pieces(boundary)
    assert sum(shapely.Polygon(p).area for p in pieces) == pytest.approx(plane.outline.area)
    for i, j, k in rectangles(boundary, rng, 30):
        finger = Parallelogram.over(boundary, plane.hand, i, j, k)
        whole = float(finger.size.prod())
        if finger.singular:
            continue
        blocked = rectangle_obstacle(finger, pieces)
        free = [region for _, region in regions_of_rectangle(plane, boundary, i, j, k)]
        area = sum(shapely.MultiPoint(region).convex_hull.area for region in free)
        assert blocked.area + area == pytest.approx(whole, rel=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_on_the_boundary_of_an_obstacle_the_third_finger_touches(seed: int):
    plane, boundary, _ = setting(seed, longest=14)
    for i in range(3):
        cb = obstacles(boundary, plane.hand, i)
        assert not cb.is_empty
        s = shapely.get_coordinates(cb.boundary)
        edge = 1e-9 * boundary.perimeter
        for point in s:
            # inside a rectangle; on its sides the obstacle may go on next door
            j, k = boundary.edge_at(point)
            off = point - boundary.s_0[[j, k]]
            rim = min(off.min(), (boundary.length[[j, k]] - off).min()) <= edge
            if not rim:
                x = Parallelogram.over(boundary, plane.hand, i, int(j), int(k)).at(point)
                assert boundary.nearest(x)[2] <= 1e-9 * plane.outline.diameter
        # along the edges of the obstacle too, wherever the union is not cut off by [0, L]^2
        for ring in shapely.get_parts(cb.boundary):
            for share in (0.31, 0.77):
                p = ring.interpolate(share, normalized=True)
                at = np.array([p.x, p.y])
                if min(at.min(), (boundary.perimeter - at).min()) <= edge:
                    continue
                j, k = (int(v) for v in boundary.edge_at(at))
                x = Parallelogram.over(boundary, plane.hand, i, j, k).at(at)
                assert boundary.nearest(x)[2] <= 1e-9 * plane.outline.diameter


def tried_one_by_one(plane: Plane, boundary: Boundary, i: int, rng: np.random.Generator) -> int:
    cb = obstacles(boundary, plane.hand, i)
    s = rng.random((400, 2)) * boundary.perimeter
    near = shapely.distance(shapely.points(s), cb.boundary) <= 1e-9 * boundary.perimeter
    inside = shapely.contains_xy(cb, s)
    for point, covered in zip(s[~near], inside[~near], strict=True):
        j, k = (int(v) for v in boundary.edge_at(point))
        x = Parallelogram.over(boundary, plane.hand, i, j, k).at(point)
        assert covered == shapely.contains_xy(plane.outline.polygon, *x)
    return int((~near).sum())


def test_obstacles_against_points_tried_one_by_one():
    plane, boundary, rng = setting(1, longest=14)
    assert sum(tried_one_by_one(plane, boundary, i, rng) for i in range(3)) > 1000


def singular_case() -> tuple[Plane, Boundary, Parallelogram]:
    """T is singular where the edges meet at the angle of the third finger: on a square, a right
    one. (On parallel edges it would take a flat hand.)"""
    outline = Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
    plane = Plane.around(outline, HandShape(0.5 + 0.5j))
    boundary = Boundary.of(outline)
    return plane, boundary, Parallelogram.over(boundary, plane.hand, 0, 0, 1)


def test_a_singular_t_is_clipped_without_its_inverse():
    plane, boundary, finger = singular_case()
    assert finger.singular
    with pytest.raises(GeometryError, match="singular"):
        finger.pull_back(np.zeros(2))
    # the third finger moves on a segment; half of it is left of x = its middle
    middle = finger.corners.mean(axis=0)
    low, high = middle - 10.0, middle + 10.0
    half = np.array([low, [middle[0], low[1]], [middle[0], high[1]], [low[0], high[1]]])
    part = finger.clipped(half)
    assert shapely.Polygon(part).area == pytest.approx(0.5 * finger.size.prod())
    assert finger.at(part)[:, 0].max() <= middle[0] + 1e-12
    # inside the square, which is all of the obstacle; beyond a corner, nothing is
    covered = rectangle_obstacle(finger, interior_pieces(boundary))
    assert covered.area == pytest.approx(finger.size.prod())
    other = Parallelogram.over(boundary, plane.hand, 0, 1, 0)
    regions = regions_of_rectangle(plane, boundary, 0, 1, 0)
    assert other.singular
    assert sum(shapely.Polygon(r).area for _, r in regions) == pytest.approx(other.size.prod())
    assert all(nodes_of_region(boundary, plane.hand, 0, 1, 0, region) for _, region in regions)
    for i in range(3):
        assert tried_one_by_one(plane, boundary, i, np.random.default_rng(0)) > 300


@pytest.mark.parametrize("seed", SEEDS)
def test_nodes_are_vertices_and_extrema(seed: int):
    plane, boundary, rng = setting(seed)
    seen = set()
    for i, j, k in rectangles(boundary, rng, 60):
        form = ScaleForm.of(boundary, plane.hand, i, j, k)
        for c, region in regions_of_rectangle(plane, boundary, i, j, k):
            nodes = nodes_of_region(boundary, plane.hand, i, j, k, region)
            seen |= {node.kind for node in nodes}
            least, _ = plane.least(np.array([i, j, k, c]))
            tiny = 1e-9 * plane.outline.diameter
            assert min(node.sigma for node in nodes) == pytest.approx(least, abs=tiny, rel=1e-9)
            for node in nodes:
                assert node.sigma == pytest.approx(float(form(node.s)))
                if node.third is not None:
                    x = Parallelogram.over(boundary, plane.hand, i, j, k).at(node.s)
                    touched = boundary.at(np.array(node.third))
                    assert np.hypot(*(touched - x)) <= 2e-9 * boundary.perimeter
    assert seen >= {"vertex", "extremum"}


def test_an_escape_node_where_the_fingers_meet():
    plane, boundary, _ = setting(0)
    kinds = set()
    for c, region in regions_of_rectangle(plane, boundary, 0, 1, 1):
        del c
        kinds |= {n.kind for n in nodes_of_region(boundary, plane.hand, 0, 1, 1, region)}
    assert "escape" in kinds


def test_two_finger_grasps_of_a_notched_plate():
    #   a 4 x 2 plate with a notch from above down to (2, 1)
    boundary = Boundary.of(Outline([[0, 0], [4, 0], [4, 2], [3, 2], [2, 1], [1, 2], [0, 2]]))
    found = pair_grasps(boundary)
    kinds = {g.kind for g in found}
    assert kinds >= {"vertex and edge", "parallel edges", "two vertices"}
    notch = [g for g in found if g.kind == "vertex and edge" and [2.0, 1.0] in g.contacts.tolist()]
    assert [g.contacts.tolist() for g in notch] == [[[2.0, 0.0], [2.0, 1.0]]]
    widths = sorted(round(g.width, 9) for g in found if g.kind == "parallel edges")
    assert widths == [2.0, 2.0, 4.0]


@pytest.mark.parametrize("first", range(7))
def test_two_finger_grasps_do_not_hang_on_where_the_outline_begins(first: int):
    ring = np.array([[0, 0], [4, 0], [4, 2], [3, 2], [2, 1], [1, 2], [0, 2]], dtype=np.float64)
    found = pair_grasps(Boundary.of(Outline(np.roll(ring, first, axis=0))))
    wanted = pair_grasps(Boundary.of(Outline(ring)))
    assert {(g.kind, round(g.width, 9)) for g in found} == {
        (g.kind, round(g.width, 9)) for g in wanted
    }
    assert len(found) == len(wanted)


def test_a_contact_beside_a_vertex_has_the_sector_of_the_vertex():
    ring = np.array([[0, 0], [4, 0], [4, 2], [3, 2], [2, 1], [1, 2], [0, 2]], dtype=np.float64)
    boundary = Boundary.of(Outline(ring))
    aside = 0.5 * _CORNER * boundary.perimeter
    for k, vertex in enumerate(boundary.start):
        for way in (boundary.tangent[k], -boundary.tangent[k - 1]):
            for off in (0.0, aside):
                sector = sector_at(boundary, vertex + off * way, 1.0)
                assert sector is not None
                assert sector.vertex
                assert sector.contact.tolist() == vertex.tolist()
                assert sector.convex == (vertex.tolist() != [2.0, 1.0])
            beyond = sector_at(boundary, vertex + 3.0 * aside * way, 1.0)
            assert beyond is not None
            assert not beyond.vertex


@pytest.mark.parametrize("seed", SEEDS)
def test_sectors_meet_where_the_normals_of_a_target_meet(seed: int):
    rng = np.random.default_rng([seed, 7])
    target = random_target(rng)
    boundary = Boundary.of(Outline(target.vertices))
    size = 3.0 * Outline(target.vertices).diameter
    sectors = [sector_at(boundary, p, size) for p in target.contacts]
    held = [s for s in sectors if s is not None]
    assert len(held) == 3
    if any(s.convex for s in held):
        pytest.skip("a convex vertex is merely touched: the others may balance alone")
    point = concurrency_point(held)
    assert point is not None
    for sector in held:
        out = shapely.Point(point).distance(shapely.union(sector.forward, sector.backward))
        assert out <= 1e-6 * size or np.hypot(*(point - sector.contact)) > size
        if not sector.vertex:
            n = sector.normals[0]
            way = point - sector.contact
            assert abs(way[0] * n[1] - way[1] * n[0]) <= 1e-6 * max(size, np.hypot(*way))
    assert three_finger_kind(boundary, target.contacts, 1e-6 * size) is not None
    common = common_area(held)
    if common.area > 1e-6 * size**2 and all(s.vertex for s in held):
        assert shapely.distance(shapely.Point(point), common) <= 1e-9 * size
