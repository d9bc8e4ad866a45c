"""Least openings on facets, births and the search over them: by conditions of optimality."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely
from scipy.optimize import linprog, nnls

from icage.cells.free_space import FreeSpace, merge_tree, search
from icage.cells.kernels import minimum as module
from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.columns import (
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_SLOT,
    EDGE_TO,
    RECORD_BIRTH,
    RECORD_LEVEL,
    Ending,
)
from icage.cells.kernels.facet import (
    ALONG,
    BASE_COLUMNS,
    BOUND,
    ERROR,
    G_X,
    G_Y,
    MAX_BASE,
    ends_on_facet,
    facet_of,
    middles_on_facets,
    rows_of_others,
    segment_of,
)
from icage.cells.kernels.min_norm import FOUND, INFEASIBLE, UNSURE, min_norm, min_norm_careful
from icage.cells.kernels.minimum import _nearest_on, _shift, _slid_to, _turn, nearest_minimum
from icage.cells.kernels.near import Hand, cells_near
from icage.cells.kernels.passes import new_room, pass_fast, pass_value
from icage.cells.kernels.plateau import plateau_through
from icage.cells.kernels.region import least_points
from icage.cells.kernels.search import birth, explore
from icage.cells.kernels.tree import births, find_at, lowest_cells, merge, visited_births
from icage.cells.kernels.whole import (
    ends_of_minima,
    least_hands,
    least_passes,
    passes_between,
    rows_of,
)
from icage.cells.kernels.whole import least_points as whole_least_points
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.cells.test_kernels_of_polygons import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def half_planes(rng: np.random.Generator, n: int) -> Floats:
    """Rows g . w >= c with |g| = 1, with an error that is rounding."""
    angle = rng.uniform(0.0, 2.0 * np.pi, n)
    level = rng.normal(size=n) * 0.4
    error = np.full(n, 1e-15)
    return np.column_stack([np.cos(angle), np.sin(angle), level, error, error])


def least_of(rows: Floats) -> float:
    """Least |w| in all half planes, inf for none: the origin, a foot or a corner."""
    g, c = rows[:, :2], rows[:, 2]
    tries = [np.zeros(2), *(g * c[:, None])]
    for a, b in combinations(range(len(g)), 2):
        det = g[a, 0] * g[b, 1] - g[a, 1] * g[b, 0]
        if abs(det) > 1e-12:
            tries.append(np.array([c[a] * g[b, 1] - c[b] * g[a, 1],
                                   g[a, 0] * c[b] - g[b, 0] * c[a]]) / det)  # fmt: skip
    w = np.array(tries)
    held = (w @ g.T >= c - 1e-11).all(axis=1)
    return float(np.hypot(*w[held].T).min()) if held.any() else np.inf


@pytest.mark.parametrize("count", [1, 2, 3, 5, 9])
def test_the_least_norm_in_half_planes(count: int) -> None:
    rng = np.random.default_rng(count)
    kinds = {INFEASIBLE: 0, FOUND: 0, UNSURE: 0}
    for _ in range(60):
        rows = half_planes(rng, count)
        known = least_of(rows)
        found = min_norm(rows, count, 1e-11)
        kinds[found.status] += 1
        if found.status != UNSURE:
            assert (found.status == FOUND) == (known < np.inf)
            if known < np.inf:
                assert np.hypot(found.w_x, found.w_y) == pytest.approx(known, abs=1e-10)
                w = np.array([found.w_x, found.w_y])
                assert (rows[:, :2] @ w >= rows[:, 2] - 1e-10).all()
        pairs = np.zeros((count, 6))
        pairs[:, ::2] = rows[:, :3]
        careful = min_norm_careful(pairs, count, 1e-24)
        assert (careful.status == FOUND) == (known < np.inf)
        if known < np.inf:
            assert np.hypot(careful.w_x, careful.w_y) == pytest.approx(known, abs=1e-10)
    assert kinds[UNSURE] <= 1
    assert kinds[FOUND] >= 5
    assert count < 3 or kinds[INFEASIBLE] > 0
    assert min_norm(rows, 0, 1e-12) == (FOUND, 0.0, 0.0)


def test_what_doubles_cannot_tell_is_said() -> None:
    """Parallel rows, a thin wedge, an error that is too large: unsure, unless it is clear."""
    error = 1e-14

    def asked(*rows: tuple[float, float, float], worst: float = 1e-12, off: float = error) -> int:
        table = np.array([(*r, off, off) for r in rows])
        return min_norm(table, len(table), worst).status

    up, down = (0.0, 1.0), (0.0, -1.0)
    assert asked((*up, 0.5), (*down, -0.6)) == FOUND
    assert asked((*up, 0.5), (*down, -0.5 + 1e-13)) == UNSURE
    assert asked((*up, 0.5), (*down, -0.4)) == INFEASIBLE
    assert asked((*down, -0.4), (*up, 0.5)) == INFEASIBLE
    assert asked((*up, 0.5), off=2e-12) == UNSURE
    assert asked((*up, 0.5), off=0.9e-12, worst=1e-12) == FOUND
    tilt = (np.sin(1e-4), -np.cos(1e-4))  # almost down: the corner is 1e4 times as far off
    assert asked((*up, 0.5), (*tilt, -0.5 * np.cos(1e-4) + 1e-6)) == UNSURE
    # three lines through one point that leave hardly a wedge
    corner = np.array([0.3, 0.4])
    g = [np.array([np.cos(a), np.sin(a)]) for a in (0.5, 0.5 + np.pi - 1e-5)]
    assert asked(*[(*r, float(r @ corner)) for r in g]) == UNSURE
    wide = [np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.6)]
    assert asked(*[(*r, float(r @ corner)) for r in wide]) == FOUND
    # three rows that no point satisfies, by little and by much
    star = [np.array([np.cos(a), np.sin(a)]) for a in (0.0, 2.1, 4.2)]
    assert asked(*[(*r, 0.1) for r in star]) == INFEASIBLE
    assert asked(*[(*r, 1e-15) for r in star]) in (UNSURE, FOUND)
    assert asked(*[(*r, 3e-14) for r in star]) == UNSURE


def test_double_doubles_tell_what_doubles_cannot() -> None:
    def asked(*rows: tuple[float, float, float, float], slack: float = 1e-24) -> int:
        """Rows g_x, g_y, c and the low part of c."""
        table = np.array([(r[0], 0.0, r[1], 0.0, r[2], r[3]) for r in rows])
        return min_norm_careful(table, len(table), slack).status

    assert asked((0.0, 1.0, 0.5, 0.0), (0.0, -1.0, -0.5, 0.0)) == FOUND
    assert asked((0.0, 1.0, 0.5, 1e-20), (0.0, -1.0, -0.5, 0.0)) == INFEASIBLE
    assert asked((0.0, 1.0, 0.5, 1e-20), (0.0, -1.0, -0.5, 0.0), slack=1e-19) == FOUND
    assert asked((0.0, 1.0, 0.5, -1e-20), (0.0, -1.0, -0.5, 0.0)) == FOUND
    star = [(np.cos(a), np.sin(a)) for a in (0.0, 2.1, 4.2)]
    assert asked(*[(*r, 1e-20, 0.0) for r in star]) == INFEASIBLE
    assert asked(*[(*r, -1e-20, 0.0) for r in star]) == FOUND


def facets(s: Setting, count: int, spread: float) -> list[tuple[np.ndarray, int, int]]:
    """Cells round the target, with a finger and an edge of its piece."""
    found = []
    hand = s.hand
    while len(found) < count:
        off = spread * s.size * s.rng.normal(size=4)
        cells, _ = cells_near(s.pieces, s.z, Hand(*(np.array(hand) + off)), 0.02 * s.size, 10**6)
        if len(cells) == 0:
            continue
        cell = cells[s.rng.integers(len(cells))]
        i = int(s.rng.integers(3))
        slots = range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1])
        found.append((cell, i, int(s.rng.choice(slots))))
    return found


@pytest.mark.parametrize("seed", range(8))
def test_the_least_opening_on_a_facet_is_held_by_what_it_touches(seed: int) -> None:
    """It is feasible, and w is a sum with weights >= 0 of the rows that are tight."""
    s = Setting(seed, 1.0 if seed % 2 else 30.0)
    room, base = new_room(), np.empty((MAX_BASE, BASE_COLUMNS))
    told = [0, 0]
    for cell, i, slot in facets(s, 30, 0.1):
        facet = facet_of(s.pieces, cell, i, slot)
        assert facet.finger == i
        assert (facet.second, facet.second_piece) == ((i + 1) % 3, cell[(i + 1) % 3])
        assert (facet.third, facet.third_piece) == ((i + 2) % 3, cell[(i + 2) % 3])
        corners = s.corners[cell[i]]
        at = slot - s.pieces.ptr[cell[i]]
        p, q = corners[at], corners[(at + 1) % len(corners)]
        segment = segment_of(s.pieces, facet)
        length = float(np.hypot(*(q - p)))
        assert (segment.x, segment.y) == tuple(p)
        assert segment.length == pytest.approx(length)
        n = rows_of_others(s.pieces, s.z, facet, segment, base)
        # from scratch: all corners of the other pieces' half planes
        way = (q - p) / length
        rows = [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -1.0, -length]]
        for other in (facet.second, facet.third):
            u = complex(*(s.z[other] - s.z[i]))
            ring = s.corners[cell[other]]
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                side = b - a
                normal = complex(-side[1], side[0]) / np.hypot(*side)
                g = normal * np.conj(u)
                rows.append([g.real, g.imag, normal.real * way[0] + normal.imag * way[1],
                             normal.real * (a - p)[0] + normal.imag * (a - p)[1]])  # fmt: skip
        own = np.array(rows)
        assert base[:n, [G_X, G_Y, ALONG, BOUND]] == pytest.approx(own[2:], abs=1e-9 * s.size)
        assert (base[:n, ERROR] > 0.0).all()
        assert base[:n, ERROR].max() < 1e-11 * s.size
        free = linprog(np.zeros(3), A_ub=-own[:, :3], b_ub=-own[:, 3], bounds=[(None, None)] * 3)
        cap = s.space.cap
        value, wx, wy = pass_value(s.pieces, s.z, facet, cap, s.space.worst, room)
        told[int(value < np.inf)] += 1
        if value == np.inf:
            assert free.status == 2 or least_at_least(own) > 0.99 * cap
            continue
        assert value == pytest.approx(np.hypot(wx, wy))
        rest = own[:, 3] - own[:, :2] @ [wx, wy]
        h = own[:, 2]
        low = max(r / k for r, k in zip(rest, h, strict=True) if k > 1e-9)
        high = min(r / k for r, k in zip(rest, h, strict=True) if k < -1e-9)
        tiny = 1e-9 * s.size
        assert low <= high + tiny
        assert rest[np.abs(h) <= 1e-9].max(initial=-1.0) <= tiny
        ends = ends_on_facet(s.pieces, s.z, cell, i, slot, wx, wy)
        for tau, x, y in ((low, ends.x_lo, ends.y_lo), (high, ends.x_hi, ends.y_hi)):
            assert (x, y) == pytest.approx(tuple(p + tau * way), abs=1e-6 * s.size)
        middle = middles_on_facets(s.pieces, s.z, cell[None], np.array([i]), np.array([slot]),
                                   np.array([[wx, wy]]))[0]  # fmt: skip
        spot = p + 0.5 * (low + high) * way
        finger = complex(*middle[:2]) + complex(wx, wy) * complex(*s.z[i])
        assert (finger.real, finger.imag) == pytest.approx(tuple(spot), abs=1e-6 * s.size)
        if value < 1e-6 * s.size:
            continue
        tau = 0.5 * (low + high)
        tight = own @ [wx, wy, tau, -1.0] < 1e-7 * s.size
        _force, miss = nnls(own[tight][:, :3].T, np.array([wx, wy, 0.0]))
        assert miss <= 1e-6 * value
        below, above = (
            pass_value(s.pieces, s.z, facet, value * (1.0 + off), s.space.worst, room)[0]
            for off in (-1e-7, 1e-7)
        )
        assert below == np.inf
        assert above == pytest.approx(value)
        careful = pass_careful(s.pieces, s.z, facet, cap, 0.0)
        fast = pass_fast(s.pieces, s.z, facet, cap, s.space.worst, room)
        if fast.status == FOUND and careful.status == FOUND:
            assert careful[1:] == pytest.approx(fast[1:], abs=1e-8 * s.size)
    assert room.tally[0] > 30
    assert min(told) > 2


def least_at_least(rows: Floats) -> float:
    """A lower bound of |w| over rows: the most of its components along 24 directions."""
    found = 0.0
    for angle in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False):
        cost = [np.cos(angle), np.sin(angle), 0.0]
        one = linprog(cost, A_ub=-rows[:, :3], b_ub=-rows[:, 3], bounds=[(None, None)] * 3)
        if one.status == 0:
            found = max(found, float(one.fun))
    return found


@pytest.mark.parametrize("seed", range(4))
def test_a_cell_is_born_at_the_least_of_its_facets(seed: int) -> None:
    s = Setting(seed)
    room = new_room()
    cells, _ = cells_near(s.pieces, s.z, s.hand, 0.05 * s.size, 10**6)
    far = s.rng.integers(0, len(s.pieces.ptr) - 1, (20, 3))  # most of them hold no hand
    chosen = np.concatenate([cells[s.rng.permutation(len(cells))[:25]], far])
    args = (s.space.cap, s.space.worst)
    table = births(s.pieces, s.z, chosen, *args)
    told = [0, 0]
    for k, cell in enumerate(chosen):
        born = birth(s.pieces, s.z, cell, *args, room)
        values = {}
        for i in range(3):
            for slot in range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1]):
                facet = facet_of(s.pieces, cell, i, slot)
                values[i, slot] = pass_value(s.pieces, s.z, facet, *args, room)[0]
        known = min(values.values())
        if cell[0] == cell[1] == cell[2]:
            known = 0.0
        assert born.sigma == pytest.approx(known, abs=1e-9)
        assert table.value[k].tolist() == [born.sigma, born.w_x, born.w_y]
        assert table.where[k].tolist() == [born.finger, born.slot]
        told[int(born.sigma < np.inf)] += 1
        if born.sigma == np.inf or cell[0] == cell[1] == cell[2]:
            assert born[1:] == (0.0, 0.0, -1, -1)
        if 0.0 < born.sigma < np.inf:
            assert born.finger in (0, 1)
            assert values[born.finger, born.slot] == pytest.approx(known, abs=1e-9)
            assert np.hypot(born.w_x, born.w_y) == pytest.approx(born.sigma)
            hand = least_hands(s.pieces, s.z, cell[None], np.array([-1]), np.array([-1]), *args)[0]
            assert np.hypot(*hand[2:]) == pytest.approx(born.sigma)
            at = complex(*hand[:2]) + complex(*hand[2:]) * (s.z @ [1.0, 1j])
            spots = [least_points(s.pieces, s.z, i, cell[None], hand[2:3], hand[3:],
                                  np.array([born.finger]), np.array([born.slot]))[0]
                     for i in range(3)]  # fmt: skip
            for p, q, piece in zip(at, spots, cell, strict=True):
                assert (p.real, p.imag) == pytest.approx(tuple(q), abs=1e-9)
                assert s.shapes[piece].distance(shapely.Point(q)) < 1e-8
    assert min(told) > 3


@pytest.mark.parametrize("seed", range(4))
def test_the_search_enters_cells_in_order_of_their_passes(seed: int) -> None:
    """Against all passes between the cells that it has visited: the least way in the largest."""
    s = Setting(seed, 1.0 if seed % 2 else 30.0)
    start = cells_near(s.pieces, s.z, s.hand, 1e-9 * s.size, 10**6)[0][0]
    born = births(s.pieces, s.z, start[None], s.space.cap, s.space.worst).value[0, 0]
    args = (s.pieces, s.z, start, born, s.space.cap, s.space.worst)
    found = explore(*args, np.inf, 150, np.inf)
    assert found.outcome in (Ending.GAVE_UP, Ending.ESCAPED, Ending.CLOSED_IN)
    assert len({tuple(c) for c in found.nodes[:, :3].tolist()}) == len(found.nodes)
    if found.outcome == Ending.GAVE_UP:
        assert len(found.nodes) == 151
    level = np.maximum.accumulate(found.node_level)
    assert found.node_level.tolist() == level.tolist()
    ends, value = found.edges[:, [EDGE_FROM, EDGE_TO]], found.edge_value[:, 0]
    reach = np.full(len(found.nodes), np.inf)
    reach[0] = born
    inside = ends[:, 1] >= 0
    for _ in range(len(found.nodes)):  # relaxed until nothing changes
        a, b = ends[inside].T
        way = value[inside]
        new = reach.copy()
        np.minimum.at(new, b, np.maximum(reach[a], way))
        np.minimum.at(new, a, np.maximum(reach[b], way))
        if (new == reach).all():
            break
        reach = new
    assert found.node_level == pytest.approx(np.maximum(reach, born), abs=1e-9 * s.size)
    m = s.pieces.slot_neighbour
    nodes = {tuple(c): k for k, c in enumerate(found.nodes[:, :3].tolist())}
    for e in range(0, len(ends), 7):
        a, f, slot = ends[e, 0], found.edges[e, EDGE_FINGER], found.edges[e, EDGE_SLOT]
        to = found.nodes[a, :3].copy()
        to[f] = m[slot]
        assert ends[e, 1] == nodes.get(tuple(to.tolist()), -1)
    middle = 0.5 * float(found.node_level[0] + found.node_level[-1])
    less = explore(*args, middle, 10**6, np.inf)
    assert (less.node_level <= middle).all()
    assert less.level > middle
    kept = (found.node_level <= middle).sum()
    assert len(less.nodes) == kept
    deep = found.records[:, RECORD_LEVEL] - found.records[:, RECORD_BIRTH]
    if len(deep):
        enough = float(deep.max()) * 0.999
        met = explore(*args, np.inf, 150, enough)
        assert met.outcome == Ending.MET
        gap = met.records[-1, RECORD_LEVEL] - met.records[-1, RECORD_BIRTH]
        assert gap > enough
        again = explore(*args, np.inf, 150, float(deep.max()) * 1.5 + 1e-3)
        assert again.outcome == found.outcome


def kruskal(low: Floats, edges: np.ndarray, value: Floats) -> dict[int, tuple[float, int]]:
    """Of every minimum that meets a deeper one the level and that one, by the elder rule."""
    owner = list(range(len(low)))

    def root(k: int) -> int:
        return k if owner[k] == k else root(owner[k])

    found = {}
    for e in np.argsort(value, kind="stable"):
        a, b = sorted((root(edges[e, 0]), root(edges[e, 1])), key=lambda k: (low[k], k))
        if a != b:
            owner[b] = a
            found[b] = (value[e], a)
    return found


def test_minima_merge_by_the_elder_rule() -> None:
    rng = np.random.default_rng(5)
    for _ in range(10):
        n, e = 12, 25
        low = np.round(rng.random(n), 1)
        edges = np.zeros((e, 5), np.int64)
        edges[:, EDGE_FROM], edges[:, EDGE_TO] = rng.integers(0, n, (2, e))
        ends = edges[:, [EDGE_FROM, EDGE_TO]]
        value = np.round(np.maximum(low[ends[:, 0]], low[ends[:, 1]]) + rng.random(e), 2)
        edges[3, EDGE_TO] = -1
        used = np.flatnonzero(edges[:, EDGE_TO] >= 0)
        below = 1.3
        cut = used[value[used] < below]
        found = merge(low, edges, value, below)
        known = kruskal(low, ends[cut], value[cut])
        got = {int(lose): (float(one[0]), int(keep)) for (keep, lose, _, _), one in
               zip(found.merges.tolist(), found.lows.tolist(), strict=True)}  # fmt: skip
        assert got == known
        for (_, lose, edge, side), (level, depth) in zip(found.merges, found.lows, strict=True):
            assert depth == pytest.approx(level - low[lose])
            assert value[edge] == level
            assert edges[edge, EDGE_TO] >= 0
            del side
        for level in (0.3, 0.8, 1.2, 5.0):
            joined = [find_at(found.parent, found.stamp, k, level) for k in range(n)]
            owner = list(range(n))
            for a, b in ends[cut][value[cut] <= level]:
                owner = [owner[a] if o == owner[b] else o for o in owner]
            for a, b in combinations(range(n), 2):
                assert (joined[a] == joined[b]) == (owner[a] == owner[b])
        # which side of a merge the first node was on: 0 neither, 1 swallowed, 2 surviving
        for row, (keep, lose, edge, side) in enumerate(found.merges):
            level = found.lows[row, 0]
            before = cut[np.lexsort((cut, value[cut]))]
            before = before[: int(np.flatnonzero(before == edge)[0])]
            owner = list(range(n))
            for a, b in ends[before]:
                owner = [owner[a] if o == owner[b] else o for o in owner]
            start = {owner[keep]: 2, owner[lose]: 1}.get(owner[0], 0)
            assert [0, 1, 2].index(start) == int(side), (level, side)
        order = np.argsort(value[used], kind="stable")
        whole = ends_of_minima(low, ends[used, 0], ends[used, 1], value[used], order)
        for k, (level, elder) in kruskal(low, ends[used], value[used]).items():
            assert (whole.merged[k], whole.elder[k]) == (level, elder)
        assert (whole.merged == np.inf).sum() == (whole.elder == -1).sum()
        least = least_passes(n, ends[used, 0], ends[used, 1], value[used])
        for k in range(n):
            at = value[used][(ends[used] == k).any(axis=1)]
            assert least[k] == (at.min() if len(at) else np.inf)


@pytest.mark.parametrize("seed", [1, 3])
def test_what_a_search_has_visited_is_born_where_its_cells_are(seed: int) -> None:
    s = Setting(seed)
    start = cells_near(s.pieces, s.z, s.hand, 1e-9, 10**6)[0][0]
    found = search(s.space, start, 0.0, limit=60)
    nodes = found.nodes[:30]
    args = (s.space.cap, s.space.worst)
    told = visited_births(s.pieces, s.z, nodes, found.edges, found.edge_value, *args)
    known = births(s.pieces, s.z, nodes, *args)
    assert told.value[:, 0] == pytest.approx(known.value[:, 0], abs=1e-9)
    room = new_room()
    for k in range(len(nodes)):
        finger, slot = told.where[k]
        if finger < 0:
            assert told.value[k, 0] in (0.0, np.inf)
            continue
        facet = facet_of(s.pieces, nodes[k], finger, slot)
        assert pass_value(s.pieces, s.z, facet, *args, room)[0] == pytest.approx(told.value[k, 0])
        assert np.hypot(*told.value[k, 1:]) == pytest.approx(told.value[k, 0])
    # the other way round: a pass tells the cell behind it the edge of its own piece
    back = found.edges.copy()
    inside = back[:, EDGE_TO] >= 0
    for e in np.flatnonzero(inside):
        back[e, [EDGE_FROM, EDGE_TO]] = back[e, [EDGE_TO, EDGE_FROM]]
        f, slot = back[e, EDGE_FINGER], back[e, EDGE_SLOT]
        here, there = found.nodes[back[e, EDGE_FROM], f], found.nodes[back[e, EDGE_TO], f]
        assert s.pieces.slot_neighbour[slot] == here
        own = range(s.pieces.ptr[here], s.pieces.ptr[here + 1])
        back[e, EDGE_SLOT] = next(q for q in own if s.pieces.slot_neighbour[q] == there)
    turned = visited_births(s.pieces, s.z, nodes, back, found.edge_value, *args)
    assert turned.value[:, 0] == pytest.approx(known.value[:, 0], abs=1e-9)
    for k in np.flatnonzero(turned.where[:, 0] >= 0):
        facet = facet_of(s.pieces, nodes[k], *turned.where[k])
        assert pass_value(s.pieces, s.z, facet, *args, room)[0] == pytest.approx(turned.value[k, 0])
    tree = merge_tree(found)
    assert len(tree.parent) == len(tree.birth)


def test_a_hand_slides_along_the_longest_chord_of_its_translations(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    corners = {
        "none": np.empty((0, 2)), "one": np.array([[2.0, 3.0]]),
        "chord": np.array([[0.0, 0.0], [2.0, 1e-9], [4.0, 2.0], [2.0, 1.0]]),
    }  # fmt: skip
    to = Hand(3.0, -1.0, 1.0, 0.0)
    for name, known in (("none", (9.0, 8.0)), ("one", (2.0, 3.0)), ("chord", (2.0, 1.0))):
        monkeypatch.setattr(module, "translations", lambda *_, name=name: corners[name])
        assert _slid_to(None, None, None, 9.0, 8.0, 1.0, 0.0, to) == pytest.approx(known)
        beyond = to._replace(d_x=30.0)
        found = _slid_to(None, None, None, 0.1, 0.0, 1.0, 0.0, beyond)
        if name == "chord":
            assert found == pytest.approx((4.0, 2.0))


def test_moves_and_turns_of_hands() -> None:
    rng = np.random.default_rng(3)
    z = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.9]])
    for _ in range(20):
        a, b = rng.normal(size=(2, 4))
        fingers = [complex(*h[:2]) + complex(*h[2:]) * (z @ [1.0, 1j]) for h in (a, b)]
        far = np.abs(fingers[0] - fingers[1]).max()
        assert _shift(z, *a, Hand(*b)) == pytest.approx(far)
        turn = abs(np.angle(complex(*b[2:]) / complex(*a[2:])))
        assert _turn(*a[2:], Hand(*b)) == pytest.approx(turn)
        p, q, w = rng.normal(size=(3, 2))
        t = np.clip((w - p) @ (q - p) / ((q - p) @ (q - p)), 0.0, 1.0)
        assert _nearest_on(*p, *q, *w) == pytest.approx(tuple(p + t * (q - p)))
    assert _turn(0.0, 0.0, Hand(0.0, 0.0, 1.0, 1.0)) == 0.0
    assert _turn(1.0, 1.0, Hand(0.0, 0.0, 0.0, 0.0)) == 0.0
    assert _turn(0.0, 1.0, Hand(0.0, 0.0, 1.0, 0.0)) == pytest.approx(0.5 * np.pi)
    assert _turn(1.0, 0.0, Hand(0.0, 0.0, 0.0, 1.0)) == pytest.approx(0.5 * np.pi)
    assert _nearest_on(1.0, 2.0, 1.0, 2.0, 5.0, 5.0) == (1.0, 2.0)


@pytest.mark.parametrize("size", [1.0, 40.0, 0.05])
def test_the_nearest_minimum_on_a_plateau_is_where_it_was_asked_for(size: float) -> None:
    """A bar between two fingers below and one above: along it nothing changes."""
    outline = Outline(size * np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]]))
    contacts = size * np.array([[1.2, 0.0], [2.8, 0.0], [2.0, 1.0]])
    s = Setting(0)
    s.space = FreeSpace.around(outline, HandShape.from_contacts(contacts))
    space = s.space
    at = (contacts - space.origin) @ [1.0, 1j]
    for off in (0.0, 0.4 * size, -0.5 * size):
        wanted = Hand(at[0].real + off, at[0].imag, (at[1] - at[0]).real, 0.0)
        found = nearest_minimum(
            space.pieces, space.z, wanted, 1e-6, 1e-6, space.cap, space.worst, 10**6
        )
        assert found.row >= 0
        assert found.near[found.row, :4] == pytest.approx(np.array(wanted), abs=1e-9 * size)
        assert found.near[found.row, 4] == pytest.approx(1.6 * size)
        assert found.plateau.long
        ends = sorted([found.plateau.a_x, found.plateau.b_x])
        # finger 1 from the lower left corner to where finger 2 is at the lower right one
        assert ends == pytest.approx(
            [-space.origin[0], 2.4 * size - space.origin[0]], abs=1e-6 * size
        )
        again = plateau_through(
            space.pieces, space.z, wanted, 1.6 * size, space.cap, space.worst, 10**6
        )
        assert sorted([again.a_x, again.b_x]) == pytest.approx(ends, abs=1e-9 * size)
    turned = wanted._replace(w_y=0.01 * size)
    none = nearest_minimum(space.pieces, space.z, turned, 0.1, 1e-3, space.cap, space.worst, 10**6)
    assert none.row == -1
    turned = nearest_minimum(space.pieces, space.z, turned, 0.1, 0.1, space.cap, space.worst, 10**6)
    assert turned.row >= 0
    assert turned.near[turned.row, 6] == pytest.approx(np.arctan2(0.01, 1.6), rel=1e-3)
    none = nearest_minimum(space.pieces, space.z, wanted, 0.1, 0.1, space.cap, space.worst, 0)
    assert none.row == -1
    assert none.total > 0


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_minimum_is_the_target_from_beside_it(seed: int) -> None:
    s = Setting(seed, [1.0, 40.0, 0.05][seed % 3])
    rng = s.rng
    args = (s.space.cap, s.space.worst, 10**6)
    off = 1e-3 * s.size * rng.uniform(-1, 1, 4)
    wanted = Hand(*(np.array(s.hand) + off))
    found = nearest_minimum(s.pieces, s.z, wanted, 0.02, 0.02, *args)
    assert found.row >= 0
    near = found.near[found.row]
    moved = _shift(s.z, *wanted, s.hand) / s.size
    assert near[5] <= moved + 1e-9
    hand = complex(*near[:2]) + complex(*near[2:4]) * (s.z @ [1.0, 1j])
    asked = complex(*wanted[:2]) + complex(*wanted[2:]) * (s.z @ [1.0, 1j])
    assert near[5] == pytest.approx(np.abs(hand - asked).max() / s.size)
    assert (np.diff(found.near[:, 4]) >= 0.0).all()
    assert (found.near[:, 5] <= 0.02).all()
    assert (found.near[:, 6] <= 0.02).all()
    if near[5] > 0.9 * moved:
        assert hand == pytest.approx(s.fingers, abs=1e-7 * s.size)
    less = nearest_minimum(s.pieces, s.z, wanted, near[5] * 0.9, 0.02, *args)
    assert less.row < 0
    more = nearest_minimum(s.pieces, s.z, wanted, near[5] * 1.1, 0.02, *args)
    assert more.near[more.row, 5] == pytest.approx(near[5])


def test_all_cells_of_a_small_object() -> None:
    """Its table, its passes and its least points, one by one."""
    s = Setting(1)
    m = len(s.pieces.ptr) - 1
    args = (s.space.cap, s.space.worst)
    every = np.array([(a, b, c) for a in range(m) for b in range(m) for c in range(m)])
    born = births(s.pieces, s.z, every, *args).value[:, 0]
    cells = every[born < np.inf]
    row = rows_of(cells, m)
    for pair in range(m * m):
        known = np.flatnonzero(cells[:, 0] * m + cells[:, 1] == pair)
        assert list(range(row[pair], row[pair + 1])) == known.tolist()
    number = {tuple(c): k for k, c in enumerate(cells.tolist())}
    chosen = range(0, len(cells), max(1, len(cells) // 25))
    room = new_room()
    for k in chosen:
        known = {}
        for i in range(3):
            for slot in range(s.pieces.ptr[cells[k, i]], s.pieces.ptr[cells[k, i] + 1]):
                to = cells[k].copy()
                to[i] = s.pieces.slot_neighbour[slot]
                if to[i] > cells[k, i] and tuple(to.tolist()) in number:
                    facet = facet_of(s.pieces, cells[k], i, slot)
                    value = pass_value(s.pieces, s.z, facet, *args, room)[0]
                    if value < np.inf:
                        known[number[tuple(to.tolist())]] = value
        found = passes_between(s.pieces, s.z, cells, row, k, k + 1, *args)
        assert found.lower.tolist() == [k] * len(known)
        assert dict(zip(found.upper.tolist(), found.sigma.tolist(), strict=True)) == known
    passes = passes_between(s.pieces, s.z, cells, row, 0, len(cells), *args)
    least = least_passes(len(cells), passes.lower, passes.upper, passes.sigma)
    some = whole_least_points(s.pieces, s.z, cells, least, 5, 30, *args)
    assert some.sigma == pytest.approx(born[born < np.inf][5:30], abs=1e-9)
    for k in range(25):
        if some.finger[k] >= 0:
            facet = facet_of(s.pieces, cells[5 + k], some.finger[k], some.slot[k])
            value = pass_value(s.pieces, s.z, facet, *args, room)[0]
            assert value == pytest.approx(some.sigma[k])
            assert some.sigma[k] < least[5 + k]
    alone = np.full(len(cells), np.inf)  # as if no cell had a pass
    for k in range(5, 25):
        one = whole_least_points(s.pieces, s.z, cells, alone, k, k + 1, *args)
        held = []
        for i in range(3):
            values = [
                pass_value(s.pieces, s.z, facet_of(s.pieces, cells[k], i, slot), *args, room)[0]
                for slot in range(s.pieces.ptr[cells[k, i]], s.pieces.ptr[cells[k, i] + 1])
                if s.pieces.slot_neighbour[slot] < 0
            ]
            held.append(min(values, default=np.inf))
        told = sum(h <= min(held) + 1e-9 * s.size for h in held)
        pinched = len(set(cells[k].tolist())) == 1
        assert one.sigma[0] == (0.0 if pinched else min(held) if told >= 2 else np.inf)
    lowest = lowest_cells(s.pieces, s.z, *args, 1e-9, 1e-9)
    table = dict(zip(map(tuple, every.tolist()), born.tolist(), strict=True))
    known_lowest = []
    for cell in every:
        here = table[tuple(cell.tolist())]
        if not 0.0 < here < np.inf:
            continue
        good = True
        for i in range(3):
            for slot in range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1]):
                to = cell.copy()
                to[i] = s.pieces.slot_neighbour[slot]
                if to[i] >= 0 and table[tuple(to.tolist())] < here - 1e-9:
                    facet = facet_of(s.pieces, cell, i, slot)
                    value = pass_value(s.pieces, s.z, facet, here + 2e-9, s.space.worst, room)[0]
                    good = good and value > here + 1e-9
        if good:
            known_lowest.append(cell.tolist())
    assert lowest.cells.tolist() == known_lowest
    for cell, value in zip(lowest.cells.tolist(), lowest.birth, strict=True):
        assert value[0] == table[tuple(cell)]
        assert np.hypot(*value[1:]) == pytest.approx(value[0])
