"""Births of cells, the search over them and merges: by all facets and by Kruskal."""

from __future__ import annotations

from itertools import chain, combinations, product

import numpy as np
import pytest
import shapely

from icage.cells.free_space import merge_tree, search
from icage.cells.kernels import search as search_module
from icage.cells.kernels.columns import (
    EDGE_FINGER,
    EDGE_FROM,
    EDGE_SLOT,
    EDGE_TO,
    RECORD_BIRTH,
    RECORD_LEVEL,
    RECORD_NODE,
    Ending,
)
from icage.cells.kernels.facet import (
    facet_of,
)
from icage.cells.kernels.near import cells_near
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.region import least_points
from icage.cells.kernels.search import _least_on_walls, birth, explore
from icage.cells.kernels.tree import births, find_at, merge, visited_births, way_to
from icage.cells.kernels.whole import least_hands
from tests.icage.cells.setting import Setting
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


@pytest.mark.parametrize("seed", range(4))
def test_a_cell_is_born_at_the_least_of_its_facets(seed: int) -> None:
    s = Setting(seed)
    room = new_room()
    cells, _ = cells_near(s.pieces, s.z, s.hand, 0.05 * s.size, 10**6)
    far = s.rng.integers(0, len(s.pieces.ptr) - 1, (20, 3))  # most of them hold no hand
    alike = far[:9].copy()  # fingers in one piece: the first two, the last two, all
    alike[:3, 1], alike[3:6, 1], alike[6:] = alike[:3, 0], alike[3:6, 2], alike[6:, :1]
    chosen = np.concatenate([cells[s.rng.permutation(len(cells))[:25]], far, alike])
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
        walls = [
            v for (i, slot), v in values.items() if i < 2 and s.pieces.slot_neighbour[slot] < 0
        ]
        held = 0.0 if cell[0] == cell[1] == cell[2] else min(walls, default=np.inf)
        for least in (0.3 * s.space.cap, s.space.cap):
            found = _least_on_walls(s.pieces, s.z, cell, least, s.space.worst, room)
            assert found == pytest.approx(min(held, least), abs=1e-9)
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


def test_a_basin_is_as_deep_as_what_lies_behind_its_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until it is known to be deep enough the least of all its cells counts, not of its first.

    Each of the last three has a basin whose first cell and all of whose passes lie higher than a
    wall further in.
    """
    shallow = 0
    for seed, share in chain(product(range(6), (0.003, 0.03)), product((15, 21, 33), (0.2,))):
        monkeypatch.setattr(search_module, "DEEP", share)
        s, room = Setting(seed, [1.0, 30.0][seed % 2]), new_room()
        cells, _ = cells_near(s.pieces, s.z, s.hand, 1e-6 * s.size, 10**6)
        args = (s.space.cap, s.space.worst)
        start = cells[np.argmin(births(s.pieces, s.z, cells, *args).value[:, 0])]
        born = birth(s.pieces, s.z, start, *args, room).sigma
        found = explore(s.pieces, s.z, start, born, *args, np.inf, 150, np.inf)
        first = found.records[:, RECORD_NODE].astype(int)
        for record, a, b in zip(found.records[:-1], first, first[1:], strict=False):
            born_behind = [birth(s.pieces, s.z, c, *args, room).sigma for c in found.nodes[a:b, :3]]
            level, told = record[RECORD_LEVEL], record[RECORD_BIRTH]
            assert told >= min(born_behind) - 1e-9 * s.size
            if level - min(born_behind) < share * s.pieces.scale:
                assert told == pytest.approx(min(*born_behind, level), abs=1e-9 * s.size)
                shallow += 1
            else:
                assert level - told >= share * s.pieces.scale
    assert shallow > 3


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


def test_the_way_to_a_cell_leads_from_the_first_one() -> None:
    """Nodes 0 to 4; edge 0 leads from 0 to 2, edge 1 from 0 to 1, edge 3 from 2 to 4."""
    nodes = np.array([[0, 0, 0, -1], [0, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 2], [0, 0, 0, 3]])
    edges = np.array([[0, 2, 0, 0], [0, 1, 0, 0], [1, 3, 0, 0], [2, 4, 0, 0], [4, 0, 0, 0]])
    assert [way_to(nodes, edges, k).tolist() for k in range(5)] == [[], [1], [0], [1, 2], [0, 3]]
