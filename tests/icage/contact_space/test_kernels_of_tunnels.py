"""Rays, hands that shrink and tunnel edges of the contact space: against shapely and grids."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from icage.contact_space.kernels.columns import (
    ABOVE,
    BELOW,
    HAND,
    HAND_LEVEL,
    HAND_TOO,
    TUNNEL_BELOW,
    TUNNEL_KEPT,
)
from icage.contact_space.kernels.rectangle import (
    finger_at,
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
from icage.contact_space.kernels.tunnels import all_tunnels, lower_beside, rectangle_minima
from tests.icage.contact_space.setting import Setting

pytestmark = pytest.mark.usefixtures("plain")


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
