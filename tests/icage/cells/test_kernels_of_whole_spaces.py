"""Which cells hold a hand, the largest hand and the escape of a cell, and passes in slivers."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog

from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.columns import Ending
from icage.cells.kernels.escape import _grown, escape_levels, new_memory, shrinkable
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.inhabited import extents_of, inhabited_cells
from icage.cells.kernels.largest import largest_in
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE, min_norm
from icage.cells.kernels.passes import new_room, pass_fast, pass_value
from icage.cells.kernels.search import explore
from icage.cells.kernels.shrink import _blocks
from icage.geometry.exterior import Pieces
from icage.kernels.storage import hash_slot
from tests.icage.cells.setting import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def hand_rows(s: Setting, cell: np.ndarray) -> tuple[Floats, Floats]:
    """Half planes a . (d, w) >= b of the hands of a cell."""
    rows, level = [], []
    for f, piece in enumerate(cell):
        zx, zy = s.z[f]
        for slot in range(s.pieces.ptr[piece], s.pieces.ptr[piece + 1]):
            nx, ny, v = s.pieces.normal_x[slot], s.pieces.normal_y[slot], s.pieces.slot_vertex[slot]
            rows.append([nx, ny, nx * zx + ny * zy, ny * zx - nx * zy])
            level.append(nx * s.pieces.x[v] + ny * s.pieces.y[v])
    return np.array(rows), np.array(level)


@pytest.mark.parametrize("seed", [1, 2])
def test_cells_that_hold_a_hand_are_those_of_a_linear_program(seed: int) -> None:
    s = Setting(seed, 1.0 if seed == 1 else 30.0)
    m = len(s.pieces.ptr) - 1
    extents = extents_of(s.pieces, s.z)
    found = inhabited_cells(s.pieces, extents, 1, 3)
    told = [tuple(c) for c in found.tolist()]
    assert told == sorted(set(told))
    assert {c[0] for c in told} == {1, 2}
    free = [(None, None)] * 4
    for _ in range(60):
        cell = np.array([s.rng.integers(1, 3), *s.rng.integers(0, m, 2)])
        rows, level = hand_rows(s, cell)
        rows, level = np.column_stack([rows, -np.ones(len(rows))]), level
        slack = linprog([0, 0, 0, 0, -1.0], A_ub=-rows, b_ub=-level, bounds=[*free, (None, s.size)])
        room = -float(slack.fun)
        if abs(room) > 1e-4 * s.size:
            assert (tuple(cell.tolist()) in told) == (room > 0.0)
    every = inhabited_cells(s.pieces, extents, 0, m)
    assert [c for c in map(tuple, every.tolist()) if c[0] in (1, 2)] == told


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_hand_of_a_cell_is_at_a_corner(seed: int) -> None:
    """Against all corners of the polytope: four half planes at a time."""
    s = Setting(seed, 1.0 if seed % 2 else 20.0)
    m = len(s.pieces.ptr) - 1
    small = [k for k in range(m) if s.pieces.ptr[k + 1] - s.pieces.ptr[k] <= 4]
    seen, cells, most = 0, [], []
    for _ in range(60):
        cell = s.rng.choice(small, 3)
        rows, level = hand_rows(s, cell)
        chosen = np.array(list(combinations(range(len(rows)), 4)))
        table, right = rows[chosen], level[chosen]
        regular = np.abs(np.linalg.det(table)) > 1e-9
        corner = np.linalg.solve(table[regular], right[regular][..., None])[..., 0]
        held = (corner @ rows.T >= level - 1e-9 * s.size).all(axis=1)
        if not held.any():
            continue
        known = float(np.hypot(corner[held, 2], corner[held, 3]).max())
        found = largest_in(s.pieces, s.z, cell[None], np.inf)
        assert found == pytest.approx(known, rel=1e-5)
        cells.append(cell)
        most.append(found)
        seen += 1
        if seen == 6:
            break
    assert seen >= 3
    table = np.array(cells)
    assert largest_in(s.pieces, s.z, table, np.inf) == max(most)
    enough = 0.5 * most[0]
    assert largest_in(s.pieces, s.z, table, enough) == most[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_escape_levels_of_cells_are_those_of_a_search_from_each(seed: int) -> None:
    s = Setting(seed)
    m = len(s.pieces.ptr) - 1
    args = (s.space.cap, s.space.worst)
    extents = extents_of(s.pieces, s.z)
    every = inhabited_cells(s.pieces, extents, 0, m).astype(np.int64)
    cells = every[s.rng.permutation(len(every))[:14]]
    known = [explore(s.pieces, s.z, c, 0.0, *args, np.inf, 10**6, np.inf) for c in cells]
    levels = np.array([k.level for k in known])
    sigma = np.zeros(len(cells))
    found = escape_levels(s.pieces, s.z, cells, sigma, *args, 10**6, new_memory())
    assert found.levels == pytest.approx(levels)
    again = escape_levels(s.pieces, s.z, cells, sigma, *args, 0, found.memory)
    assert again.levels == pytest.approx(levels)
    # with a sigma above, any level at or below it will do
    high = np.full(len(cells), 1e9)
    some = escape_levels(s.pieces, s.z, cells, high, *args, 0, found.memory)
    assert (some.levels <= 1e9).all()
    assert (some.levels >= levels - 1e-12).all()
    visited = {tuple(c) for k in known for c in k.nodes[:, :3].tolist()}
    keys = found.memory.keys[found.memory.keys >= 0]
    told = set(zip(*(v.tolist() for v in (keys // m // m, keys // m % m, keys % m)), strict=True))
    assert told <= visited
    assert {tuple(c) for c in cells.tolist()} <= told
    for at in np.flatnonzero(found.memory.keys >= 0)[:25]:
        key = found.memory.keys[at]
        assert hash_slot(found.memory.keys, key) == at
        cell = np.array([key // m // m, key // m % m, key % m])
        level = explore(s.pieces, s.z, cell, 0.0, *args, np.inf, 10**6, np.inf).level
        exact, most = found.memory.levels[at]
        assert np.isnan(exact) or exact == pytest.approx(level)
        assert most >= level - 1e-12
    deep = cells[np.argmax([len(k.nodes) for k in known])][None]
    if max(len(k.nodes) for k in known) > 3:
        gave = escape_levels(s.pieces, s.z, deep, np.zeros(1), *args, 1, new_memory())
        assert np.isnan(gave.levels).all()
        assert (gave.memory.keys == -1).all()
        outcome = explore(s.pieces, s.z, deep[0], 0.0, *args, np.inf, 1, np.inf).outcome
        assert outcome == Ending.GAVE_UP


def test_what_is_known_of_cells_grows() -> None:
    keys, levels = new_memory()
    known = {}
    rng = np.random.default_rng(0)
    for key in rng.permutation(10**5)[:400].tolist():
        at = hash_slot(keys, key)
        keys[at], levels[at] = key, (key + 0.25, key + 0.5)
        known[key] = (key + 0.25, key + 0.5)
    more, store = _grown(keys, levels)
    assert len(more) == len(store) == 2 * len(keys)
    assert (more == -1).sum() == len(more) - len(known)
    assert {k: tuple(store[hash_slot(more, k)]) for k in known} == known


def test_hands_in_the_open_can_shrink() -> None:
    s = Setting(1)
    ring = shapely.Polygon(s.ring)
    hands = np.column_stack([s.rng.uniform(-2, 3, (60, 2)), s.rng.normal(size=(60, 2))])
    free = shrinkable(s.pieces, s.z, hands)
    for hand, told in zip(hands, free, strict=True):
        at = complex(*hand[:2]) + complex(*hand[2:]) * (s.z @ [1.0, 1j])
        ends = [(p.real, p.imag) for p in at]
        if any(ring.distance(shapely.Point(p)) < 1e-6 for p in ends):
            continue
        clear = [ring.distance(shapely.LineString([p, q])) > 1e-9 for p, q in combinations(ends, 2)]
        assert told == (sum(clear) >= 2)
    assert 0 < free.sum() < 60


# --------------------------------------------------------------------- slivers


def three_pieces(rings: list[list[tuple[float, float]]]) -> Pieces:
    """Pieces that are not neighbours, counterclockwise."""
    x, y, ptr, slots, normal = [], [], [0], [], []
    for ring in rings:
        first = len(x)
        for k, (a, b) in enumerate(ring):
            c, d = ring[(k + 1) % len(ring)]
            x.append(a)
            y.append(b)
            slots.append(first + k)
            n = np.array([b - d, c - a])
            normal.append(n / np.hypot(*n))
        ptr.append(len(slots))
    none = np.full(len(slots), -1)
    nx, ny = np.array(normal).T.copy()
    return Pieces(
        np.array(x), np.array(y), np.array(ptr), np.array(slots), none, nx, ny,
        np.empty(0, np.int64), np.empty(0, np.int64), 1.0, 1.0,
    )  # fmt: skip


def exact_least(pieces: Pieces, z: Floats, i: int, slot: int) -> Fraction | None:
    """Least |w|^2 on a facet in fractions, by elimination of tau; None if there is none."""
    after = slot + 1 if slot + 1 < pieces.ptr[i + 1] else pieces.ptr[i]

    def at(v: int) -> tuple[Fraction, Fraction]:
        return Fraction(float(pieces.x[v])), Fraction(float(pieces.y[v]))

    p, q = at(pieces.slot_vertex[slot]), at(pieces.slot_vertex[after])
    side = (q[0] - p[0], q[1] - p[1])
    rows = [(Fraction(0), Fraction(0), Fraction(1), Fraction(0)),
            (Fraction(0), Fraction(0), Fraction(-1), Fraction(-1))]  # fmt: skip
    for f in range(3):
        if f == i:
            continue
        u = [Fraction(float(z[f, c])) - Fraction(float(z[i, c])) for c in range(2)]
        first, end = pieces.ptr[f], pieces.ptr[f + 1]
        for t in range(first, end):
            a = at(pieces.slot_vertex[t])
            b = at(pieces.slot_vertex[t + 1 if t + 1 < end else first])
            n = (a[1] - b[1], b[0] - a[0])
            rows.append((u[0] * n[0] + u[1] * n[1], u[0] * n[1] - u[1] * n[0],
                         n[0] * side[0] + n[1] * side[1],
                         n[0] * (a[0] - p[0]) + n[1] * (a[1] - p[1])))  # fmt: skip
    lines = [r for r in rows if r[2] == 0]
    for r in rows:
        for t in rows:
            if r[2] > 0 > t[2]:
                lines.append(tuple(r[2] * b - t[2] * a for a, b in zip(r, t, strict=True)))
    lines = [r for r in lines if r[0] or r[1] or r[3] > 0]
    if any(not r[0] and not r[1] for r in lines):
        return None
    tries = [(Fraction(0), Fraction(0))]
    for a, b, _, c in lines:
        tries.append((a * c / (a * a + b * b), b * c / (a * a + b * b)))
    for r, t in combinations(lines, 2):
        det = r[0] * t[1] - r[1] * t[0]
        if det:
            tries.append(((r[3] * t[1] - t[3] * r[1]) / det, (r[0] * t[3] - t[0] * r[3]) / det))
    held = [w[0] ** 2 + w[1] ** 2 for w in tries
            if all(r[0] * w[0] + r[1] * w[1] >= r[3] for r in lines)]  # fmt: skip
    return min(held) if held else None


@pytest.mark.parametrize("seed", range(24))
def test_a_pass_in_slivers_is_the_exact_one(seed: int) -> None:
    """Pieces as thin as 1e-9, at an angle to each other: doubles would be off by 1e-7."""
    rng = np.random.default_rng([seed, 2])
    z = np.array([[0.0, 0.0], [1.0, 0.0], rng.uniform([0.2, 0.4], [0.7, 1.0])])
    thin = 10.0 ** rng.uniform(-9, -5) if seed % 4 else 0.3
    w, d = complex(*rng.normal(size=2)), complex(*rng.normal(size=2))
    rings = []
    for k in range(3):
        at = d + w * complex(*z[k])
        way = np.exp(1j * rng.uniform(0, 2 * np.pi))
        shape = [at - 0.4 * way, at + (0.5 - 0.3j * thin) * way, at + (0.1 + 0.7j * thin) * way]
        rings.append([(p.real, p.imag) for p in shape])
    pieces = three_pieces(rings)
    cell = np.arange(3)
    met = 0
    for i in range(3):
        for slot in range(pieces.ptr[i], pieces.ptr[i + 1]):
            known = exact_least(pieces, z, i, slot)
            facet = facet_of(pieces, cell, i, slot)
            found = pass_careful(pieces, z, facet, 50.0, 0.0)
            assert (found.status == FOUND) == (known is not None)
            if known is None:
                continue
            met += 1
            sigma = float(known) ** 0.5
            assert np.hypot(found.w_x, found.w_y) == pytest.approx(sigma, rel=1e-14, abs=1e-15)
            value = pass_value(pieces, z, facet, 50.0, 1e-12, new_room())
            assert value.sigma == pytest.approx(sigma, abs=2e-12)
            fast = pass_fast(pieces, z, facet, 50.0, 1e-12, new_room())
            if fast.status == FOUND:
                assert np.hypot(fast.w_x, fast.w_y) == pytest.approx(sigma, abs=2e-12)
            if sigma > 1e-6:
                low = pass_careful(pieces, z, facet, sigma * (1.0 - 1e-9), 0.0)
                beyond = low.status == FOUND and np.hypot(low.w_x, low.w_y) > sigma * (1 - 1e-9)
                assert low.status == INFEASIBLE or beyond
                wider = pass_careful(pieces, z, facet, 50.0, 1e-3)
                assert np.hypot(wider.w_x, wider.w_y) <= sigma
    assert met >= 2


def test_a_passage_of_no_width_is_open_and_one_less_is_not() -> None:
    """Two fingers in one place, the one on or above y = 0, the other on or below y = -gap."""
    z = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    base = [(0.5, -1.0), (1.0, 0.0), (0.0, 0.0)]
    up = [(-5.0, 0.0), (5.0, 0.0), (0.0, 9.0)]
    for gap, is_open in ((0.0, True), (1e-15, True), (1.0e-14, True), (1e-12, False)):
        low = [(-5.0, -gap), (0.0, -9.0), (5.0, -gap)]
        pieces = three_pieces([base, up, low])
        facet = facet_of(pieces, np.arange(3), 0, 1)
        assert (pass_value(pieces, z, facet, 50.0, 1e-12, new_room())[0] < np.inf) == is_open


@pytest.mark.parametrize("height", [0.3, -1.7, 0.1])
def test_edges_in_one_line_touch_exactly(height: float) -> None:
    """Of many lengths, parallel to the segment: no rounding of a normal parts or joins them."""
    z = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    base = [(0.5, -5.0), (1.0, 0.0), (0.0, 0.0)]
    for a in (0.7, 3.1, 5.3, 9.9):
        for b in (0.6, 2.3, 6.1, 7.7):
            up = [(-a, height), (a + 0.1, height), (0.0, 9.0)]
            low = [(-b, height), (0.0, -9.0), (b + 0.3, height)]
            pieces = three_pieces([base, up, low])
            facet = facet_of(pieces, np.arange(3), 0, 1)
            found = pass_careful(pieces, z, facet, 50.0, 0.0)
            assert found.status == FOUND
            assert found.w_y == pytest.approx(height, rel=1e-15)
            below = np.nextafter(height, -9.0)
            apart = [(-b, below), (0.0, -9.0), (b + 0.3, below)]
            pieces = three_pieces([base, up, apart])
            assert pass_careful(pieces, z, facet, 50.0, 0.0).status == INFEASIBLE


def test_a_corner_is_trusted_as_far_as_its_errors_allow() -> None:
    """The errors of both rows, by their shares of |w| and by the wedge: both within ``worst``."""
    rng = np.random.default_rng(6)
    told = [0, 0]
    for _ in range(80):
        angle = rng.uniform(0, 2 * np.pi)
        spread, turn = rng.uniform(0.2, 1.3), rng.uniform(0.1, 0.9)
        a, b = (np.array([np.cos(t), np.sin(t)]) for t in (angle, angle + spread))
        u = (1 - turn) * a + turn * b
        u /= np.hypot(*u)
        w = 0.7 * u
        share = np.linalg.solve(np.column_stack([a, b]), u)
        worst = 1e-10
        room = np.pi - spread
        limit = worst / max(share.sum(), 1.0 / np.sin(min(0.5 * room, 1.5)))
        for error, known in ((0.99 * limit, FOUND), (1.01 * limit, UNSURE)):
            rows = np.array([[*a, a @ w, error, error], [*b, b @ w, error, error]])
            assert min_norm(rows, 2, worst).status == known
            told[int(known == FOUND)] += 1
        # the error of the one row only
        off = 0.99 * worst / share[1] / 10.0
        one = np.array([[*a, a @ w, 1e-14, 1e-14], [*b, b @ w, off, off]])
        assert min_norm(one, 2, worst).status == FOUND
        # what is no rounding moves no value
        one[1, 3] *= 100.0
        assert min_norm(one, 2, worst).status == FOUND
    assert min(told) == 80


# --------------------------------------------------------------------- what is just touched


def wall(px: float, py: float, qx: float, qy: float) -> Pieces:
    none = np.empty(0)
    index = np.array([0, 1])
    return Pieces(
        np.array([px, qx]), np.array([py, qy]), np.array([0]), index, index, none, none,
        np.array([0]), np.array([1]), 1.0, 1.0,
    )  # fmt: skip


def test_a_wall_bars_a_segment_that_it_comes_nearer_than_the_tolerance() -> None:
    """Numbers that floats have exactly: what is off by just the tolerance is not clear of it."""
    tol = 0.25

    def bars(p: tuple[float, float], q: tuple[float, float]) -> bool:
        """A segment from (0, 0) to (4, 0)."""
        return bool(_blocks(wall(*p, *q), 0, 0.0, 0.0, 4.0, 0.0, 4.0, tol))

    assert bars((2.0, -1.0), (2.0, 1.0))
    assert bars((2.0, 1.0), (2.0, -1.0))
    assert not bars((2.0, 0.5), (2.0, 2.0))
    assert not bars((2.0, -2.0), (2.0, -0.5))
    assert bars((2.0, 0.25), (2.0, 2.0))  # its end is off by just the tolerance
    assert bars((2.0, -2.0), (2.0, -0.25))
    assert not bars((2.0, 0.3125), (2.0, 2.0))
    assert not bars((5.0, -1.0), (5.0, 1.0))  # beyond the end
    assert bars((4.125, 1.0), (4.125, -1.0)) != bars((4.125, -1.0), (4.125, 1.0))
    assert not bars((-1.0, 1.0), (-1.0, -1.0))
    # an end on the wall, on its free side, is no bar; behind it, it is
    assert not bars((0.0, 1.0), (0.0, -1.0)) or not bars((0.0, -1.0), (0.0, 1.0))
    assert bars((0.0, 1.0), (0.0, -1.0)) or bars((0.0, -1.0), (0.0, 1.0))
    # along the wall, on it and a little behind
    assert not bars((-1.0, 0.0), (5.0, 0.0))
    assert not bars((5.0, 0.0), (-1.0, 0.0))
    assert not bars((-1.0, 0.125), (5.0, 0.125))
    assert bars((1.0, 0.25), (3.0, 0.25))
