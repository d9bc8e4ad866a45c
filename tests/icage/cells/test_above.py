"""Bounds of levels on a slightly larger polygon: as a search of it, with a way that is free."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from icage.cells.free_space import FreeSpace
from icage.cells.method import CELLS, CellsLocalCage
from icage.discs.curve import TrueCurve
from icage.geometry.exterior import pieces_beside
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.targets import Target, random_target

SEEDS = range(12)
REACH, TURN = 1e-3, 1e-2


@cache
def drawn(seed: int) -> Target:
    return random_target(np.random.default_rng([seed, 8]), radius=0.03)


def both(seed: int) -> tuple[np.ndarray, Outline, CellsLocalCage | None]:
    """Contacts on the true curve, tangents through those of all levels, and what the chords below
    them hold.
    """
    target = drawn(seed)
    cage = plan(Outline(target.vertices), target.contacts, target.radius)
    curve = TrueCurve.of(cage.outline, target.radius)
    touched = np.vstack([cage.contacts, *(p.contacts for p in cage.punctures)])
    tangents, chords = curve.outer_and_inner(8, curve.on_arcs(touched))
    hand = HandShape.from_contacts(cage.contacts)
    found = CELLS.local_cage(chords, hand, cage.contacts, REACH, TURN, tangents)
    return cage.contacts, tangents, found


@pytest.mark.parametrize("seed", SEEDS)
def test_the_bound_is_what_a_search_finds(seed: int) -> None:
    contacts, tangents, inner = both(seed)
    if inner is None or not inner.found.escaped:
        pytest.skip("no bound is asked for")
    hand = HandShape.from_contacts(contacts)
    whole = CELLS.local_cage(tangents, hand, contacts, REACH, TURN)
    assert whole is not None
    first = whole.sigma_first if whole.sigma_first < whole.sigma_max else np.inf
    bound = inner.bound_above(tangents, contacts, first)
    if bound is None:
        return
    # never below what a search finds; here it is that
    assert bound.sigma_max == pytest.approx(whole.sigma_max, rel=1e-9)
    assert bound.sigma_max >= whole.sigma_max * (1.0 - 1e-12)
    if np.isfinite(first):
        assert bound.sigma_first == pytest.approx(first, rel=1e-12)
    way, gap = bound.escape_path()
    assert gap >= 0.0
    assert way[:, 3].max() == pytest.approx(bound.sigma_max, rel=1e-12)
    assert way[0, 3] == pytest.approx(np.hypot(*(contacts[1] - contacts[0])), rel=1e-12)
    assert way[-1, 3] == 0.0
    fingers = np.stack([hand.fingers(row) for row in way])
    smaller = tangents.polygon.buffer(-1e-9 * tangents.diameter)
    for k in range(3):
        assert not shapely.LineString(fingers[:, k]).intersects(smaller)


def test_most_bounds_take_no_search() -> None:
    told = [
        found.bound_above(tangents, contacts, np.inf) is not None
        for contacts, tangents, found in map(both, SEEDS)
        if found is not None and found.found.escaped
    ]
    assert sum(told) >= 0.7 * len(told) > 4


def test_pieces_that_would_be_bent_are_named() -> None:
    """A corner that is pushed far out bends what is beside it, and only that."""
    square = Outline([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 4.0], [2.0, 3.0], [0.0, 3.0]])
    hand = HandShape.from_contacts(np.array([[0.0, 1.0], [2.0, 0.0], [4.0, 1.0]]))
    space = FreeSpace.around(square, hand)
    same = pieces_beside(space.pieces, square, hand)
    assert same is not None
    assert not same.bent.any()
    assert (same.pieces.x == space.pieces.x).all()
    assert np.allclose(same.pieces.normal_y, space.pieces.normal_y, rtol=0.0, atol=1e-15)
    corners = square.vertices.copy()
    corners[4] = [1.0, 3.9]  # the concave corner, past the line of its neighbours
    pushed = pieces_beside(space.pieces, Outline(corners), hand)
    assert pushed is not None
    beside = [
        k for k in range(space.pieces.total)
        if 4 + 4 in space.pieces.slot_vertex[space.pieces.ptr[k] : space.pieces.ptr[k + 1]]
    ]  # fmt: skip
    assert pushed.bent.any()
    assert set(np.flatnonzero(pushed.bent).tolist()) <= set(beside)
    # another number of corners, or one too large for the box: no pieces
    assert pieces_beside(space.pieces, Outline(corners[[0, 1, 2, 3, 5]]), hand) is None
    assert pieces_beside(space.pieces, Outline(3.0 * square.vertices), hand) is None
