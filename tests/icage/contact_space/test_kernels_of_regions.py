"""Regions and seams of the contact space: against shapely and grids."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from icage.contact_space.exploration import Plane
from icage.contact_space.kernels.explore import region_key
from icage.contact_space.kernels.rectangle import (
    FIRST_SLOT,
    MOST_CORNERS,
    across,
    along,
    finger_at,
    label_line,
    least_of_region,
    least_on_edge,
    region_corners,
    scale_at,
    seam_value,
    slot_progress,
    third_finger,
)
from icage.contact_space.kernels.tunnels import holds, lower_beside, rectangle_minima
from icage.contact_space.kernels.whole import all_regions, hands_at
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.contact_space.setting import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def room(corners: Floats) -> Floats:
    out = np.empty((MOST_CORNERS, 2))
    out[: len(corners)] = corners
    return out


@pytest.mark.parametrize("seed", range(5))
def test_a_region_is_where_the_third_finger_is_in_its_piece(seed: int) -> None:
    s = Setting(seed)
    seen = 0
    for i, j, k in s.rng.integers([3, s.n, s.n], size=(12, 3)):
        regions = [shapely.Polygon(r) if len(r) >= 3 else None for r in
                   (s.region(i, j, k, c) for c in range(s.m))]  # fmt: skip
        for a, b in s.rng.random((25, 2)):
            at, u = a * s.space.edge_length[j], b * s.space.edge_length[k]
            p = shapely.Point(third_finger(s.space, i, j, k, at, u))
            for c, (region, piece) in enumerate(zip(regions, s.shapes, strict=True)):
                inside = region is not None and region.contains(shapely.Point(at, u))
                if piece.boundary.distance(p) > 1e-7 * s.size:
                    assert inside == piece.contains(p)
                    assert holds(s.space, c, p.x, p.y) == piece.contains(p)
                    seen += inside
    assert seen > 20


@pytest.mark.parametrize("seed", range(5))
def test_no_hand_of_a_region_or_a_segment_is_smaller(seed: int) -> None:
    s = Setting(seed)
    for i, j, k, c in s.regions(12):
        corners = s.region(i, j, k, c)
        least = least_of_region(s.space, i, j, k, room(corners), len(corners))
        share = s.rng.dirichlet(np.full(len(corners), 0.3), 60)
        drawn = [scale_at(s.space, i, j, k, *p) for p in share @ corners]
        assert min(drawn) >= least.sigma - 1e-12 * s.size
        for end in ((least.s, least.u), (least.s_too, least.u_too)):
            assert scale_at(s.space, i, j, k, *end) <= least.sigma + 2 * s.space.flat
            assert shapely.Polygon(corners).distance(shapely.Point(end)) < 1e-9 * s.size
        a, b = (share @ corners)[:2]
        one = least_on_edge(s.space, i, j, k, *a, *b)
        on = [scale_at(s.space, i, j, k, *(a + t * (b - a))) for t in np.linspace(0, 1, 60)]
        assert min(on) >= one.sigma - 1e-12 * s.size
        assert scale_at(s.space, i, j, k, one.s, one.u) == pytest.approx(one.sigma)
        assert shapely.LineString([a, b]).distance(shapely.Point(one.s, one.u)) < 1e-9 * s.size


@pytest.mark.parametrize("seed", range(5))
def test_a_valley_has_two_ends(seed: int) -> None:
    s = Setting(seed)
    sides = s.space.edge_tx + 1j * s.space.edge_ty
    low, at = rectangle_minima(s.space)
    for j in range(s.n):
        for k in range(s.n):
            lines = [shapely.LineString([finger_at(s.space, e, 0.0),
                                         finger_at(s.space, e, s.space.edge_length[e])])
                     for e in (j, k)]  # fmt: skip
            assert low[j, k] == pytest.approx(lines[0].distance(lines[1]), abs=1e-9 * s.size)
            for a, b in (at[j, k, :2], at[j, k, 2:]):
                p, q = finger_at(s.space, j, a), finger_at(s.space, k, b)
                assert math.dist(p, q) == pytest.approx(low[j, k], abs=2 * s.space.flat)
            if j == k:
                ends = {tuple(np.round(e / s.size, 6)) for e in (at[j, k, :2], at[j, k, 2:])}
                assert len(ends) == 2
            elif abs((sides[j] * np.conj(sides[k])).imag) > 1e-3:
                assert at[j, k, :2] == pytest.approx(at[j, k, 2:], abs=1e-4 * s.size)
            beside = False
            a, b = at[j, k, :2]
            across_ = (
                (a <= 1e-9, ((j - 1) % s.n, k)), (b <= 1e-9, (j, (k - 1) % s.n)),
                (a >= s.space.edge_length[j] - 1e-9, ((j + 1) % s.n, k)),
                (b >= s.space.edge_length[k] - 1e-9, (j, (k + 1) % s.n)),
            )  # fmt: skip
            for on, other in across_:
                beside |= bool(on and low[other] < low[j, k] - 1e-3 * s.space.tie)
            assert lower_beside(s.space, low, at, j, k) == beside


@pytest.mark.parametrize("seed", range(5))
def test_across_a_seam_is_the_same_hand(seed: int) -> None:
    """The least hand of a seam, told by the region on the other side, has the same fingers."""
    s = Setting(seed)
    out = np.empty((2, 4), np.int64)
    crossed = {1: 0, 2: 0}
    for i, j, k, c in s.regions(14):
        corners = s.region(i, j, k, c)
        line = shapely.Polygon(corners).boundary
        for label in range(FIRST_SLOT + s.space.ptr[c + 1] - s.space.ptr[c]):
            value, a, b = seam_value(s.space, i, j, k, c, label, room(corners), len(corners))
            h0, hs, hu = label_line(s.space, i, j, k, c, label)
            g0, gs, gu, long = slot_progress(s.space, i, j, k, c, label)
            points = [line.interpolate(t, normalized=True) for t in np.linspace(0, 1, 120)]
            on = [p for p in points if abs(h0 + hs * p.x + hu * p.y) < 1e-9 * s.size
                  and -1e-9 <= g0 + gs * p.x + gu * p.y <= long + 1e-9]  # fmt: skip
            if value == np.inf:
                assert on == []
                continue
            assert scale_at(s.space, i, j, k, a, b) == pytest.approx(value)
            assert abs(h0 + hs * a + hu * b) < 1e-6 * s.size
            assert line.distance(shapely.Point(a, b)) < 1e-6 * s.size
            if on:
                least = min(scale_at(s.space, i, j, k, p.x, p.y) for p in on)
                assert least >= value - 1e-9 * s.size
            many = across(s.space, i, j, k, c, label, out)
            here = s.fingers(i, j, k, a, b)
            for row in out[:many]:
                crossed[many] += 1
                assert tuple(row) != (i, j, k, c)
                pair = [here[row[0]], here[(row[0] + 1) % 3]]
                third = here[(row[0] + 2) % 3]
                for p, edge in zip(pair, row[1:3], strict=True):
                    start = complex(*finger_at(s.space, edge, 0.0))
                    way = complex(s.space.edge_tx[edge], s.space.edge_ty[edge])
                    off = (p - start) * np.conj(way)
                    assert abs(off.imag) < 1e-6 * s.size
                    assert -1e-6 * s.size < off.real < s.space.edge_length[edge] + 1e-6 * s.size
                gap = s.shapes[row[3]].distance(shapely.Point(third.real, third.imag))
                assert gap < 1e-6 * s.size
    assert min(crossed.values()) > 5


def test_lines_of_labels_are_distances() -> None:
    s = Setting(1)
    i, j, k, c = s.regions(1)[0]
    long_s, long_u = s.space.edge_length[j], s.space.edge_length[k]
    for a, b in s.rng.random((10, 2)) * [long_s, long_u]:
        p = shapely.Point(third_finger(s.space, i, j, k, a, b))
        edges = list(s.shapes[c].exterior.coords)
        known = [a, b, long_s - a, long_u - b]
        for u, v in itertools.pairwise(edges):
            way = complex(*v) - complex(*u)
            known.append(((complex(p.x, p.y) - complex(*u)) * np.conj(way)).imag / abs(way))
        for label, gap in enumerate(known):
            h0, hs, hu = label_line(s.space, i, j, k, c, label)
            assert h0 + hs * a + hu * b == pytest.approx(gap, abs=1e-9)
            g0, gs, gu, long = slot_progress(s.space, i, j, k, c, label)
            if label < FIRST_SLOT:
                assert (g0, gs, gu, long) == (0.0, 0.0, 0.0, 0.0)
                continue
            u, v = edges[label - FIRST_SLOT : label - FIRST_SLOT + 2]
            way = complex(*v) - complex(*u)
            on = ((complex(p.x, p.y) - complex(*u)) * np.conj(way)).real / abs(way)
            assert g0 + gs * a + gu * b == pytest.approx(on, abs=1e-9)
            assert long == pytest.approx(abs(way))


def test_the_height_of_the_third_finger_is_linear() -> None:
    s = Setting(0)
    for _ in range(20):
        i, j, k = s.rng.integers([3, s.n, s.n])
        nx, ny, x0, y0 = s.rng.normal(size=4)
        h0, hs, hu = along(s.space, i, j, k, nx, ny, x0, y0)
        for a, b in s.rng.random((3, 2)):
            x, y = third_finger(s.space, i, j, k, a, b)
            assert h0 + hs * a + hu * b == pytest.approx(nx * (x - x0) + ny * (y - y0), abs=1e-9)


def test_every_region_of_a_small_object_has_its_least_node() -> None:
    """Of each region that holds a hand one row, found by its key, and a hand of least sigma."""
    corners = np.array([[0.0, 0.0], [2.0, 0.2], [0.7, 1.5]])
    contacts = np.array([[1.0, 0.1], [1.3, 0.88], [0.35, 0.75]])
    space = Plane.around(Outline(corners), HandShape.from_contacts(contacts)).space
    regions, nodes, known = all_regions(space)
    row, out, spare = 0, np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
    n, m = len(space.edge_x), len(space.ptr) - 1
    for at in itertools.product(range(3), range(n), range(n), range(m)):
        count = region_corners(space, *at, out, spare)
        key = region_key(space, *at)
        assert (key in known) == (count > 0)
        if count == 0:
            continue
        assert known[key] == row
        assert regions[row].tolist() == list(at)
        sigma, s, u = nodes[row]
        least = least_of_region(space, *at[:3], out, count)
        assert sigma == least.sigma
        assert scale_at(space, *at[:3], s, u) == pytest.approx(sigma, abs=2 * space.flat)
        # on a valley in its middle
        middle = [0.5 * (least.s + least.s_too), 0.5 * (least.u + least.u_too)]
        assert [s, u] == pytest.approx(middle)
        row += 1
    assert len(regions) == len(nodes) == len(known) == row > 20
    hands = hands_at(space, regions, nodes)
    assert np.hypot(*hands[:, 2:].T) == pytest.approx(nodes[:, 0], abs=2 * space.flat)
