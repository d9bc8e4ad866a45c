"""Cages whose levels are known from geometry alone: no program gave these answers.

Regular n-gon of circumradius 1 with 3 a divisor of n, an equilateral hand on the middles of edges
120 degrees apart, fingers of radius r:

- sigma_0 = sqrt(3) (cos(pi/n) + r): the side of the triangle round a circle through the fingers;
- sigma_max = width + 2 r, the width being 1 + cos(pi/n) for odd n and 2 cos(pi/n) for even n: the
  object leaves between two fingers as soon as it fits between them the narrow way;
- sigma_first = min(sqrt(3) (1 + r), sigma_max): the object turns by one edge, and on the way the
  fingers stand on three vertices (for discs: each over the middle of its arc).
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.cage import Cage
from icage.contact_space.method import ContactSpace
from icage.discs.offsets import arcs
from icage.method import Method
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats
from tests.oracles.polygons import rotated

POINTS = (3, 6, 9, 12, 15, 18)
DISCS = [(n, r) for n in (3, 6, 9, 12) for r in (0.02, 0.1, 0.35, 0.9)]
MORE_DISCS = [(15, r) for r in (0.02, 0.1, 0.35, 0.9)]
EXACT = 1e-9


def ngon(n: int) -> Floats:
    turn = 2.0 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(turn), np.sin(turn)])


def middles(n: int, radius: float) -> Floats:
    """Finger centres over the middles of the edges 0, n/3 and 2n/3."""
    way = np.pi / n + 2.0 * np.pi * np.arange(3) / 3
    return (math.cos(math.pi / n) + radius) * np.column_stack([np.cos(way), np.sin(way)])


def levels(n: int, radius: float) -> tuple[float, float, float]:
    """sigma_0, sigma_first, sigma_max."""
    apothem = math.cos(math.pi / n)
    width = 1.0 + apothem if n % 2 else 2.0 * apothem
    last = width + 2.0 * radius
    first = math.sqrt(3.0) * (1.0 + radius)
    return math.sqrt(3.0) * (apothem + radius), min(first, last), last


def found(cage: Cage) -> tuple[float, float, float]:
    assert cage.status == "cage"
    assert cage.sigma_first is not None
    assert cage.sigma_max is not None
    return cage.sigma_0, cage.sigma_first, cage.sigma_max


@pytest.mark.parametrize("n", POINTS)
def test_points_on_a_regular_polygon(n: int) -> None:
    cage = plan(Outline(ngon(n)), middles(n, 0.0))
    assert found(cage) == pytest.approx(levels(n, 0.0), rel=EXACT)


@pytest.mark.parametrize("n", POINTS[:4])
def test_points_by_the_papers_method(n: int) -> None:
    method: Method = ContactSpace()
    cage = plan(Outline(ngon(n)), middles(n, 0.0), method=method)
    assert found(cage) == pytest.approx(levels(n, 0.0), rel=EXACT)


@pytest.mark.parametrize("n", POINTS[:4])
@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_points_turned_moved_and_scaled(n: int, unit: float) -> None:
    ring, contacts = (unit * rotated(p, 0.7, (3.0, -2.0)) for p in (ngon(n), middles(n, 0.0)))
    cage = plan(Outline(ring), contacts)
    assert np.array(found(cage)) / unit == pytest.approx(levels(n, 0.0), rel=EXACT)


@pytest.mark.parametrize("n", POINTS[1:4])
def test_all_grasps_below_the_escape_are_turned_copies(n: int) -> None:
    """Where turning by an edge is easier than leaving, every other grasp has the same sigma_0."""
    sigma_0, first, last = levels(n, 0.0)
    cage = plan(Outline(ngon(n)), middles(n, 0.0))
    three = [g for g in cage.grasps if not g.free_fingers]
    assert [g.sigma for g in three] == pytest.approx([sigma_0] * len(three), rel=EXACT)
    # a finger that starts on edge e can stand on any of the n, so n grasps and no more
    assert len(three) == (n if first < last * (1.0 - EXACT) else 1)


@pytest.mark.parametrize(
    ("n", "radius"), [*DISCS, *(pytest.param(*d, marks=pytest.mark.slow) for d in MORE_DISCS)]
)
def test_discs_on_a_regular_polygon(n: int, radius: float) -> None:
    """Edges carry the target, arcs the way to its neighbours, an arc and an edge the escape."""
    cage = plan(Outline(ngon(n)), middles(n, radius), radius)
    right = levels(n, radius)
    assert found(cage) == pytest.approx(right, rel=EXACT)
    assert cage.sigma_max_lower is not None
    assert cage.sigma_max_upper is not None
    assert cage.sigma_max_lower <= right[2] * (1.0 + EXACT)
    assert cage.sigma_max_upper >= right[2] * (1.0 - EXACT)
    assert cage.sigma_max_upper / cage.sigma_max_lower - 1.0 < 1e-4
    assert cage.sigma_first_converged
    assert not cage.warnings
    three = [g for g in cage.grasps if not g.free_fingers]
    assert [g.sigma for g in three] == pytest.approx([right[0]] * len(three), rel=EXACT)
    assert len(three) == (n if right[1] < right[2] * (1.0 - EXACT) else 1)


@pytest.mark.parametrize(("n", "radius"), [(3, 0.1), (6, 0.35)])
def test_discs_by_the_papers_method(n: int, radius: float) -> None:
    method: Method = ContactSpace()
    cage = plan(Outline(ngon(n)), middles(n, radius), radius, method)
    assert found(cage) == pytest.approx(levels(n, radius), rel=EXACT)


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_discs_turned_moved_and_scaled(unit: float) -> None:
    ring, contacts = (unit * rotated(p, 0.7, (30.0, -20.0)) for p in (ngon(9), middles(9, 0.1)))
    cage = plan(Outline(ring), contacts, 0.1 * unit)
    assert np.array(found(cage)) / unit == pytest.approx(levels(9, 0.1), rel=EXACT)


@pytest.mark.parametrize("n", [3, 6, 9, 12])
def test_the_arcs_of_a_regular_polygon_turn_a_full_circle(n: int) -> None:
    found_arcs = arcs(Outline(ngon(n)), 0.1)
    assert [a.turn for a in found_arcs] == pytest.approx([2.0 * np.pi / n] * n, abs=1e-12)


def test_a_planted_change_is_seen() -> None:
    ring = ngon(9)
    ring[0] *= 1.0 + 1e-6
    assert found(plan(Outline(ring), middles(9, 0.0))) != pytest.approx(levels(9, 0.0), rel=EXACT)
