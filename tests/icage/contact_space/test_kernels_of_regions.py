"""Regions, seams, rays and tunnel edges of the contact space: against shapely and grids."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from icage.contact_space.exploration import Plane
from icage.contact_space.kernels.columns import (
    ABOVE,
    BELOW,
    HAND,
    HAND_LEVEL,
    HAND_TOO,
    TUNNEL_BELOW,
    TUNNEL_KEPT,
)
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
from icage.contact_space.kernels.shooting import (
    LANDED,
    NO_TUNNEL,
    PINCHED,
    first_hit,
    may_leave,
    piece_of,
    shoot,
    touches,
)
from icage.contact_space.kernels.tunnels import all_tunnels, holds, lower_beside, rectangle_minima
from icage.contact_space.kernels.whole import all_regions, hands_at
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.contact_space.test_equations import setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


class Setting:
    """A random object with its surroundings, as shapely's shapes."""

    def __init__(self, seed: int) -> None:
        plane, _, self.rng = setting(seed, 14)
        self.space = s = plane.space
        self.size = plane.outline.diameter
        self.z = np.asarray(plane.hand.z)
        self.n, self.m = len(s.edge_x), len(s.ptr) - 1
        self.ring = np.column_stack([s.edge_x, s.edge_y])
        self.solid = shapely.Polygon(self.ring)
        self.shapes = [
            shapely.Polygon(np.column_stack([s.slot_x[a:b], s.slot_y[a:b]]))
            for a, b in zip(s.ptr[:-1], s.ptr[1:], strict=True)
        ]

    def fingers(self, i: int, j: int, k: int, s: float, u: float) -> Floats:
        """The three fingers (3,) complex, of pair i on edges j and k, in their own order."""
        pair = [complex(*finger_at(self.space, j, s)), complex(*finger_at(self.space, k, u))]
        third = complex(*third_finger(self.space, i, j, k, s, u))
        return np.roll([*pair, third], i)

    def region(self, i: int, j: int, k: int, c: int) -> Floats:
        corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
        return corners[: region_corners(self.space, i, j, k, c, corners, spare)].copy()

    def regions(self, count: int) -> list[tuple[int, int, int, int]]:
        """Regions with an area, at random."""
        found = []
        for _ in range(4000):
            at = tuple(int(v) for v in self.rng.integers([3, self.n, self.n, self.m]))
            corners = self.region(*at)
            if len(corners) >= 3 and shapely.Polygon(corners).area > 1e-4 * self.size**2:
                found.append(at)
            if len(found) == count:
                break
        return found


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


@pytest.mark.parametrize("seed", range(5))
def test_where_a_point_is_and_what_a_ray_meets(seed: int) -> None:
    s = Setting(seed)
    ends = zip(s.ring, np.roll(s.ring, -1, axis=0), strict=True)
    edges = [shapely.LineString(pair) for pair in ends]
    low, span = s.ring.min(axis=0) - 0.2 * s.size, np.ptp(s.ring, axis=0) + 0.4 * s.size
    points = low + s.rng.random((60, 2)) * span
    out = np.array([p for p in points if not s.solid.contains(shapely.Point(p))])
    for p in points:
        gap = s.solid.boundary.distance(shapely.Point(p))
        assert touches(s.space._replace(touch=gap * 1.001), *p)
        assert not touches(s.space._replace(touch=gap * 0.999), *p)
    hits = 0
    for p, q in itertools.pairwise(out):
        t, wall, place = first_hit(s.space, *p, *q, -1, -1)
        met = shapely.LineString([p, q]).intersection(s.solid)
        if met.is_empty:
            assert (t, wall) == (np.inf, -1)
            continue
        hits += 1
        near = shapely.Point(p).distance(met)
        assert t * math.dist(p, q) == pytest.approx(near, abs=1e-9 * s.size)
        at = p + t * (q - p)
        assert edges[wall].distance(shapely.Point(at)) < 1e-9 * s.size
        assert finger_at(s.space, wall, place) == pytest.approx(tuple(at), abs=1e-9 * s.size)
        after, other, _ = first_hit(s.space, *p, *q, wall, -1)
        assert other != wall
        assert after >= t
        assert first_hit(s.space, *p, *q, -1, wall)[:2] == (after, other)
        short = first_hit(s.space, *p, *(p + 0.99 * t * (q - p)), -1, -1)
        assert short[1] == -1
        exact = first_hit(s.space, *p, *(p + t * (q - p)), -1, -1)
        assert exact[1] == wall
        assert exact[0] == pytest.approx(1.0)
    assert hits > 5


@pytest.mark.parametrize("seed", range(5))
def test_a_finger_may_leave_into_the_open(seed: int) -> None:
    """Along an edge and at both of its ends, where the corner decides."""
    s = Setting(seed)
    told = [0, 0]
    for edge in range(s.n):
        length = s.space.edge_length[edge]
        for at, mate in ((0.4 * length, -1), (0.0, (edge - 1) % s.n), (length, (edge + 1) % s.n)):
            p = np.array(finger_at(s.space, edge, at))
            for angle in s.rng.uniform(0.0, 2.0 * np.pi, 8):
                way = np.array([np.cos(angle), np.sin(angle)])
                free, other = may_leave(s.space, edge, at, *way)
                assert other == mate
                known = not s.solid.contains(shapely.Point(p + 1e-6 * s.size * way))
                assert free == known
                told[int(free)] += 1
    assert min(told) > 10


@pytest.mark.parametrize("seed", range(6))
def test_a_hand_that_shrinks_lands_where_a_finger_meets_the_object(seed: int) -> None:
    s = Setting(seed)
    ends = {NO_TUNNEL: 0, LANDED: 0, PINCHED: 0}
    for _ in range(120):
        i, j, k = s.rng.integers([3, s.n, s.n])
        at, u = s.rng.random(2) * s.space.edge_length[[j, k]]
        hand = s.fingers(i, j, k, at, u)
        third = hand[(i + 2) % 3]
        if s.solid.contains(shapely.Point(third.real, third.imag)) or j == k:
            continue
        for keep in range(2):
            landing, where = np.full(3, -9), np.full(4, np.nan)
            end = shoot(s.space, i, j, k, at, u, keep, landing, where)
            ends[end] += 1
            still, mover = hand[(i + keep) % 3], hand[(i + 1 - keep) % 3]
            lines = [shapely.LineString([(p.real, p.imag), (still.real, still.imag)])
                     for p in (mover, third)]  # fmt: skip
            step = mover + 1e-6 * (still - mover)
            leaves = not s.solid.contains(shapely.Point(step.real, step.imag))
            assert (end == NO_TUNNEL) == (not leaves)
            if end == NO_TUNNEL:
                continue
            if end == PINCHED:
                inside = [line.intersection(s.solid).length for line in lines]
                assert max(inside) < 1e-6 * s.size
                continue
            pair, first, second = landing
            low = s.fingers(pair, first, second, *where[:2])
            # the finger that is kept is where it was; the hand is smaller and has turned nowhere
            assert low[(i + keep) % 3] == pytest.approx(still, abs=1e-9 * s.size)
            ratio = (low[1] - low[0]) / (hand[1] - hand[0])
            assert ratio.imag == pytest.approx(0.0, abs=1e-9)
            assert 0.0 < ratio.real < 1.0
            free = low[(pair + 2) % 3]
            assert (free.real, free.imag) == pytest.approx(tuple(where[2:]), abs=1e-9 * s.size)
            for old, new in zip(hand, low, strict=True):
                if abs(old - new) > 1e-9 * s.size:
                    way = shapely.LineString([(old.real, old.imag), (new.real, new.imag)])
                    assert way.intersection(s.solid).length < 1e-6 * s.size
            c = piece_of(s.space, pair, first, second, *where[2:])
            if c >= 0:
                assert s.shapes[c].distance(shapely.Point(where[2:])) < 1e-6 * s.size
                assert len(s.region(pair, first, second, c)) > 0
    assert min(ends.values()) > 3


@pytest.mark.parametrize("seed", range(6))
def test_tunnel_edges_lead_down_through_free_space(seed: int) -> None:
    """Their upper hand is a local minimum of the distance of two fingers, the third one free."""
    s = Setting(seed)
    found = all_tunnels(s.space)
    for row, hands in zip(found.rows, found.hands, strict=True):
        i, j, k, c = row[ABOVE]
        d, w = complex(*hands[HAND][:2]), complex(*hands[HAND][2:])
        hand = d + w * s.z
        assert abs(w) == pytest.approx(hands[HAND_LEVEL])
        third = hand[(i + 2) % 3]
        point = shapely.Point(third.real, third.imag)
        assert not s.solid.contains(point)
        assert s.shapes[c].distance(point) < 1e-6 * s.size
        edges = [shapely.LineString([finger_at(s.space, e, 0.0),
                                     finger_at(s.space, e, s.space.edge_length[e])])
                 for e in (j, k)]  # fmt: skip
        gap = abs(hand[(i + 1) % 3] - hand[i])
        assert gap == pytest.approx(edges[0].distance(edges[1]), abs=1e-6 * s.size)
        keep = (i + row[TUNNEL_KEPT]) % 3
        if row[TUNNEL_BELOW] < 0:
            assert (row[BELOW] == -1).all()
            assert (hands[HAND_TOO] == 0.0).all()
            low = np.full(3, hand[keep])
        else:
            d, w = complex(*hands[HAND_TOO][:2]), complex(*hands[HAND_TOO][2:])
            low = d + w * s.z
            assert low[keep] == pytest.approx(hand[keep], abs=1e-9 * s.size)
            assert abs(w) < hands[HAND_LEVEL]
            assert len(s.region(*row[BELOW])) > 0
        for old, new in zip(hand, low, strict=True):
            way = shapely.LineString([(old.real, old.imag), (new.real, new.imag)])
            assert way.intersection(s.solid).length < 1e-6 * s.size


@pytest.mark.parametrize("seed", range(6))
def test_every_lowest_pair_with_a_free_third_finger_has_its_tunnel_edge(seed: int) -> None:
    s = Setting(seed)
    low, at = rectangle_minima(s.space)
    rows = [tuple(row[:3]) for row in all_tunnels(s.space).rows.tolist()]
    known = []
    for j in range(s.n):
        for k in range(s.n):
            a, b = at[j, k, :2]
            valley = np.abs(at[j, k, :2] - at[j, k, 2:]).sum() > s.space.clip
            if valley or low[j, k] <= s.space.pinch or lower_beside(s.space, low, at, j, k):
                continue
            for i in range(3):
                third = s.fingers(i, j, k, a, b)[(i + 2) % 3]
                point = shapely.Point(third.real, third.imag)
                free = s.solid.distance(point) > 2.0 * s.space.touch
                where, landing = np.empty(4), np.empty(3, np.int64)
                shots = [shoot(s.space, i, j, k, a, b, keep, landing, where) for keep in range(2)]
                if free and max(shots) != NO_TUNNEL:
                    known.append((i, j, k))
    narrow = [row for row in rows if np.abs(at[row[1], row[2], :2] - at[row[1], row[2], 2:]).sum()
              <= s.space.clip]  # fmt: skip
    assert sorted(narrow) == sorted(known)


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
