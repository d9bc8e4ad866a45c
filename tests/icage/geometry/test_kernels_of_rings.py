"""Signs that floats are certain of, pieces joined by them, and vertices that carry no corner."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from icage.geometry.convex import _joined_exactly
from icage.geometry.kernels.merging import (
    GONE,
    UNSURE,
    Mesh,
    _corner,
    half_edges,
    join_triangles,
    ring_by_ring,
    sign_of_turn,
)
from icage.kernels.straight import _straight, corners, sharpest
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def exact_sign(x: Floats, y: Floats, a: int, b: int, c: int) -> int:
    p, q, r = ((Fraction(float(x[k])), Fraction(float(y[k]))) for k in (a, b, c))
    area = (p[0] - r[0]) * (q[1] - r[1]) - (p[1] - r[1]) * (q[0] - r[0])
    return (area > 0) - (area < 0)


def test_a_sign_that_is_told_is_the_exact_one() -> None:
    rng = np.random.default_rng(1)
    told = {-1: 0, 0: 0, 1: 0, UNSURE: 0}
    for kind in range(4):
        for _ in range(60):
            x, y = rng.normal(size=(2, 3))
            if kind == 1:  # nearly on a line
                t = rng.random()
                x[2], y[2] = x[0] + t * (x[1] - x[0]), y[0] + t * (y[1] - y[0])
            if kind == 2:
                x, y = np.round(3 * x), np.round(3 * y)
            if kind == 3:
                x[:] = x[0]
            sign = sign_of_turn(x, y, 0, 1, 2)
            told[sign] += 1
            if sign != UNSURE:
                assert sign == exact_sign(x, y, 0, 1, 2)
            elif kind != 2:
                assert kind == 1
            if kind == 3:
                assert sign == 0
            if kind == 0:
                assert sign != UNSURE
    assert min(told.values()) > 5
    # the filter's bound: what is clear by a hundred roundings is told
    x, y = np.array([0.1, 0.7, 0.4]), np.array([0.1, 0.7, 0.4 + 1e-13])
    assert sign_of_turn(x, y, 0, 1, 2) == 1
    assert sign_of_turn(x, y, 1, 0, 2) == -1


@pytest.mark.parametrize("turn", range(4))
def test_a_corner_turns_left_or_goes_on_or_does_not(turn: int) -> None:
    """Also where edges lie along an axis, and where they come back."""
    way = np.array([1.0, 1j, -1.0, -1j])[turn]
    at = np.array([0.0, 2.0, 5.0, 1.0, 2.0 + 1j, 2.0 - 1j, 2.0]) * way
    x, y = at.real.copy(), at.imag.copy()
    assert _corner(x, y, 0, 1, 4) == 1
    assert _corner(x, y, 0, 1, 5) == 0
    assert _corner(x, y, 0, 1, 2) == 1
    assert _corner(x, y, 0, 1, 3) == 0
    line = np.array([0.1 + 0.1j, 0.3 + 0.3j, 0.7 + 0.7j]) * way
    assert _corner(line.real.copy(), line.imag.copy(), 0, 1, 2) == UNSURE


def grid(n: int) -> tuple[Floats, Floats, np.ndarray]:
    """Squares of a row cut by diagonals: corners, and the triangles' corners three by three."""
    x = np.concatenate([np.arange(n + 1.0)] * 2)
    y = np.repeat([0.0, 1.0], n + 1)
    origin = []
    for k in range(n):
        low, high = k, k + n + 1
        origin += [low, low + 1, high, low + 1, high + 1, high]
    return x, y, np.array(origin)


def directed(origin: np.ndarray) -> list[tuple[int, int]]:
    """Start and end of every half edge of triangles."""
    corner = origin.reshape(-1, 3)
    after = np.roll(corner, -1, axis=1).ravel()
    return list(zip(origin.tolist(), after.tolist(), strict=True))


def pieces(after: np.ndarray, mesh: Mesh, origin: np.ndarray, fixed: int) -> list[list[int]]:
    edges, ptr = ring_by_ring(after, mesh.ranked, fixed)
    return [origin[edges[a:b]].tolist() for a, b in pairwise(ptr)]


def test_half_edges_know_each_other_and_the_longest_diagonal_is_first() -> None:
    rng = np.random.default_rng(2)
    for n in (1, 2, 7):
        x, y, origin = grid(n)
        x += 0.3 * rng.random(len(x))
        shuffled = rng.permutation(origin.reshape(-1, 3))
        origin = np.concatenate([np.roll(t, rng.integers(3)) for t in shuffled])
        ends = directed(origin)
        where = {pair: e for e, pair in enumerate(ends)}
        for fixed in (0, 3, len(origin)):
            mesh = half_edges(x, y, origin, fixed)
            assert mesh.simple
            assert mesh.twin.tolist() == [where.get((b, a), -1) for a, b in ends]
            assert [ends[e] for e in mesh.ranked] == sorted(ends)
            shared = [e for e, f in enumerate(mesh.twin.tolist()) if e < f < fixed]
            assert sorted(mesh.diagonals.tolist()) == shared
            side = [
                np.hypot(x[a] - x[b], y[a] - y[b]) for a, b in (ends[e] for e in mesh.diagonals)
            ]
            assert side == sorted(side, reverse=True)
    x, y, origin = grid(1)
    twice = np.concatenate([origin, [1, 2, 3]])
    assert not half_edges(x, y, twice, 9).simple
    x, y, origin = grid(3)  # equally long ones in the order of their numbers
    mesh = half_edges(x, y, origin, len(origin))
    assert mesh.diagonals.tolist() == [1, 7, 13, 3, 9]


def test_triangles_are_joined_while_they_are_convex_and_small() -> None:
    x, y, origin = grid(3)
    mesh = half_edges(x, y, origin, 18)
    after, certain = join_triangles(x, y, origin, mesh, 10)
    assert certain
    # one piece, with its straight corners
    assert pieces(after, mesh, origin, 18) == [[0, 1, 2, 3, 7, 6, 5, 4]]
    assert sum(after == GONE) == 10
    after, certain = join_triangles(x, y, origin, mesh, 4)
    found = pieces(after, mesh, origin, 18)
    assert [len(p) for p in found] == [4, 4, 4]
    assert all(p[0] == min(p) for p in found)
    assert found == sorted(found)
    plain = join_triangles(x, y, origin, mesh, 3)[0]
    assert pieces(plain, mesh, origin, 18) == sorted(pieces(plain, mesh, origin, 18))
    assert pieces(plain, mesh, origin, 0) == origin.reshape(-1, 3).tolist()
    fans = half_edges(x, y, origin, 12)  # the last square stays as it is
    after, certain = join_triangles(x, y, origin, fans, 10)
    assert pieces(after, fans, origin, 12) == [[0, 1, 2, 6, 5, 4], [2, 3, 6], [3, 7, 6]]
    y[5] = 0.375  # a notch: what is left of it and what is right of it stay apart
    mesh = half_edges(x, y, origin, 18)
    after, certain = join_triangles(x, y, origin, mesh, 10)
    assert certain
    found = pieces(after, mesh, origin, 18)
    for piece in found:
        for k in range(len(piece)):
            a, b, c = piece[k - 2], piece[k - 1], piece[k]
            assert exact_sign(x, y, a, b, c) >= 0
    assert len(found) == 2


def test_what_a_float_cannot_tell_is_joined_exactly() -> None:
    x, y, origin = grid(2)
    turned = (x + 1j * y) * np.exp(0.3j)
    x, y = turned.real.copy(), turned.imag.copy()
    mesh = half_edges(x, y, origin, 12)
    assert not join_triangles(x, y, origin, mesh, 10)[1]
    found = pieces(_joined_exactly(x, y, origin, mesh, 10), mesh, origin, 12)
    assert sum(len(p) - 2 for p in found) == 4
    for piece in found:
        for k in range(len(piece)):
            assert exact_sign(x, y, piece[k - 2], piece[k - 1], piece[k]) >= 0
    x, y, origin = grid(3)
    mesh = half_edges(x, y, origin, 18)  # where floats are certain both are the same
    exactly = _joined_exactly(x, y, origin, mesh, 6)
    assert exactly.tolist() == join_triangles(x, y, origin, mesh, 6)[0].tolist()


def test_a_run_of_vertices_is_straight_to_within_a_bound() -> None:
    """Numbers that floats have exactly: off by just the bound is still straight."""
    x = np.array([0.0, 1.0, 2.0, 4.0, 4.0])
    y = np.array([0.0, 0.25, -0.25, 0.0, 3.0])
    assert _straight(x, y, 0, 1, 3, 0.25)
    assert not _straight(x, y, 0, 1, 3, 0.2)
    assert not _straight(x, y, 0, 1, 4, 0.25)
    assert _straight(x, y, 0, 1, 1, 0.0)
    back = np.array([0.0, 2.0, 1.75, 4.0, 4.0])
    assert _straight(back, y, 0, 1, 3, 0.25)
    assert not _straight(np.array([0.0, 2.0, 1.5, 4.0, 4.0]), y, 0, 1, 3, 0.25)
    end = np.array([0.0, 1.0, 4.25, 4.0, 0.0])  # the last vertex lies before the one in front of it
    assert _straight(end, np.zeros(5), 0, 1, 3, 0.25)
    assert not _straight(np.array([0.0, 1.0, 4.5, 4.0, 0.0]), np.zeros(5), 0, 1, 3, 0.25)
    closed = np.array([0.0, 0.125, 0.25, 0.0, 0.0])
    assert _straight(closed, np.zeros(5), 0, 1, 3, 0.25)
    assert not _straight(np.array([0.0, 0.5, 0.25, 0.0, 0.0]), np.zeros(5), 0, 1, 3, 0.25)


def test_vertices_that_are_kept() -> None:
    ring = np.array(
        [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1], [3, 2], [1.5, 2], [0, 2], [0, 1]], float
    )
    for begin in (0, 3):
        keep = corners(*ring.T.copy(), begin, 1e-9)
        assert np.flatnonzero(keep).tolist() == [0, 3, 5, 7]
    again = np.roll(ring, 4, axis=0)
    assert np.flatnonzero(corners(*again.T.copy(), 4, 1e-9)).tolist() == [0, 2, 4, 7]
    ring[1, 1] = 0.125
    assert np.flatnonzero(corners(*ring.T.copy(), 0, 0.125)).tolist() == [0, 3, 5, 7]
    assert 1 in np.flatnonzero(corners(*ring.T.copy(), 0, 0.0625))


def test_the_sharpest_vertex_and_whether_all_are_kept() -> None:
    ring = np.array([[0, 0], [2, 0], [3, 0.5], [3, 2], [0, 2]], float)
    x, y = ring.T.copy()
    begin, every = sharpest(x, y, 1e-9)
    area = [
        abs(np.linalg.det([ring[k - 4] - ring[k - 1], ring[k] - ring[k - 1]])) for k in range(5)
    ]
    assert every
    assert begin == int(np.argmax(area))
    low = np.array([[0, 0], [2, 0], [3, 0.125], [3, 2], [0, 2]], float)
    off = 0.25 / np.hypot(3.0, 0.125)  # of vertex 1 from its neighbours' chord
    assert sharpest(*low.T.copy(), 0.99 * off)[1]
    assert not sharpest(*low.T.copy(), 1.01 * off)[1]
    short = np.array([[0, 0], [2, 0], [2.5, 0.5], [3, 2], [0, 2]], float)
    edge = np.hypot(0.5, 0.5)
    assert not sharpest(*short.T.copy(), 1.0001 * edge)[1]
    # back along its own edge: no area, and yet a corner
    spike = np.array([[0, 0], [4, 0], [2, 0], [2, 2]], float)
    assert sharpest(*spike.T.copy(), 0.25)[1]
    onward = np.array([[0, 0], [2, 0], [4, 0], [2, 2]], float)
    assert not sharpest(*onward.T.copy(), 0.25)[1]
    # none of the two ends of a short edge begins
    twin = np.array([[0, 0], [5, 0], [5, 1e-12], [5, 3], [0, 2]], float)
    begin, every = sharpest(*twin.T.copy(), 1e-9)
    assert not every
    assert begin == 3
