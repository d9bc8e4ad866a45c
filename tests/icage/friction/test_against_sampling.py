"""The least far jam beside brute force, and faults that brute force has to see."""

from __future__ import annotations

import numpy as np
import pytest

import icage
from icage.friction import jam_search
from icage.friction.contacts import Contacts, contacts_of
from icage.geometry.exterior import Pieces
from icage.outline import Outline
from icage.planner import plan
from tests.icage.friction.beside_sampling import (
    Compared,
    compared,
    compared_disc,
    compared_on,
    drawn,
    drawn_round,
)

TOOLS = {
    "saw": [
        [449.4637915733793, 59.19175003076005],
        [339.63148923080416, 105.10441218066889],
        [344.6192616012874, 28.95647144901392],
    ],
    "wrench": [
        [114.7771133524764, 118.91298975507776],
        [58.68164060734225, 139.97480043881086],
        [80.28326899604164, 85.32687814486496],
    ],
    "pliers": [
        [35.48587539910406, 52.79354102982568],
        [60.10197535453722, 24.975239805799745],
        [70.14564620996693, 53.860564582604404],
    ],
}
"""The grasps by point fingers that `icage grasps` lists first, [mm]."""

FEW = range(63)
MANY = range(63, 143)
FEW_DISCS = range(14, 26)
MANY_DISCS = range(26, 56)


def wrong(seeds: range) -> dict[int, Compared]:
    results = {seed: compared(seed) for seed in seeds}
    return {seed: result for seed, result in results.items() if not result.agrees}


def test_levels_agree_with_sampling() -> None:
    assert wrong(FEW) == {}


def wrong_discs(seeds: range) -> dict[int, Compared]:
    results = {seed: compared_disc(seed) for seed in seeds}
    return {seed: result for seed, result in results.items() if result and not result.agrees}


def test_levels_of_discs_agree_with_sampling() -> None:
    assert wrong_discs(FEW_DISCS) == {}


@pytest.mark.slow
@pytest.mark.first
@pytest.mark.parametrize("part", range(2))
def test_levels_of_many_discs_agree_with_sampling(part: int) -> None:
    assert wrong_discs(MANY_DISCS[part::2]) == {}


@pytest.mark.parametrize("seed", range(8))
def test_levels_on_round_objects_agree_with_sampling(seed: int) -> None:
    target, mu = drawn_round(seed)
    result = compared_on(target.vertices, target.contacts, mu, an_edge=7)
    assert result.agrees, result


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.02, 0.1, 0.15, 0.4])
@pytest.mark.parametrize("name", TOOLS)
def test_levels_on_the_tools_agree_with_sampling(name: str, mu: float) -> None:
    case = icage.load(name)
    result = compared_on(case.outline.vertices, np.array(TOOLS[name]), mu, an_edge=15)
    assert result.agrees, result


@pytest.mark.slow
@pytest.mark.first
def test_levels_of_many_targets_agree_with_sampling() -> None:
    assert wrong(MANY) == {}


def test_a_cone_half_as_wide_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jam_search, "contacts_of", lambda pieces, mu: contacts_of(pieces, 0.5 * mu))
    assert wrong(range(14))


def test_a_cone_twice_as_wide_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jam_search, "contacts_of", lambda pieces, mu: contacts_of(pieces, 2.0 * mu))
    assert wrong(range(14))


def test_a_missing_third_finger_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    every = jam_search.touching_subsets
    monkeypatch.setattr(
        jam_search, "touching_subsets", lambda n: every(n)[every(n).sum(axis=1) == 2]
    )
    assert wrong(range(14))


def test_missing_pairs_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    every = jam_search.touching_subsets
    monkeypatch.setattr(
        jam_search, "touching_subsets", lambda n: every(n)[every(n).sum(axis=1) == 3]
    )
    assert wrong(range(14))


def test_missing_concave_vertices_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jam_search, "contacts_of", lambda *asked: _without(False, *asked))
    assert wrong(range(28))


def test_a_puncture_is_a_jam_just_above_the_first_level(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is an equilibrium, though no stable one, and below it a far jam may come before."""
    monkeypatch.setattr(jam_search, "LEVEL", -jam_search.LEVEL)
    assert _without_a_jam(range(42)) == []


def test_missing_convex_vertices_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Below the first level such jams are rare: there only a puncture balances on a vertex."""
    monkeypatch.setattr(jam_search, "LEVEL", -jam_search.LEVEL)
    monkeypatch.setattr(jam_search, "contacts_of", lambda *asked: _without(True, *asked))
    assert _without_a_jam(range(42))


def _without_a_jam(seeds: range) -> list[int]:
    """Targets whose first level is no jam for very little friction."""
    found: list[int] = []
    for seed in seeds:
        target, _ = drawn(seed)
        cage = plan(Outline(target.vertices), target.contacts)
        if cage.sigma_first is not None and cage.friction(1e-3).jam is None:
            found.append(seed)
    return found


def _without(convex: bool, pieces: Pieces, mu: float) -> Contacts:
    """The features without the object's convex or concave vertices."""
    contacts = contacts_of(pieces, mu)
    concave = _concave(pieces)
    is_vertex = (contacts.place[:, 2:] == 0.0).all(axis=1)
    at_concave = np.array([tuple(p) in concave for p in contacts.place[:, :2].tolist()], dtype=bool)
    keep = ~(is_vertex & (at_concave != convex))
    ptr = np.concatenate([[0], np.cumsum(keep)])[contacts.ptr]
    return Contacts(ptr.astype(np.int64), contacts.place[keep], contacts.cone[keep])


def _concave(pieces: Pieces) -> set[tuple[float, float]]:
    """Places of the object's concave vertices."""
    into = dict(zip(pieces.wall_to.tolist(), pieces.wall_from.tolist(), strict=True))
    out = dict(zip(pieces.wall_from.tolist(), pieces.wall_to.tolist(), strict=True))
    found = set[tuple[float, float]]()
    for v in out:
        a, b, c = (complex(pieces.x[k], pieces.y[k]) for k in (into[v], v, out[v]))
        # walls run clockwise round the object: a left turn is a concave vertex
        if ((b - a).conjugate() * (c - b)).imag > 0.0:
            found.add((b.real, b.imag))
    return found
