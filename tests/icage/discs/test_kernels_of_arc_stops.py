"""Arcs split into chords and tangents, points on arcs, and the rings drawn through them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.discs.elements import Elements
from icage.discs.kernels.arc_stops import (
    RESTING,
    OnArcs,
    _graded,
    _put,
    _spoils,
    near_arcs,
    on_arcs,
    parts_of,
    resting_halves,
    ring_with,
    split_arcs,
    stops_between,
    widest_part,
)
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

SEGMENTS = 8
COARSE = 0.5 * math.pi / SEGMENTS


def contacts_on(turn: float, rng: np.random.Generator, count: int) -> Floats:
    """Contacts on an arc, some of them close together, near its ends or twice there."""
    t = rng.uniform(0.0, turn, count)
    t[: count // 3] = t[0] + rng.uniform(-1e-3, 1e-3, count // 3)
    t[-1:] = rng.choice([1e-5, turn - 1e-5, t[0]])
    return t[(t > 0.0) & (t < turn)]


@pytest.mark.parametrize("seed", range(30))
def test_contacts_rest_on_chords_of_their_own(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.uniform(0.05, 3.0)
    contacts = contacts_on(turn, rng, seed % 5 + 1)
    resting, half = resting_halves(turn, contacts)
    assert resting.tolist() == sorted(set(contacts.tolist()))
    for t, h in zip(resting, half, strict=True):
        others = np.abs(resting[resting != t] - t)
        assert h == min([RESTING, t, turn - t, *(others / 3.0)])
        assert h > 0.0
    for touched in (False, True):
        knots = _graded(turn, SEGMENTS, contacts, touched)
        assert knots[0] == 0.0
        assert knots[-1] == turn
        assert (np.diff(knots) > 0.0).all()
        for k, (t, h) in enumerate(zip(resting, half, strict=True)):
            room = min([abs(t - u) for u in np.delete(resting, k)], default=np.inf)
            if len(resting) == 1:
                inside = knots[(knots > t - 0.99 * h) & (knots < t + 0.99 * h)]
                assert inside.tolist() == ([t] if touched else [])
            if room > 3.0 * RESTING and min(t, turn - t) > RESTING:
                assert t - h in knots
                assert t + h in knots
                reach = 3.0 * h  # the next ones are three times as far away
                if reach < min(COARSE, t, turn - t, room / 2.0):
                    assert t - reach in knots
                    assert t + reach in knots
        stops = stops_between(knots, SEGMENTS)
        assert set(knots.tolist()) <= set(stops.tolist())
        assert (np.diff(stops) > 0.0).all()
        assert (np.diff(stops) <= COARSE * (1.0 + 2e-6)).all()


def test_stops_between_knots_are_even() -> None:
    knots = np.array([0.0, 0.1, 0.1 + 2.5 * COARSE, 0.1 + 3.5 * COARSE])
    stops = stops_between(knots, SEGMENTS)
    expected = [0.0, *np.linspace(knots[1], knots[2], 4), knots[3]]
    assert stops.tolist() == expected
    assert [parts_of(t, 2) for t in np.radians([0.0, 30.0, 45.0, 46.0, 90.0])] == [1, 1, 1, 2, 2]
    assert parts_of(math.pi / 2 * (1.0 + 1e-7), 2) == 2  # rounding of a right angle opens it
    assert widest_part(np.array([0.0, 0.3, 1.0]), 2) == 0.5
    assert widest_part(np.empty(0), 2) == 0.0


def test_a_stop_in_the_resting_chord_of_another_contact_is_none() -> None:
    assert not _spoils(0.5012, 2.0, np.array([0.5012]))
    assert not _spoils(0.5004, 2.0, np.array([0.5, 0.502]))  # in that of the nearest, its own
    assert _spoils(0.5007, 2.0, np.array([0.5, 0.5012]))
    assert not _spoils(0.5011, 2.0, np.array([0.5, 0.5012]))
    # near an end of the arc chords are shorter
    assert not _spoils(5e-4, 2.0, np.array([2e-4, 6e-4]))
    assert _spoils(3.9e-4, 2.0, np.array([2e-4, 5e-4]))
    assert not _spoils(2.0 - 5e-4, 2.0, np.array([2.0 - 6e-4, 2.0 - 2e-4]))
    assert _spoils(2.0 - 3.9e-4, 2.0, np.array([2.0 - 5e-4, 2.0 - 2e-4]))


def test_numbers_are_put_in_order_once() -> None:
    rng = np.random.default_rng(1)
    given = rng.integers(0, 12, 40).astype(float)
    ascending = np.full(40, np.nan)
    count = 0
    for t in given:
        count = _put(ascending, count, t)
    assert ascending[:count].tolist() == sorted(set(given.tolist()))


def some_elements(rng: np.random.Generator) -> tuple[Elements, Floats, float]:
    """Arcs and edges that need not close: vertices of a ring, and a radius."""
    count = 30
    ring = rng.normal(size=(12, 2))
    radius = 0.7
    number = rng.integers(0, 12, count)
    angle = rng.uniform(-math.pi, math.pi, count)
    turn = np.where(rng.random(count) < 0.4, 0.0, rng.uniform(0.1, 3.0, count))
    ends = [
        ring[number] + radius * np.column_stack([np.cos(t), np.sin(t)])
        for t in (angle, angle + turn)
    ]
    return Elements(number, *ends, angle, turn), ring, radius


def test_points_on_arcs_and_their_angles() -> None:
    rng = np.random.default_rng(2)
    every, ring, radius = some_elements(rng)
    expected: list[tuple[int, int, float]] = []
    points = []
    for k in range(80):
        e = int(rng.integers(len(every)))
        t = rng.uniform(-0.5, every.turn[e] + 0.5)
        off = radius + rng.choice([0.0, 0.0, 1e-3])
        way = every.angle[e] + t
        points.append(ring[every.number[e]] + off * np.array([math.cos(way), math.sin(way)]))
        for f in np.flatnonzero(every.turn > 0.0):
            to = complex(*(points[k] - ring[every.number[f]]))
            at = np.angle(to * np.exp(-1j * every.angle[f])) % (2.0 * math.pi)
            if abs(abs(to) - radius) < 1e-6 and at < every.turn[f]:
                expected.append((int(f), k, float(at)))
    near = near_arcs(every, ring, radius, np.array(points), 1e-6)
    assert (np.abs(np.hypot(near.way_x, near.way_y) - radius) <= 1e-6).all()
    found = on_arcs(every, near, np.arctan2(near.way_y, near.way_x))
    pairs = list(zip(found.element.tolist(), found.point.tolist(), strict=True))
    assert pairs == sorted((e, k) for e, k, _ in expected)
    assert len(pairs) > len(points) / 3  # more than the first arrays have room for, or nearly
    angle = {(e, k): t for e, k, t in expected}
    assert found.angle == pytest.approx([angle[pair] for pair in pairs], abs=1e-12)
    many = np.repeat(np.array(points[:1]), 2, axis=0)
    assert len(near_arcs(every, ring, radius, many, 10.0).element) == 2 * int(
        (every.turn > 0).sum()
    )
    # the ends of an arc are corners of the curve, and no contact rests there
    ends = np.vstack([every.first, every.last])[[int(np.argmax(every.turn)), -1]]
    at_ends = near_arcs(every, ring, radius, ends, 1e-6)
    own = on_arcs(every, at_ends, np.arctan2(at_ends.way_y, at_ends.way_x))
    assert (int(np.argmax(every.turn)), 0) not in zip(own.element, own.point, strict=True)


def test_chords_and_tangents_of_all_arcs() -> None:
    rng = np.random.default_rng(3)
    every, ring, radius = some_elements(rng)
    arcs = np.flatnonzero(every.turn > 0.0)
    with_contact = arcs[[1, 4, 4]]
    angle = np.array([0.3, 0.45, 0.2]) * every.turn[with_contact]
    on = OnArcs(with_contact, np.arange(3), angle)
    for touched in (False, True):
        over = split_arcs(every.turn, SEGMENTS, on, touched)
        assert over.element.tolist() == sorted(over.element.tolist())
        assert set(over.element.tolist()) <= set(arcs.tolist())
        for e in arcs:
            mine = over.element == e
            if e in with_contact:
                knots = _graded(every.turn[e], SEGMENTS, angle[with_contact == e], touched)
                stops = stops_between(knots, SEGMENTS)
            else:
                parts = math.ceil(every.turn[e] / COARSE - 1e-6)
                stops = np.arange(parts + 1) * (every.turn[e] / parts)
            if touched:
                step = np.diff(stops)
                assert over.angle[mine].tolist() == (stops[:-1] + 0.5 * step).tolist()
                assert over.half[mine].tolist() == (0.5 * step).tolist()
            else:
                assert over.angle[mine].tolist() == stops[1:-1].tolist()
                assert not over.half[mine].any()
        reach = radius / np.cos(over.half)
        way = every.angle[over.element] + over.angle
        drawn = ring_with(every, ring, over.element, np.cos(way), np.sin(way), reach)
        rows: list[list[float]] = []
        for e in range(len(every)):
            rows.append(every.first[e].tolist())
            for k in np.flatnonzero(over.element == e):
                along = np.array([math.cos(way[k]), math.sin(way[k])])
                rows.append((ring[every.number[e]] + reach[k] * along).tolist())
        assert drawn == pytest.approx(np.array(rows), abs=1e-14)
    none = OnArcs(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
    assert len(split_arcs(np.zeros(4), SEGMENTS, none, True).element) == 0
