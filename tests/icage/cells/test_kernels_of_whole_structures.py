"""All passes, all least points, basins and their ends: against one facet and one cell at a time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree

from icage.cells.free_space import FreeSpace
from icage.cells.kernels.along import new_bounds, put_bounds, segment_between
from icage.cells.kernels.basins import basins_of, ends_of_basins, least_forest
from icage.cells.kernels.careful import pass_careful
from icage.cells.kernels.confirmed import confirmed
from icage.cells.kernels.facet import facet_of
from icage.cells.kernels.inhabited import extents_of, inhabited_cells
from icage.cells.kernels.min_norm import FOUND, NARROW
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.tree import births
from icage.cells.kernels.whole import (
    EMPTY,
    LEAST,
    Passes,
    _least,
    cells_by_piece,
    edges_that_lead_nowhere,
    least_of_isolated,
    least_passes,
    lower_at_walls,
    passes_from,
)
from icage.hand import HandShape
from icage.outline import Outline
from tests.icage.cells.setting import Setting

pytestmark = pytest.mark.usefixtures("plain")


def _symmetric() -> FreeSpace:
    """A star of four equal spikes and the equilateral hand: facets that hold by a hair."""
    angle = np.arange(8) * np.pi / 4.0
    radius = np.tile([1.0, 0.4], 4)
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return FreeSpace.around(Outline(vertices), HandShape.from_angles_deg(60.0, 120.0))


def _every_cell(space: FreeSpace) -> np.ndarray:
    return inhabited_cells(space.pieces, extents_of(space.pieces, space.z), 0, space.pieces.total)


@pytest.mark.parametrize("seed", [1, 2])
def test_cells_by_the_piece_of_a_finger(seed: int) -> None:
    s = Setting(seed)
    m = s.pieces.total
    cells = _every_cell(s.space)
    for i in range(3):
        lists = cells_by_piece(cells, m, i)
        others = [j for j in range(3) if j != i]
        for piece in range(m):
            rows = slice(lists.begin[piece], lists.begin[piece + 1])
            assert lists.number[rows].tolist() == np.flatnonzero(cells[:, i] == piece).tolist()
            of_piece = cells[lists.number[rows]][:, others]
            assert lists.key[rows].tolist() == (of_piece[:, 0] * m + of_piece[:, 1]).tolist()
        assert lists.begin[-1] == len(cells)


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_what_takes_a_force_along_an_edge_at_its_ends(seed: int) -> None:
    """By the corners of both pieces: the edge beside is left with a push along its normal."""
    s = Setting(seed)
    p = s.pieces
    seen = 0
    for piece in range(p.total):
        for slot in range(p.ptr[piece], p.ptr[piece + 1]):
            found = segment_between(p, piece, slot)
            corner = s.corners[piece]
            k = slot - p.ptr[piece]
            a, b = corner[k], corner[(k + 1) % len(corner)]
            before, after = corner[k - 1], corner[(k + 2) % len(corner)]
            assert found.length == pytest.approx(math.dist(a, b))
            known = [-_cotangent(a, b, before), -_cotangent(b, a, after)]
            other = p.slot_neighbour[slot]
            if other >= 0:
                there = s.corners[other]
                at = int(np.argmin(np.hypot(*(there - b).T)))  # the edge runs from b to a there
                known += [
                    _cotangent(a, b, there[(at + 2) % len(there)]),
                    _cotangent(b, a, there[at - 1]),
                ]
                seen += 1
            assert np.array(found[3 : 3 + len(known)]) == pytest.approx(np.array(known), rel=1e-6)
    assert seen > 5


def _cotangent(corner: np.ndarray, one: np.ndarray, other: np.ndarray) -> float:
    u, v = one - corner, other - corner
    return float(u @ v / abs(u[0] * v[1] - u[1] * v[0]))


@pytest.mark.parametrize("seed", [1, 2, -1])
def test_all_passes_and_least_points_of_a_small_object(seed: int) -> None:
    """Against each facet by itself, and each cell; what facets tell of cells is so."""
    space = _symmetric() if seed < 0 else Setting(seed, 30.0 if seed == 2 else 1.0).space
    pieces, z, args = space.pieces, space.z, (space.cap, space.worst)
    m, tiny = pieces.total, 1e-12 * pieces.diameter
    cells = _every_cell(space)
    number = {tuple(cell): k for k, cell in enumerate(cells.tolist())}
    born = births(pieces, z, cells.astype(np.int64), *args).value[:, 0]
    told = np.zeros((len(cells), 2), np.int8)
    lists = [cells_by_piece(cells, m, i) for i in range(3)]
    room, parts = new_room(), []
    for i in range(3):
        for piece in range(m):
            found = passes_from(pieces, z, lists[i], told, i, piece, *args)
            parts.append(found)
            known = {}
            for x in range(lists[i].begin[piece], lists[i].begin[piece + 1]):
                cell = cells[lists[i].number[x]].astype(np.int64)
                for slot in range(pieces.ptr[piece], pieces.ptr[piece + 1]):
                    to = cell.copy()
                    to[i] = pieces.slot_neighbour[slot]
                    if to[i] > piece and tuple(to.tolist()) in number:
                        facet = facet_of(pieces, cell, i, slot)
                        value = pass_value(pieces, z, facet, *args, room).sigma
                        if value < np.inf:
                            ends = number[tuple(cell.tolist())], number[tuple(to.tolist())]
                            known[tuple(sorted(ends))] = value
            pairs = list(zip(found.lower.tolist(), found.upper.tolist(), strict=True))
            assert sorted(pairs) == sorted(known)
            values = np.array([known[pair] for pair in pairs])
            assert np.abs(values - found.sigma).max(initial=0.0) <= tiny
    passes = Passes(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    low, which = least_passes(len(cells), *passes)
    for k in range(len(cells)):
        mine = np.flatnonzero((passes.lower == k) | (passes.upper == k))
        assert low[k] == passes.sigma[mine].min(initial=np.inf)
        assert which[k] == (mine[np.argmin(passes.sigma[mine])] if len(mine) else -1)
    at_pass = (told[:, LEAST] == 1) & (low < np.inf)
    assert at_pass.sum() > 0.25 * len(cells)
    assert np.abs(low[at_pass] - born[at_pass]).max() <= tiny
    empty = (told[:, EMPTY] == 1) & (low == np.inf)
    assert (born[empty] == np.inf).all()
    isolated = np.flatnonzero((low == np.inf) & ~empty)
    finger, slot = np.full(len(cells), -1), np.full(len(cells), -1)
    low[(cells == cells[:, :1]).all(axis=1)] = 0.0
    walls = edges_that_lead_nowhere(pieces)
    assert walls.sum() == (pieces.slot_neighbour < 0).sum()
    before = low.copy()
    for i in range(3):
        for piece in range(m):
            lower_at_walls(
                pieces, z, lists[i], told, walls, low, finger, slot, i, piece, space.worst
            )
    least_of_isolated(pieces, z, cells, isolated, low, finger, slot, *args)
    certain = np.setdiff1d(np.arange(len(cells)), isolated)
    assert np.array_equal(low[certain] == np.inf, born[certain] == np.inf)
    held = certain[born[certain] < np.inf]
    assert np.abs(low[held] - born[held]).max() <= tiny
    assert ((finger >= 0) == (low < before)).all()
    assert (finger >= 0).sum() > 5
    for k in np.flatnonzero(finger >= 0):
        assert pieces.slot_neighbour[slot[k]] < 0
        facet = facet_of(pieces, cells[k].astype(np.int64), finger[k], slot[k])
        assert abs(pass_value(pieces, z, facet, *args, room).sigma - low[k]) <= tiny


def test_a_cell_without_a_pass_counts_if_two_fingers_tell_of_its_least_point() -> None:
    s = Setting(1)
    args = (s.space.cap, s.space.worst)
    cells = _every_cell(s.space)
    chosen = np.arange(0, len(cells), max(1, len(cells) // 40))
    low = np.full(len(cells), np.inf)
    finger, slot = np.full(len(cells), -1), np.full(len(cells), -1)
    least_of_isolated(s.pieces, s.z, cells, chosen, low, finger, slot, *args)
    room, told = new_room(), []
    for k in chosen:
        cell = cells[k].astype(np.int64)
        held = []
        for i in range(3):
            slots = range(s.pieces.ptr[cell[i]], s.pieces.ptr[cell[i] + 1])
            values = [
                pass_value(s.pieces, s.z, facet_of(s.pieces, cell, i, t), *args, room).sigma
                for t in slots
                if s.pieces.slot_neighbour[t] < 0
            ]
            held.append(min(values, default=np.inf))
        two = sum(h <= min(held) + 1e-9 * s.size for h in held) >= 2
        assert low[k] == (min(held) if two else np.inf)
        told.append(low[k] < np.inf)
        assert (finger[k] >= 0) == told[-1]
    assert 0 < sum(told) < len(told)


def test_few_rows_in_double_double_are_as_good_as_all() -> None:
    """On thin pieces, of which several meet in a vertex: doubles cannot tell that all rows hold."""
    angle = np.arange(120) * np.pi / 60.0
    radius = np.tile([1.0, 0.3], 60)
    vertices = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    space = FreeSpace.around(Outline(vertices), HandShape.from_angles_deg(60.0, 120.0))
    pieces, z = space.pieces, space.z
    bounds, rng = new_bounds(pieces), np.random.default_rng(2)
    seen = 0
    slots = rng.choice(np.flatnonzero(pieces.slot_neighbour >= 0), 3, replace=False)
    for slot in slots:
        piece = int(np.searchsorted(pieces.ptr, slot, side="right")) - 1
        segment = segment_between(pieces, piece, slot)
        put_bounds(pieces, z, segment, 0, bounds)
        narrow = 0
        for second, third in rng.integers(0, pieces.total, (4000, 2)):
            found = _least(pieces, bounds, second, third, space.cap, space.worst)
            if found.status != NARROW:
                continue
            facet = facet_of(pieces, np.array([piece, second, third]), 0, slot)
            few = confirmed(pieces, z, facet, bounds.slot, bounds.near, found)
            every = pass_careful(pieces, z, facet, 10.0 * space.cap, 0.0)
            if few.status == FOUND:
                assert every.status == FOUND
                gap = math.hypot(few.w_x - every.w_x, few.w_y - every.w_y)
                assert gap <= 1e-15 * pieces.diameter
                seen += 1
            narrow += 1
            if narrow == 8:
                break
    assert seen > 1


@pytest.mark.parametrize("seed", range(20))
def test_ends_of_basins_are_those_of_all_cells(seed: int) -> None:
    """Against the elder rule over all cells and passes in ascending order, ties included."""
    rng = np.random.default_rng([seed, 5])
    n, e = int(rng.integers(2, 40)), int(rng.integers(0, 120))
    lower, upper = rng.integers(0, n, (2, e)).astype(np.int32)
    apart = lower != upper
    lower, upper = lower[apart], upper[apart]
    sigma = rng.integers(5, 25, len(lower)) / 4.0 if seed % 2 else rng.uniform(1.0, 5.0, len(lower))
    low, which = least_passes(n, lower, upper, sigma)
    at_wall = rng.random(n) < 0.4
    low[at_wall] = np.minimum(low[at_wall], rng.integers(1, 9, at_wall.sum()) / 4.0)
    known = _elder_rule(low, lower, upper, sigma)
    basins = basins_of(low, which, lower, upper, sigma)
    assert (np.diff(basins.lowest) > 0).all()
    assert (low[basins.lowest[basins.of[low < np.inf]]] <= low[low < np.inf]).all()
    assert (basins.of[low == np.inf] == -1).all()
    forest = least_forest(basins.of, len(basins.lowest), lower, upper, sigma)
    assert (np.diff(forest) > 0).all()
    graph = coo_array((sigma, (basins.of[lower], basins.of[upper])), (n, n))
    least: dict[tuple[int, int], float] = {}
    for a, b, value in zip(graph.row.tolist(), graph.col.tolist(), sigma.tolist(), strict=True):
        if a != b:
            pair = min(a, b), max(a, b)
            least[pair] = min(value, least.get(pair, np.inf))
    if least:
        rows, columns = np.array(list(least)).T
        tree = minimum_spanning_tree(coo_array((list(least.values()), (rows, columns)), (n, n)))
        assert len(forest) == tree.nnz
        assert sigma[forest].sum() == pytest.approx(tree.sum())
    some = Passes(lower[forest], upper[forest], sigma[forest])
    order = np.argsort(some.sigma, kind="stable")
    ends = ends_of_basins(low, basins, *some, order)
    found = {
        int(cell): (merged, int(basins.lowest[elder]) if elder >= 0 else -1)
        for cell, merged, elder in zip(basins.lowest, ends.merged, ends.elder, strict=True)
        if merged > low[cell]
    }
    assert found == known


def _elder_rule(
    low: np.ndarray, lower: np.ndarray, upper: np.ndarray, sigma: np.ndarray
) -> dict[int, tuple[float, int]]:
    """Level at which a cell's component meets an older one, and whose, where above its birth."""
    component = np.arange(len(low))
    ended = {k: (np.inf, -1) for k in range(len(low)) if low[k] < np.inf}
    for e in np.argsort(sigma, kind="stable"):
        a, b = component[lower[e]], component[upper[e]]
        if a == b:
            continue
        # a component is called by its deepest cell, the first of equal ones
        keep, lose = (a, b) if (low[a], a) < (low[b], b) else (b, a)
        ended[int(lose)] = float(sigma[e]), int(keep)
        component[component == lose] = keep
    return {k: end for k, end in ended.items() if end[0] > low[k]}
