"""The kernels of jams of point fingers: against hands that are drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.friction.contacts import Contacts
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal
from icage.friction.kernels.jams import _hands_on, _sizes_fit, _within, least_jam
from tests.icage.friction.flat_polygons import ROOM, Flat, fingers_of
from tests.icage.friction.square_pieces import piece_of, square_pieces
from tests.icage.friction.test_cones_of_forces import Z, balances
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")

NO_GOAL = Goal(np.zeros((3, 2)), 0.0, False)

NO_JAM = (1, 2)
"""Seeds without one among the hands drawn."""


@pytest.mark.parametrize("seed", range(10))
def test_hands_are_kept_whose_w_points_into_a_sector(seed: int) -> None:
    rng = np.random.default_rng([seed, 6])
    flat = Flat.drawn(rng, np.append(rng.normal(size=2), 0.5 * rng.normal(size=2)), 1.5)
    sector = np.array([rng.uniform(-np.pi, np.pi), rng.uniform(0.05, 0.5 * np.pi)])
    thick = 0.0 if seed % 2 else 0.1
    polygon = flat.room()
    n = _within(polygon, len(flat.inside), sector, thick, np.empty((ROOM, 4)))
    hands = flat.hands(rng, 300)
    w = (hands[:, 2] + 1j * hands[:, 3]) * np.exp(-1j * sector[0])
    side = np.sin(sector[1]) * w.real - np.cos(sector[1]) * np.abs(w.imag)
    gap = np.minimum(side, w.real) + thick
    assert (n > 0) or gap.max() < 1e-9
    for hand, value in zip(hands, gap, strict=True):
        if n and abs(value) > 1e-9:
            assert flat.holds(polygon[:n], hand) == (value > 0.0)


def contacts_of(sides: Floats, cones: Floats) -> Contacts:
    """All features in one list, as if they were those of piece 0."""
    return Contacts(ptr=np.array([0, len(sides)]), place=sides, cone=cones)


def test_features_that_fit_a_size() -> None:
    sides = np.array([[0.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 4.0]])
    cones = np.zeros((3, 4))

    def fits(least: float, most: float, *chosen: int, thick: float = 0.0) -> bool:
        which, finger = contacts_of(sides, cones), np.array([0, 1])
        one, other = (
            bool(_sizes_fit(Z + [0.7, -0.4], finger, np.array(pair), 2, which, least, most, thick))
            for pair in (chosen, chosen[::-1])
        )
        assert one == other
        return one

    assert fits(3.0, 3.0, 0, 1)
    assert not fits(1.0, 2.9, 0, 1)
    assert not fits(3.1, 9.0, 0, 1)
    assert fits(1.0, 2.5, 0, 1, thick=0.5)
    assert not fits(1.0, 2.4375, 0, 1, thick=0.5)
    assert fits(4.0, 9.0, 0, 1, thick=0.5)
    assert not fits(4.0625, 9.0, 0, 1, thick=0.5)
    sides[2, 2:] = 4.0, 0.0
    assert fits(3.1, 3.1, 0, 2)
    assert not fits(1.0, 2.9, 0, 2)
    assert fits(6.9, 9.0, 0, 2)
    assert not fits(7.1, 9.0, 0, 2)
    sides[2, 2:] = 0.0, 4.0
    middle = math.hypot(3.0, 2.0)
    assert fits(middle + 1.99, 9.0, 0, 2)
    assert not fits(middle + 2.01, 9.0, 0, 2)
    assert fits(0.1, middle - 1.99, 0, 2)
    assert not fits(0.1, middle - 2.01, 0, 2)


class Square:
    """Fingers on sides of the unit square, with the pieces round it."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([seed, 12])
        self.pieces, origin = square_pieces()
        self.sides = np.array([[0.0, 0, 1, 0], [1.0, 0, 0, 1], [0.0, 1, 1, 0], [0.0, 0, 0, 1]])
        self.sides[:, :2] -= origin
        self.inward = np.array([0.5j * np.pi, 1j * np.pi, -0.5j * np.pi, 0.0j])

    def hands(self, first: int, second: int, i: int, j: int, count: int) -> Floats:
        share = self.rng.random((count, 2))
        p, q = self.sides[first], self.sides[second]
        one = (p[0] + share[:, 0] * p[2]) + 1j * (p[1] + share[:, 0] * p[3])
        two = (q[0] + share[:, 1] * q[2]) + 1j * (q[1] + share[:, 1] * q[3])
        z = Z @ [1.0, 1j]
        w = (two - one) / (z[j] - z[i])
        d = one - w * z[i]
        return np.column_stack([d.real, d.imag, w.real, w.imag])

    def depth(self, piece: int, points: Floats) -> Floats:
        s = slice(self.pieces.ptr[piece], self.pieces.ptr[piece + 1])
        v = self.pieces.slot_vertex[s]
        gap = self.pieces.normal_x[s] * (points.real[:, None] - self.pieces.x[v])
        gap = gap + self.pieces.normal_y[s] * (points.imag[:, None] - self.pieces.y[v])
        return gap.min(axis=1)

    def off(self, side: int, points: Floats) -> Floats:
        """How far points are off a side of the square, along it and across."""
        start, way = complex(*self.sides[side, :2]), complex(*self.sides[side, 2:])
        at = (points - start) * np.conj(way)
        return np.max([np.abs(at.imag), -at.real, at.real - 1.0], axis=0)


@pytest.mark.parametrize("seed", range(12))
def test_hands_on_features_with_the_others_in_their_pieces(seed: int) -> None:
    """Two fingers anywhere on their sides, the third in its piece, or on a side as well."""
    s = Square(seed)
    finger = np.sort(s.rng.permutation(3)[: 2 + seed % 2])
    chosen = s.rng.permutation(4)[: len(finger)]
    hands = s.hands(chosen[0], chosen[1], finger[0], finger[1], 300)
    at = fingers_of(hands, Z)
    cell = np.array([piece_of(s.pieces, p) for p in at[0]])
    thick = 0.02
    which = contacts_of(s.sides, np.zeros((4, 4)))
    polygon = np.full((ROOM, 4), np.nan)
    n = _hands_on(
        s.pieces, Z, cell, finger, chosen, len(finger), which, thick, polygon, np.empty((ROOM, 4))
    )
    gap = np.full(300, np.inf)
    for f in range(3):
        if f not in finger:
            gap = np.minimum(gap, s.depth(cell[f], at[:, f]) + thick)
    if len(finger) == 3:
        gap = np.minimum(gap, thick - s.off(chosen[2], at[:, finger[2]]))
    assert (n > 0) or gap.max() < 1e-6
    if n == 0:
        return
    plane = Flat(np.zeros((1, 2)), hands[0], np.array([hands[1] - hands[0], hands[2] - hands[0]]))
    ring = (polygon[:n] - hands[0]) @ np.linalg.pinv(plane.axes)
    turn = np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - ring[:, 1] * np.roll(ring[:, 0], -1))
    for hand, value in zip(hands, gap, strict=True):
        if abs(value) > 1e-6 and abs(turn) > 1e-9:
            found = plane.holds(polygon[:n][:: int(np.sign(turn))], hand, 1e-8)
            assert found == (value > 0.0)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("towards", [False, True])
def test_no_hand_that_jams_is_smaller_or_nearer_than_the_least(seed: int, towards: bool) -> None:
    """Hands on two sides of the square, in one cell or another, whose forces balance."""
    s = Square(seed)
    half = 0.9
    edges = [np.exp(s.inward + 1j * sign * half) for sign in (-1.0, 1.0)]
    cones = np.column_stack([edges[0].real, edges[0].imag, edges[1].real, edges[1].imag])
    first, second = s.rng.permutation(4)[:2]
    i, j = np.sort(s.rng.permutation(3)[:2])
    hands = s.hands(first, second, i, j, 400)
    at = fingers_of(hands, Z)
    cells = np.array([[piece_of(s.pieces, p) for p in row] for row in at[:2]])
    count = len(s.pieces.ptr) - 1
    which = Contacts(
        ptr=2 * np.arange(count + 1), place=np.tile(s.sides[[first, second]], (count, 1)),
        cone=np.tile(cones[[first, second]], (count, 1)),
    )  # fmt: skip
    subsets = np.zeros((1, 3), bool)
    subsets[0, [i, j]] = True
    near = Near(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1e-12)
    spots = at[0] + 0.2 * s.rng.normal(size=3)
    most = float(np.quantile(np.hypot(hands[:, 2], hands[:, 3]), 0.8))
    goal = Goal(np.column_stack([spots.real, spots.imag]), most, True) if towards else NO_GOAL
    levels = np.array([0.0, 1e-3])
    thick = 1e-9
    found = least_jam(s.pieces, Z, cells, levels, which, subsets, near, goal, 1e3, thick)
    size = np.hypot(hands[:, 2], hands[:, 3])
    cost = np.abs(at - spots).max(axis=1) if towards else size
    jams = [
        bool(balances(Z[[i, j]], cones[[first, second]], complex(*h[2:]))
             and (not towards or m <= most)
             and any(min(s.depth(c[f], p[f : f + 1])[0] for f in range(3) if f not in (i, j)) > 0.0
                     for c in cells))
        for h, p, m in zip(hands, at, size, strict=True)
    ]  # fmt: skip
    assert any(jams) or seed in NO_JAM
    if any(jams):
        assert found.sigma <= cost[jams].min() + 1e-6
    if found.sigma == np.inf:
        assert not any(jams)
        assert not found.touches.any()
        return
    assert found.touches.tolist() == subsets[0].tolist()
    spot = fingers_of(found.hand[None], Z)[0]
    known = np.abs(spot - spots).max() if towards else np.hypot(*found.hand[2:])
    assert found.sigma == pytest.approx(known, abs=1e-9)
    on = {first: 0, second: 0}
    for f in (i, j):
        gaps = {q: s.off(q, spot[f : f + 1])[0] for q in on}
        on[min(gaps, key=lambda q: gaps[q])] += 1
        assert min(gaps.values()) < 1e-6
    less = found.sigma * (1.0 - 1e-6)
    none = least_jam(s.pieces, Z, cells, levels, which, subsets, near, goal, less, thick)
    assert none.sigma == np.inf
    late = np.array([found.sigma * 1.1, found.sigma * 1.2])
    if not towards:
        beyond = least_jam(s.pieces, Z, cells, late, which, subsets, near, goal, found.sigma, thick)
        assert beyond.sigma == np.inf
