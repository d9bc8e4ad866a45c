"""All grasps of one hand, against the minima of an oracle."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.cells.free_space import Configuration, FreeSpace
from icage.cells.kernels.tree import lowest_cells
from icage.cells.target import is_local_minimum, is_strict_minimum, plateau_through
from icage.discs.offsets import offsets
from icage.errors import InputError
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.planned import planned_grasps_of_hand
from icage.grasps.wanted import Wanted
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from icage.tolerance import DEPTH_CUT
from tests.icage.grasps.small_outlines import RADIUS, SMALL, found
from tests.oracles.geometry import Floats, Ring
from tests.oracles.minima import all_minima
from tests.oracles.polygons import random_polygon, rotated


def unmatched(some: list[Floats], others: list[Floats], within: float) -> list[Floats]:
    return [a for a in some if not any(np.abs(a - b).max() <= within for b in others)]


def check_all_of(ring: Ring, hand: HandShape) -> int:
    strict = [m.contacts for m in all_minima(ring, hand.z) if not m.plateau]
    told = grasps_of_hand(Outline(ring.vertices), hand)
    within = 1e-7 * ring.diameter
    assert unmatched(told, strict, within) == []
    assert unmatched(strict, told, within) == []
    sigma = [float(np.hypot(*(c[1] - c[0]))) for c in told]
    assert np.diff(sigma).min(initial=0.0) >= -1e-9 * ring.diameter
    return len(told)


@pytest.mark.parametrize("name", SMALL)
def test_all_grasps_of_a_hand_on_small_outlines(name: str) -> None:
    """The hands of the best grasps, so that each has at least its own."""
    ring = Ring.of(SMALL[name])
    for grasp in found(name, "first")[:2]:
        hand = HandShape.from_contacts(grasp.contacts)
        assert check_all_of(ring, hand) >= 1
        told = grasps_of_hand(Outline(ring.vertices), hand)
        held = plan(Outline(ring.vertices), grasp.contacts).contacts
        assert unmatched([held], told, 1e-7 * ring.diameter) == []


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.floats(-0.3, 1.3), st.floats(0.3, 1.5), st.integers(3, 7))
def test_all_grasps_of_any_hand_on_random_polygons(
    seed: int, x: float, y: float, corners: int
) -> None:
    check_all_of(
        Ring.of(random_polygon(np.random.default_rng(seed), corners)), HandShape(complex(x, y))
    )


@pytest.mark.parametrize("name", ["triangle", "notched"])
def test_all_grasps_of_a_hand_on_a_grown_outline(name: str) -> None:
    """Discs: the polygon that stands for the grown object, its chords as edges like all others."""
    outline = Outline(SMALL[name])
    grown = offsets(outline, RADIUS * outline.diameter, 1).inner
    hand = HandShape.from_contacts(found(name, "first", RADIUS)[0].contacts)
    assert check_all_of(Ring.of(grown.vertices), hand) >= 1


@pytest.mark.parametrize("name", ["triangle", "notched", "L", "hour glass"])
@pytest.mark.parametrize("first", [1, 2])
def test_another_finger_first_gives_the_same_grasps(name: str, first: int) -> None:
    outline = Outline(SMALL[name])
    hand = HandShape.from_contacts(found(name, "first")[0].contacts)
    one = [np.roll(c, -first, axis=0) for c in grasps_of_hand(outline, hand)]
    other = grasps_of_hand(outline, hand.relabelled(first))
    within = 1e-8 * outline.diameter
    assert unmatched(one, other, within) == unmatched(other, one, within) == []


@pytest.mark.parametrize("name", ["triangle", "notched", "hour glass"])
def test_a_turned_outline_has_the_turned_grasps(name: str) -> None:
    hand = HandShape.from_contacts(found(name, "first")[0].contacts)
    one = [rotated(c, 2.0, (5.0, 1.0)) for c in grasps_of_hand(Outline(SMALL[name]), hand)]
    turned = Outline(rotated(SMALL[name], 2.0, (5.0, 1.0)))
    other = grasps_of_hand(turned, hand)
    within = 1e-8 * turned.diameter
    assert unmatched(one, other, within) == unmatched(other, one, within) == []


@pytest.mark.parametrize("phi", [(60.0, 120.0), (100.0, 110.0)])
def test_a_minimum_is_strict_where_no_plateau_goes_through_it(phi: tuple[float, float]) -> None:
    """Chords of a square's arcs are parallel in pairs: most least points of cells can slide."""
    hand = HandShape.from_angles_deg(*phi)
    square = Outline([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    space = FreeSpace.around(offsets(square, 0.14, 4).inner, hand)
    size = space.pieces.diameter
    lowest = lowest_cells(space.pieces, space.z, space.cap, space.worst, 1e-9, DEPTH_CUT * size)
    seen = Counter[bool]()
    for k in range(len(lowest.cells)):
        sigma, wx, wy = lowest.birth[k].tolist()
        ends = space.on_edge(lowest.cells[k], *lowest.birth_at[k].tolist(), wx, wy)
        here = Configuration(0.5 * (ends[0].d + ends[1].d), complex(wx, wy))
        strict = is_strict_minimum(space, here, sigma)
        seen[strict] += 1
        assert strict == (
            is_local_minimum(space, here, sigma) and plateau_through(space, here, sigma) is None
        )
    assert seen[False] > 3
    assert seen[True] > 5 or phi[0] > 90.0


def test_grasps_of_discs_at_one_place_are_told_once() -> None:
    """Next to each grasp on a square's arcs several chords have one of their own."""
    hand = HandShape.from_angles_deg(60.0, 120.0)
    square = Outline([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    candidates = grasps_of_hand(square, hand, 0.14)
    found = planned_grasps_of_hand(square, 0.14, hand, candidates, Wanted())
    assert len(found.cages) == 12
    assert sum(found.alike) + len(found.cages) + len(found.failures) == len(candidates)
    assert min(found.alike) > 0
    for one, other in combinations(found.cages, 2):
        assert np.abs(one.contacts - other.contacts).max() > 1e-3
    turned = [rotated(cage.contacts, 0.5 * np.pi, (1.0, 0.0)) for cage in found.cages]
    assert unmatched(turned, [cage.contacts for cage in found.cages], 1e-8) == []


def test_too_many_pieces_are_refused() -> None:
    turn = 2.0 * np.pi * np.arange(700) / 700
    size = np.where(np.arange(700) % 2, 1.0, 0.9)[:, None]
    gear = Outline(size * np.column_stack([np.cos(turn), np.sin(turn)]))
    with pytest.raises(InputError, match=r"needs \d+ pieces; up to 250 are allowed"):
        grasps_of_hand(gear, HandShape.from_angles_deg(60.0, 120.0))
