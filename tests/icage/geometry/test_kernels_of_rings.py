"""Signs that floats are certain of, pieces joined by them, and vertices that carry no corner."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from icage.geometry.kernels.merging import _UNSURE, _corner, _orientation, merge_rings
from icage.kernels.straight import _straight, corners
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def exact_sign(x: Floats, y: Floats, a: int, b: int, c: int) -> int:
    p, q, r = ((Fraction(float(x[k])), Fraction(float(y[k]))) for k in (a, b, c))
    area = (p[0] - r[0]) * (q[1] - r[1]) - (p[1] - r[1]) * (q[0] - r[0])
    return (area > 0) - (area < 0)


def test_a_sign_that_is_told_is_the_exact_one() -> None:
    rng = np.random.default_rng(1)
    told = {-1: 0, 0: 0, 1: 0, _UNSURE: 0}
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
            sign = _orientation(x, y, 0, 1, 2)
            told[sign] += 1
            if sign != _UNSURE:
                assert sign == exact_sign(x, y, 0, 1, 2)
            elif kind != 2:
                assert kind == 1
            if kind == 3:
                assert sign == 0
            if kind == 0:
                assert sign != _UNSURE
    assert min(told.values()) > 5
    # the filter's bound: what is clear by a hundred roundings is told
    x, y = np.array([0.1, 0.7, 0.4]), np.array([0.1, 0.7, 0.4 + 1e-13])
    assert _orientation(x, y, 0, 1, 2) == 1
    assert _orientation(x, y, 1, 0, 2) == -1


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
    assert _corner(line.real.copy(), line.imag.copy(), 0, 1, 2) == _UNSURE


def grid(n: int) -> tuple[Floats, Floats, np.ndarray, np.ndarray]:
    """Squares of a row cut by diagonals: corners, and half edges with their twins."""
    x = np.concatenate([np.arange(n + 1.0)] * 2)
    y = np.repeat([0.0, 1.0], n + 1)
    origin = []
    for k in range(n):
        low, high = k, k + n + 1
        origin += [low, low + 1, high, low + 1, high + 1, high]
    origin = np.array(origin)
    after = np.array([3 * (e // 3) + (e + 1) % 3 for e in range(len(origin))])
    twin = np.full(len(origin), -1)
    ends = {(origin[e], origin[after[e]]): e for e in range(len(origin))}
    for (a, b), e in ends.items():
        twin[e] = ends.get((b, a), -1)
    return x, y, origin, twin


def test_triangles_are_joined_while_they_are_convex_and_small() -> None:
    x, y, origin, twin = grid(3)
    order = np.array([e for e in range(len(twin)) if twin[e] > e])
    vertices, ends, certain = merge_rings(x, y, origin, twin, order, 10)
    assert certain
    assert vertices.tolist() == [0, 1, 2, 3, 7, 6, 5, 4]  # one piece, with its straight corners
    assert ends.tolist() == [8]
    vertices, ends, certain = merge_rings(x, y, origin, twin, order, 4)
    pieces = [p.tolist() for p in np.split(vertices, ends[:-1])]
    assert sorted(len(p) for p in pieces) == [4, 4, 4]
    assert all(p[0] == min(p) for p in pieces)
    assert merge_rings(x, y, origin, twin, order[:0], 10)[1].tolist() == [3, 6, 9, 12, 15, 18]
    y[5] = 0.375  # a notch: what is left of it and what is right of it stay apart
    vertices, ends, certain = merge_rings(x, y, origin, twin, order, 10)
    assert certain
    for piece in np.split(vertices, ends[:-1]):
        for k in range(len(piece)):
            a, b, c = piece[k - 2], piece[k - 1], piece[k]
            assert exact_sign(x, y, a, b, c) >= 0
    assert len(ends) == 2
    x, y, origin, twin = grid(2)
    turned = (x + 1j * y) * np.exp(0.3j)
    x, y = turned.real.copy(), turned.imag.copy()
    assert not merge_rings(x, y, origin, twin, order[order < len(twin)], 10)[2]


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
