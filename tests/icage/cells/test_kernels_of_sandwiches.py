"""Where a finger may be in a cell, from inside and outside: by samples and shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.cells.kernels import sandwich as sandwich_module
from icage.cells.kernels.convex_polygon import (
    area,
)
from icage.cells.kernels.cut import boundary_point, cut, other_rows
from icage.cells.kernels.facet import MAX_BASE
from icage.cells.kernels.near import Hand, cells_near
from icage.cells.kernels.region import _covered, all_sandwiches
from icage.cells.kernels.sandwich import CORNERS, sandwich
from tests.icage.cells.setting import Setting
from tests.oracles.geometry import Floats
from tests.oracles.half_planes import least_norm

pytestmark = pytest.mark.usefixtures("plain")


def least_openings(s: Setting, cell: np.ndarray, i: int, points: Floats) -> Floats:
    """Least |w| (n,) that keeps the others in their pieces with finger i at points; inf: none.

    By trying every corner and every foot of the half planes of w.
    """
    rows, level = [], []
    z = s.z @ [1.0, 1j]
    p = s.pieces
    for f in range(3):
        if f == i:
            continue
        u = z[f] - z[i]
        for slot in range(p.ptr[cell[f]], p.ptr[cell[f] + 1]):
            n = complex(p.normal_x[slot], p.normal_y[slot])
            v = p.slot_vertex[slot]
            g = n * np.conj(u)
            rows.append([g.real, g.imag])
            level.append([n.real * p.x[v] + n.imag * p.y[v], n.real, n.imag])
    g, offset = np.array(rows), np.array(level)
    found = np.full(len(points), np.inf)
    for k, q in enumerate(points):
        c = offset[:, 0] - offset[:, 1:] @ q
        found[k] = least_norm(g, c, 1e-9 * s.size)
    return found


def cell_and_start(s: Setting) -> tuple[np.ndarray, Floats, float]:
    """A cell round the target, where finger 2 is in it, and a level above the hand's."""
    hand = Hand(*s.hand[:2], 1.0 * s.hand.w_x, s.hand.w_y)
    cells, _ = cells_near(s.pieces, s.z, hand, 1e-9 * s.size, 10**6)
    cell = cells[s.rng.integers(len(cells))]
    return cell, np.array([s.fingers[1].real, s.fingers[1].imag]), 1.2 * abs(complex(*hand[2:]))


@pytest.mark.parametrize("seed", range(8))
def test_cuts_and_boundary_points_of_where_a_finger_may_be(seed: int) -> None:
    s = Setting(seed, 1.0 if seed % 2 else 25.0)
    cell, start, level = cell_and_start(s)
    rows = np.empty((MAX_BASE, 5))
    n = other_rows(s.pieces, s.z, 1, 2, cell[2], rows, 0)
    n = other_rows(s.pieces, s.z, 1, 0, cell[0], rows, n)
    points = start + 0.5 * s.size * s.rng.normal(size=(25, 2)) * s.rng.random((25, 1))
    sizes = least_openings(s, cell, 1, points)
    more = start + 0.2 * s.size * s.rng.normal(size=(60, 2)) * s.rng.random((60, 1)) ** 2
    held = more[least_openings(s, cell, 1, more) <= level]
    told = [0, 0]
    for p, size in zip(points, sizes, strict=True):
        if abs(size - level) < 1e-6 * s.size:
            continue
        outside, line = cut(rows, n, *p, level)
        assert outside == (size > level)
        told[int(outside)] += 1
        end = boundary_point(rows, n, *start, *p, level, 1e-11 * s.size)
        at = np.array([end.x, end.y])
        assert end.inside == (not outside)
        if not outside:
            assert at.tolist() == p.tolist()
            continue
        assert line.e > 0.0
        assert (line.c_x, line.c_y) == tuple(p)
        for q in held:
            assert line.e + line.g_x * (q[0] - p[0]) + line.g_y * (q[1] - p[1]) <= 1e-8 * s.size
        way = p - start
        t = float((at - start) @ way / (way @ way))
        assert at == pytest.approx(start + t * way, abs=1e-9 * s.size)
        assert 0.0 <= t < 1.0
        inner, outer = least_openings(s, cell, 1, start + np.array([[t - 1e-6], [t + 1e-6]]) * way)
        assert t == 0.0 or inner <= level * (1.0 + 1e-6)
        assert outer >= level * (1.0 - 1e-6)
    assert told[1] > 5


@pytest.mark.parametrize("seed", range(8))
def test_a_sandwich_holds_what_it_says(seed: int) -> None:
    """Corners of the inner polygon are in the set, drawn points of the set are in the outer one,
    and their areas differ by no more than asked."""
    s = Setting(seed, 1.0 if seed % 2 else 25.0)
    cell, start, level = cell_and_start(s)
    inner, outer = np.empty((2, CORNERS)), np.empty((2, CORNERS))
    enough = 1e-5 * s.size**2
    h, m = sandwich(s.pieces, s.z, 1, cell, level, start, enough, inner, outer)
    piece = s.shapes[cell[1]].buffer(1e-9 * s.size)
    points = start + 0.3 * s.size * s.rng.normal(size=(60, 2)) * s.rng.random((60, 1)) ** 2
    points = points[[piece.contains(shapely.Point(p)) for p in points]]
    held = points[least_openings(s, cell, 1, points) <= level * (1.0 - 1e-9)]
    if m < 3:
        assert len(held) <= 1
        return
    around = shapely.Polygon(outer[:, :m].T).buffer(1e-8 * s.size)
    assert all(around.contains(shapely.Point(p)) for p in held)
    corners = inner[:, :h].T
    assert (least_openings(s, cell, 1, corners) <= level * (1.0 + 1e-7)).all()
    assert all(piece.contains(shapely.Point(p)) for p in corners)
    gap = area(*outer, m) - area(*inner, h)
    assert -1e-12 * s.size**2 <= gap <= 1.01 * enough
    if h >= 3:
        assert around.contains(shapely.Polygon(corners))


def test_a_sandwich_that_is_asked_for_little_is_the_start_in_its_piece() -> None:
    s = Setting(1)
    cell, start, level = cell_and_start(s)
    inner, outer = np.full((2, CORNERS), np.nan), np.full((2, CORNERS), np.nan)
    h, m = sandwich(s.pieces, s.z, 1, cell, level, start, 1e6 * s.size**2, inner, outer)
    assert h == 1
    assert inner[:, 0].tolist() == list(start)
    assert outer[:, :m].T.tolist() == s.corners[cell[1]].tolist()


@pytest.mark.parametrize("room", [14, 24])
def test_a_sandwich_has_no_more_corners_than_there_is_room_for(
    room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However little is asked for between its polygons: they are as good as room lets them be."""
    monkeypatch.setattr(sandwich_module, "CORNERS", room)
    most = 0
    for seed in range(8):
        s = Setting(seed)
        cell, start, level = cell_and_start(s)
        inner, outer = np.full((2, room), np.nan), np.full((2, room), np.nan)
        h, m = sandwich(s.pieces, s.z, 1, cell, level, start, 1e-14 * s.size**2, inner, outer)
        most = max(most, h, m)
        assert max(h, m) <= room
        if m < 3:
            continue
        assert (least_openings(s, cell, 1, inner[:, :h].T) <= level * (1.0 + 1e-7)).all()
        if h >= 3:
            around = shapely.Polygon(outer[:, :m].T).buffer(1e-8 * s.size)
            assert around.contains(shapely.Polygon(inner[:, :h].T))
    assert most >= room - 8


def test_sandwiches_that_an_earlier_one_covers_are_left_out() -> None:
    s = Setting(3)
    cells, _ = cells_near(s.pieces, s.z, s.hand, 1e-9, 10**6)
    _, start, level = cell_and_start(s)
    points = np.tile(start, (2 * len(cells), 1))
    once = all_sandwiches(s.pieces, s.z, 1, cells, points, level, 1e-5, 1e-9)
    twice = all_sandwiches(
        s.pieces, s.z, 1, np.concatenate([cells, cells]), points, level, 1e-5, 0.01
    )
    assert len(once.inner_counts) > 0
    assert once.inner_counts.sum() == len(once.inner)
    assert once.outer_counts.sum() == len(once.outer)
    assert len(twice.inner_counts) <= len(once.inner_counts)
    whole, again = (
        shapely.union_all([
            shapely.Polygon(p)
            for p in np.split(one.outer, np.cumsum(one.outer_counts)[:-1])
        ])
        for one in (once, twice)
    )  # fmt: skip
    assert whole.symmetric_difference(again).area < 0.1 * whole.area
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    store = np.concatenate([square[:2], square + 5.0, 2.0 * square - 0.5])
    first, count = np.array([0, 2, 6]), np.array([2, 4, 4])

    def covered(outer: Floats, *held: int, slack: float = 1e-9) -> bool:
        rows = np.array(held, np.int64)
        return _covered(outer.T.copy(), len(outer), store, first, count, rows, len(rows), slack)

    assert covered(square, 0, 1, 2)
    assert not covered(square, 0, 1)
    assert not covered(square)
    assert not covered(square + [0.6, 0.0], 2)
    assert not covered(square - [0.0, 0.6], 2)
    assert covered(square + [0.6, 0.0], 2, slack=0.11)
    assert not covered(square + [0.6, 0.0], 2, slack=0.09)
    assert covered(square + 5.0, 2, 1)
