"""Discs that can go straight away from an outline, against distances of drawn rays."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from icage.contacts import _check_pockets
from icage.geometry.kernels.ways_off import _clear_ahead, _off_nearest, all_can_leave
from icage.outline import Outline
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


def star(rng: np.random.Generator, corners: int) -> Floats:
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
    return np.column_stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.3, 1.0, corners)[:, None]


@pytest.mark.parametrize("seed", range(12))
def test_a_ray_is_clear_if_it_is_as_far_from_the_outline(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ring = star(rng, 3 + 2 * seed) if seed else np.array([[0, 0], [2, 0], [2, 1], [0, 1]], float)
    edges = shapely.LinearRing(ring)
    x, y = ring.T.copy()
    seen = {True: 0, False: 0}
    for _ in range(80):
        at, reach = rng.uniform(-1.5, 1.5, 2), rng.uniform(0.01, 0.4)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        if seed == 0:  # along the axes, edges abreast of the beginning
            at, angle, reach = np.round(at), 0.5 * math.pi * rng.integers(4), 0.75
        way = np.round([math.cos(angle), math.sin(angle)], 15)
        gap = float(shapely.LineString([at, at + 9.0 * way]).distance(edges))
        if abs(gap - reach) > 1e-9:
            clear = bool(_clear_ahead(x, y, *at, *way, reach))
            assert clear == (gap > reach)
            seen[clear] += 1
    assert min(seen.values()) > 2


def test_an_edge_that_begins_abreast_is_not_cut_off() -> None:
    x, y = np.array([0.0, 3.0, 3.0, 0.0]), np.array([1.0, 0.0, 2.0, 2.0])
    assert not _clear_ahead(x, y, 0.0, 0.0, 1.0, 0.0, 0.5)
    assert not _clear_ahead(x[::-1].copy(), y[::-1].copy(), 0.0, 0.0, 1.0, 0.0, 0.5)
    assert _clear_ahead(x, y, 0.0, 0.0, -1.0, 0.0, 0.5)


def test_straight_off_the_nearest_place() -> None:
    rng = np.random.default_rng(9)
    ring = star(rng, 15)
    edges = shapely.LinearRing(ring)
    for at in rng.uniform(-1.5, 1.5, (30, 2)):
        way = np.array(_off_nearest(*ring.T.copy(), *at))
        near = shapely.get_coordinates(shapely.shortest_line(shapely.Point(at), edges))
        assert near[0] - way * np.hypot(*(near[0] - near[1])) == pytest.approx(near[1], abs=1e-12)
    assert _off_nearest(*ring.T.copy(), *ring[3]) == (0.0, 0.0)


def test_who_stands_in_a_closed_pocket_cannot_leave() -> None:
    """A chamber behind a neck of 0.4: discs of less than 0.2 could go out, but not all straight."""
    chamber = np.array(
        [[0, 0], [4, 0], [4, 3], [2.2, 3], [2.2, 2], [3, 2], [3, 1], [1, 1], [1, 2], [1.8, 2],
         [1.8, 3], [0, 3]], float,
    )  # fmt: skip
    x, y = chamber.T.copy()
    outside, under, beside = [2.0, -0.25], [2.0, 1.25], [1.25, 1.25]
    for places, reach, leave in (
        ([outside], 0.24, True),
        ([under], 0.24, False),
        ([under], 0.19, True),  # straight up, through the neck
        ([beside], 0.19, False),  # not straight
        ([outside, under], 0.24, False),
        ([outside, [-0.25, 1.0]], 0.24, True),
    ):
        assert all_can_leave(x, y, np.array(places), reach, 1e-7) == leave
    # a disc that is wedged between two edges leaves by another direction than off the nearest one
    notch = np.array([[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]], float)
    assert all_can_leave(*notch.T.copy(), np.array([[1.0, 1.2]]), 0.3, 1e-7)


def test_a_fine_hollow_is_no_pocket() -> None:
    """The library simplifies an outline before it grows it, and may fill hollows by that."""
    rng = np.random.default_rng(1635)
    corners = star(rng, int(rng.integers(5, 14)))
    grown = shapely.Polygon(corners).buffer(0.05, quad_segs=32)
    assert isinstance(grown, shapely.Polygon)
    ring = shapely.get_coordinates(shapely.orient_polygons(grown).exterior)[:-1]
    outline, radius = Outline(ring), 0.4
    side = np.roll(ring, -1, axis=0) - ring
    out = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
    centres = ring + 0.5 * side + radius * out
    angle = np.arctan2(out[:, 1:], out[:, :1]) + 2.0 * np.pi * np.arange(16) / 16
    way = np.stack([np.cos(angle), np.sin(angle)], axis=2)
    rays = shapely.linestrings(np.stack([centres[:, None] + t * way for t in (0.0, 9.0)], axis=2))
    gap = np.asarray(shapely.distance(rays, outline.polygon)).max(axis=1)
    free = np.flatnonzero(gap > radius - 1e-12)  # nothing is in the way, in some direction
    assert len(free) > 50
    for k in free.tolist():
        _check_pockets(outline, centres[[k, k, k]], radius, "")
