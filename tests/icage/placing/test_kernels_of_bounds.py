"""Bounds on the clearance of a box of hands: against hands drawn from it and scipy's programs."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog

from icage.cells.free_space import FreeSpace
from icage.hand import HandShape
from icage.outline import Outline
from icage.placing.best import _edges
from icage.placing.kernels.boxes import (
    EACH,
    _nearest_few,
    bend,
    clearance,
    displacement,
    distance_rows,
    in_cell,
    misses_cell,
    piece_rows,
    place_finger,
)
from icage.placing.kernels.edges import NearEdges, distance_to_edge, near_edges, nearest
from icage.placing.kernels.polish import capped, level_row, polish
from icage.placing.kernels.program import Program, most_of_least, new_program
from icage.placing.kernels.search import Asked, Room, _root, _support, _widest, deepest
from tests.oracles.geometry import Floats
from tests.oracles.targets import random_target

pytestmark = pytest.mark.usefixtures("plain")


class Setting:
    """A random object with its pieces, edges and the arms of a hand round it."""

    def __init__(self, seed: int, size: float = 1.0) -> None:
        self.rng = rng = np.random.default_rng([seed, 17])
        target = random_target(rng, ["star", "random", "lattice", "tool"][seed % 4])
        outline = Outline(size * target.vertices)
        hand = HandShape.from_contacts(size * target.contacts)
        self.space = space = FreeSpace.around(outline, hand)
        self.pieces, self.z, self.size = space.pieces, space.z, outline.diameter
        ring = outline.vertices - space.origin
        self.edges = _edges(ring)
        self.near: NearEdges = near_edges(self.pieces, self.edges)
        self.ring = shapely.LinearRing(ring)
        self.arm = self.z - self.z.mean(axis=0)
        at = size * target.contacts - space.origin
        w = (at[1] - at[0]) @ [1.0, 1j]
        self.hand = np.array([*at.mean(axis=0), np.angle(w), abs(w)])

    def box(self, share: float) -> tuple[Floats, Floats]:
        """A box round a hand that is a bit wider open than the grasp: middle and half widths."""
        middle = self.hand * [1, 1, 1, 1.15] + 0.02 * self.size * self.rng.normal(size=4)
        half = share * self.rng.uniform(0.2, 1.0, 4) * [self.size, self.size, 2.0, self.size]
        half[3] = min(half[3], 0.9 * middle[3])
        return middle, half

    def fingers(self, hands: Floats) -> Floats:
        """(n, 3) complex."""
        d, w = hands[:, 0] + 1j * hands[:, 1], hands[:, 3] * np.exp(1j * hands[:, 2])
        return d[:, None] + w[:, None] * (self.arm @ [1.0, 1j])

    def gaps(self, hands: Floats) -> Floats:
        """(n, 3) distances of the fingers from the outline, negative inside the object."""
        at = shapely.points(self.fingers(hands).real, self.fingers(hands).imag)
        inside = shapely.contains(shapely.Polygon(self.ring), at)
        return np.where(inside, -1.0, 1.0) * shapely.distance(self.ring, at)

    def depth(self, piece: int, points: Floats) -> Floats:
        """How far inside a piece's half planes points (n,), complex, are."""
        s = slice(self.pieces.ptr[piece], self.pieces.ptr[piece + 1])
        v = self.pieces.slot_vertex[s]
        nx, ny = self.pieces.normal_x[s], self.pieces.normal_y[s]
        x, y = self.pieces.x[v], self.pieces.y[v]
        gap = nx * (points.real[:, None] - x) + ny * (points.imag[:, None] - y)
        return gap.min(axis=1)

    def cell(self, hand: Floats) -> np.ndarray:
        """The pieces that hold the fingers of a hand, the deepest each."""
        m = len(self.pieces.ptr) - 1
        at = self.fingers(hand[None])[0]
        return np.array([int(np.argmax([self.depth(k, p[None])[0] for k in range(m)])) for p in at])

    def asked(self, share: float = 0.0) -> Asked:
        return Asked(
            self.arm, self.edges, self.near, 0.01 * self.size, self.size, 0.5 * self.hand[3],
            1.5 * self.hand[3], 1.4 * self.hand[3], share, 1e-3, 1e-9 * self.size,
        )  # fmt: skip


def hands_of(middle: Floats, half: Floats, rng: np.random.Generator, count: int) -> Floats:
    """Drawn from a box, its corners among them."""
    at = rng.uniform(-1.0, 1.0, (count, 4))
    corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 4)).reshape(4, -1).T
    return middle + half * np.concatenate([corners, at])


@pytest.mark.parametrize("seed", range(6))
def test_fingers_get_no_further_in_a_box_and_bend_no_more(seed: int) -> None:
    s = Setting(seed)
    for share in (0.02, 0.2, 1.6):
        middle, half = s.box(share)
        hands = hands_of(middle, half, s.rng, 200)
        at, centre = s.fingers(hands), s.fingers(middle[None])[0]
        out = np.empty(4)
        for k in range(3):
            place_finger(s.arm, k, middle, out)
            assert complex(*out[:2]) == pytest.approx(centre[k], abs=1e-12)
            turned = np.exp(1j * middle[2]) * complex(*s.arm[k])
            assert complex(*out[2:]) == pytest.approx(turned, abs=1e-12)
            far = np.abs(at[:, k] - centre[k]).max()
            assert far <= displacement(s.arm, k, middle, half) * (1.0 + 1e-12)
            change = hands - middle
            linear = (
                centre[k] + change[:, 0] + 1j * change[:, 1]
                + turned * (change[:, 3] + 1j * middle[3] * change[:, 2])
            )  # fmt: skip
            off = np.abs(at[:, k] - linear).max()
            assert off <= bend(s.arm, k, middle, half) * (1.0 + 1e-9)
            if share < 0.1:
                assert far >= 0.6 * displacement(s.arm, k, middle, half)
                assert off >= 0.5 * bend(s.arm, k, middle, half)
    still = np.array([0.3, 0.4, 0.0, 0.0])
    assert displacement(s.arm, 0, middle, still) == pytest.approx(0.5)
    length = math.hypot(*s.arm[1])
    turn = np.array([0.0, 0.0, 9.0, 0.25])
    assert displacement(s.arm, 1, middle, turn) == pytest.approx(length * (2 * middle[3] + 0.25))
    assert bend(s.arm, 1, middle, still) == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_edges_near_a_piece_hold_the_nearest_of_all_its_points(seed: int) -> None:
    s = Setting(seed)
    n = len(s.edges)
    x, y = s.pieces.x, s.pieces.y
    for k in range(len(s.pieces.ptr) - 1):
        v = s.pieces.slot_vertex[s.pieces.ptr[k] : s.pieces.ptr[k + 1]]
        share = s.rng.dirichlet(np.full(len(v), 0.5), 12)
        points = share @ np.column_stack([x[v], y[v]])
        for p in points:
            gap = s.ring.distance(shapely.Point(p))
            assert nearest(s.edges, s.near, k, *p) == pytest.approx(gap, abs=1e-9 * s.size)
            assert gap <= s.near.most[k] + 1e-12
        of_corners = max(s.ring.distance(shapely.Point(x[a], y[a])) for a in v)
        assert of_corners <= s.near.most[k] + 1e-12
        items = slice(s.near.start[k], s.near.start[k + 1])
        corners = (x[v] + 1j * y[v])[:, None]
        start = s.edges[:, 0] + 1j * s.edges[:, 1]
        way = s.edges[:, 2] + 1j * s.edges[:, 3]
        ahead = (((corners - start) * np.conj(way)).imag <= 1e-9).all(axis=0)
        assert s.near.ahead[items].tolist() == ahead[s.near.items[items]].tolist()
        furthest = [max(distance_to_edge(s.edges, e, x[a], y[a]) for a in v) for e in range(n)]
        assert s.near.most[k] == pytest.approx(min(furthest))
        middle = np.array([x[v].mean(), y[v].mean()])
        reach = max(math.dist(middle, (x[a], y[a])) for a in v)
        own = [distance_to_edge(s.edges, e, *middle) - reach for e in range(n)]
        assert s.near.items[items].tolist() == [e for e in range(n) if own[e] <= min(furthest)]
    last = len(s.pieces.ptr) - 1
    assert s.near.items[s.near.start[last] : s.near.start[last + 1]].tolist() == list(range(n))


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_few_are_those_that_may_bound_a_distance(seed: int) -> None:
    s = Setting(seed)
    pick = np.empty((EACH, 2))
    last = len(s.pieces.ptr) - 1
    for reach in (0.01, 0.1, 10.0):
        p = s.fingers(s.hand[None])[0, 0] + 0.1 * complex(*s.rng.normal(size=2))
        count = _nearest_few(s.edges, s.near, last, np.array([p.real, p.imag]), reach, pick)
        apart = np.array(
            [distance_to_edge(s.edges, e, p.real, p.imag) for e in range(len(s.edges))]
        )
        known = np.sort(apart)[:EACH]
        known = known[known <= known[0] + 2.0 * reach]
        assert pick[:count, 0].tolist() == known.tolist()
        for gap, at in pick[:count]:
            assert apart[s.near.items[int(at)]] == gap


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("share", [0.01, 0.15])
def test_no_hand_of_a_box_exceeds_the_rows(seed: int, share: float) -> None:
    """Every counting row bounds a distance, every other one holds, for hands with all fingers in
    the cell's pieces; in a small box the least row is what the middle has."""
    s = Setting(seed, 1.0 if seed % 2 else 20.0)
    middle, half = s.box(share)
    half[:] *= [1, 1, 1, 1] if seed % 3 else [1, 1, 0.0, 1]
    cell = s.cell(middle)
    program = new_program(200)
    finger, pick = np.empty(4), np.empty((EACH, 2))
    radius = 0.01 * s.size
    args = (s.arm, middle, half, finger)
    hands = hands_of(middle, half, s.rng, 300)
    at = s.fingers(hands)
    depth = np.min([s.depth(cell[k], at[:, k]) for k in range(3)], axis=0)
    if misses_cell(s.pieces, cell, *args):
        assert depth.max() < 0.0
    told = [in_cell(s.pieces, cell, s.arm, h, finger, 0.01 * s.size) for h in hands]
    assert told == (depth >= -0.01 * s.size).tolist()
    rows = distance_rows(
        program, 0, s.edges, s.near, cell, s.arm, radius, middle, half, False, finger, pick
    )
    more = piece_rows(program, rows, s.pieces, cell, s.arm, middle, half, finger)
    assert program.counts[:rows].tolist() == [1.0] * rows
    assert program.counts[rows:more].tolist() == [0.0] * (more - rows)
    x = np.divide(hands - middle, half, out=np.zeros_like(hands), where=half > 0.0)
    value = program.offset[:more] + x @ program.slope[:more].T
    inside = depth >= 0.0
    gaps = np.abs(s.gaps(hands[:60]))
    clear = gaps.min(axis=1) - radius
    tiny = 1e-9 * s.size
    assert (value[:60, :rows].min(axis=1) >= clear - tiny)[inside[:60]].all()
    assert (value[:, rows:] >= -tiny)[inside].all()
    for h, known in zip(hands[:20], gaps[:20], strict=True):
        every = np.full(3, len(s.pieces.ptr) - 1)
        found = clearance(s.edges, s.near, every, s.arm, radius, h, finger)
        assert found == pytest.approx(known.min() - radius, abs=tiny)
    off = max(bend(s.arm, k, middle, half) for k in range(3))
    reach = max(displacement(s.arm, k, middle, half) for k in range(3))
    here = s.gaps(middle[None])[0]
    least = program.offset[:rows].min()
    assert here.min() < 0.0 or least >= here.min() - radius - tiny
    if here.min() > 4.0 * reach:
        assert least <= here.min() - radius + off + reach * reach / here.min() + tiny


@pytest.mark.parametrize("seed", range(6))
def test_exact_rows_are_the_distances_and_their_slopes(seed: int) -> None:
    s = Setting(seed)
    middle, _ = s.box(0.0)
    middle[3] *= 1.2
    half = 1e-6 * np.array([1.0, 2.0, 3.0, 4.0])
    cell, finger, pick = s.cell(middle), np.empty(4), np.empty((EACH, 2))
    if misses_cell(s.pieces, cell, s.arm, middle, half, finger):
        return
    program = new_program(60)
    rows = distance_rows(
        program, 0, s.edges, s.near, cell, s.arm, 0.02, middle, half, True, finger, pick
    )
    steps = middle + half * np.concatenate([np.eye(4), -np.eye(4)])
    known = []
    for k in range(3):

        def apart(h: Floats, k: int = k) -> float:
            p = s.fingers(h[None])[0, k]
            return float(s.ring.distance(shapely.Point(p.real, p.imag)))

        rise = [apart(h) for h in steps]
        known.append((apart(middle) - 0.02, 0.5 * (np.array(rise[:4]) - rise[4:])))
    for offset, slope in known:
        off = np.abs(program.offset[:rows] - offset)
        nearest_row = int(np.argmin(off))
        assert off[nearest_row] < 1e-9
        assert program.slope[nearest_row] == pytest.approx(slope, abs=1e-9)


def scipys(program: Program, rows: int) -> float:
    """The largest least of the counting rows while the others are not negative, -inf: none."""
    a, b, counts = program.slope[:rows], program.offset[:rows], program.counts[:rows]
    found = linprog(
        [0, 0, 0, 0, -1.0], A_ub=np.column_stack([-a, counts]), b_ub=b,
        bounds=[(-1.0, 1.0)] * 4 + [(None, None)],
    )  # fmt: skip
    return -np.inf if found.status == 2 else -float(found.fun)


@pytest.mark.parametrize("seed", range(40))
def test_the_most_of_the_least_is_that_of_scipys_program(seed: int) -> None:
    rng = np.random.default_rng([seed, 4])
    rows = int(rng.integers(1, 14))
    program = new_program(rows + 3)
    for array in program[:3]:
        array[...] = np.nan
    program.offset[:rows] = rng.normal(size=rows) + (0.5 if seed % 3 else -0.5)
    program.slope[:rows] = rng.normal(size=(rows, 4))
    program.counts[:rows] = rng.integers(0, 2, rows)
    program.counts[rng.integers(rows)] = 1.0
    if seed % 4 == 0:
        program.slope[:rows] = np.round(program.slope[:rows])  # degenerate
    known = scipys(program, rows)
    found = most_of_least(program, rows, -np.inf)
    assert found == pytest.approx(known, abs=1e-9)
    if known > -np.inf:
        x = program.at
        assert np.abs(x).max() <= 1.0
        value = program.offset[:rows] + program.slope[:rows] @ x
        assert value[program.counts[:rows] == 1.0].min() == pytest.approx(known, abs=1e-9)
        assert value.min() >= min(known, 0.0) - 1e-9
        assert known - 1e-12 <= most_of_least(program, rows, known + 0.5) <= known + 0.5 + 1e-12
        assert known - 1e-12 <= most_of_least(program, rows, np.inf) < np.inf


def test_the_tolerance_is_capped_by_the_level() -> None:
    assert capped(2.0, 3.0, 5.0, 0.0) == 2.0
    assert capped(2.0, 3.0, 5.0, 0.25) == 0.5
    assert capped(0.2, 3.0, 5.0, 0.25) == 0.2
    program = new_program(3)
    middle, half = np.array([0.0, 0.0, 0.0, 3.0]), np.array([1.0, 1.0, 1.0, 0.5])
    assert level_row(program, 1, 5.0, 0.25, middle, half) == 2
    assert (program.counts[1], program.offset[1]) == (1.0, 0.5)
    assert program.slope[1].tolist() == [0.0, 0.0, 0.0, -0.125]


def room() -> Room:
    return Room(np.empty(4), np.empty(4), np.empty(4), np.empty(4), np.empty((EACH, 2)))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.0, 0.6])
def test_a_polished_hand_is_as_good_as_it_says_and_no_hand_beside_it_is_better(
    seed: int, share: float
) -> None:
    s = Setting(seed)
    asked = s.asked(share)
    every = np.full(3, len(s.pieces.ptr) - 1)
    hand = s.hand * [1, 1, 1, 1.1]
    finger = np.empty(4)

    def tolerance(h: Floats) -> float:
        clear = clearance(s.edges, s.near, every, s.arm, asked.radius, h, finger)
        return capped(clear, h[3], asked.level, asked.share)

    hand[2] += 0.01
    if s.gaps(hand[None]).min() < 0.0 or tolerance(hand) <= 0.0:
        return
    before = tolerance(hand)
    value = polish(asked, every, hand, before, new_program(3 * 40 + 1), room())
    assert value == pytest.approx(tolerance(hand), abs=1e-12)
    assert value >= before
    beside = hand + 1e-3 * s.rng.normal(size=(60, 4)) * s.size
    beside[:, 3] = np.clip(beside[:, 3], asked.least, asked.top)
    assert max(tolerance(h) for h in beside) <= value + 2e-4 * s.size


@pytest.mark.parametrize("seed", range(6))
def test_the_root_holds_all_hands_of_a_cell(seed: int) -> None:
    s = Setting(seed)
    asked = s.asked()
    middle, half = np.empty(4), np.empty(4)
    seen = 0
    for _ in range(30):
        h = s.hand + s.rng.normal(size=4) * [0.08, 0.08, 0.2, 0.08] * s.size
        h[3] = abs(h[3])
        cell = s.cell(h)
        at = s.fingers(h[None])
        inside = min(s.depth(cell[k], at[:, k])[0] for k in range(3)) > 0.0
        fits = 0.8 * s.hand[3] <= h[3] <= asked.top
        found = _root(s.pieces, s.z, cell, asked, 0.8 * s.hand[3], middle, half)
        if inside and fits:
            seen += 1
            assert found
            off = h - middle
            off[2] = (off[2] + np.pi) % (2.0 * np.pi) - np.pi
            assert (np.abs(off) <= half + 1e-9).all()
        if found:
            assert half.min() >= 0.0
            assert middle[3] - half[3] >= 0.8 * s.hand[3] - 1e-12
            assert middle[3] + half[3] <= asked.top + 1e-12
    assert seen >= (2 if seed not in (2, 4) else 0)
    for k in range(len(s.pieces.ptr) - 1):
        v = s.pieces.slot_vertex[s.pieces.ptr[k] : s.pieces.ptr[k + 1]]
        along = 0.3 * s.pieces.x[v] - 0.7 * s.pieces.y[v]
        assert _support(s.pieces, k, 0.3, -0.7) == along.max()


def test_a_box_is_halved_where_fingers_move_most() -> None:
    arm = np.array([[0.5, 0.0], [-0.3, 0.4], [0.0, 0.1]])
    middle = np.array([0.0, 0.0, 0.0, 4.0])
    for half, known in (
        ([3.0, 1.0, 0.1, 1.0], 0), ([1.0, 3.0, 0.1, 1.0], 1), ([1.0, 1.0, 1.0, 1.0], 2),
        ([0.4, 0.1, 0.01, 1.0], 3), ([0.4, 0.6, 0.1, 1.3], 3), ([1.0, 1.0, 0.0, 1.9], 0),
        ([0.3, 0.2, 0.1, 0.5], 0), ([0.1, 0.2, 0.1, 0.5], 3), ([0.1, 0.2, 0.12, 0.5], 2),
    ):  # fmt: skip
        half_ = np.array(half)
        moves = [half_[0], half_[1], 0.5 * (4.0 + half_[3]) * half_[2], 0.5 * half_[3]]
        assert _widest(arm, middle, half_) == int(np.argmax(moves)), (half, known, moves)


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_no_hand_of_the_cells_is_better_than_the_deepest(share: float) -> None:
    s = Setting(4)
    asked = s.asked(share)._replace(gap=0.05)
    hands = s.hand + s.rng.normal(size=(4000, 4)) * [0.15, 0.15, 0.3, 0.15] * s.size
    hands[:, 3] = np.clip(np.abs(hands[:, 3]), asked.least, asked.top)
    cell = s.cell(s.hand * [1, 1, 1, 1.1])
    cells = np.array([cell, np.roll(cell, 1)])
    found = deepest(s.pieces, s.z, cells, np.full(2, asked.least), asked, 4000)
    at = s.fingers(hands)
    inside = np.min([s.depth(cell[k], at[:, k]) for k in range(3)], axis=0) >= 0.0
    assert inside.sum() > 20
    every = np.full(3, len(s.pieces.ptr) - 1)
    finger = np.empty(4)
    best = -np.inf
    for h in hands[inside]:
        clear = clearance(s.edges, s.near, every, s.arm, asked.radius, h, finger)
        best = max(best, capped(clear, h[3], asked.level, asked.share))
    assert best <= found.bound + 1e-12
    assert found.value <= found.bound <= max(found.value * 1.05, asked.floor) + 1e-12
    if found.value > 0.0:
        clear = clearance(s.edges, s.near, every, s.arm, asked.radius, found.hand, finger)
        assert capped(clear, found.hand[3], asked.level, asked.share) == pytest.approx(found.value)
    short = deepest(s.pieces, s.z, cells, np.full(2, asked.least), asked, 5)
    assert short.bound >= found.value
    assert short.boxes <= 6
