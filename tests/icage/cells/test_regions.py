"""Caging regions against placements, and against slices of the space at fixed theta and sigma."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely import Polygon

from icage.cells.membership import query
from icage.cells.regions import FingerRegion, caging_regions, outer_bounds
from tests.icage.cells.wandering import Solved, solved, wander
from tests.oracles.geometry import Floats

NAMES = (
    "T_best", "L_best", "triangle_eq_best", "cross_multi", "hook_deep_multi", "notched_bar_best",
    "handsaw_best", "pliers_best", "rand16_best", "disc_hammer",
)  # fmt: skip
SLICED = ("T_best", "L_best", "triangle_eq_best", "cross_multi", "notched_bar_best")


def regions_of(case: Solved) -> dict[tuple[int, str], FingerRegion]:
    return {(r.finger, r.bound): r for r in caging_regions(case.cage)}


@pytest.mark.parametrize("name", NAMES)
def test_fingers_of_caged_placements_are_in_the_outer_regions(name: str) -> None:
    case = solved(name)
    placements = wander(case.cage, ("target", "caged"), np.random.default_rng(21), 200)
    below = placements[:, 3] < case.cage.sigma_max * (1.0 - 2e-9)
    fingers = case.cage.hand.fingers(placements[below])
    regions = regions_of(case)
    for finger in range(3):
        outer = regions[finger + 1, "outer"].geometry
        points = shapely.points(fingers[:, finger])
        assert shapely.distance(outer, points).max() <= 2e-8 * case.ring.diameter


@pytest.mark.parametrize("name", NAMES)
def test_the_area_gap_is_honest(name: str) -> None:
    case = solved(name)
    regions = regions_of(case)
    assert len(regions) == 6
    for finger in (1, 2, 3):
        inner, outer = regions[finger, "inner"], regions[finger, "outer"]
        beyond = inner.geometry.difference(outer.geometry).area
        assert beyond <= 1e-7 * outer.geometry.area
        gap = 1.0 - inner.geometry.area / outer.geometry.area
        assert inner.area_gap == outer.area_gap
        assert gap <= inner.area_gap * (1.0 + 1e-9) + 1e-12
        assert inner.area_gap <= 1e-3
        assert inner.level_name == "sigma_max"
        if not case.cage.finger_radius:
            inside = inner.geometry.intersection(case.ring.polygon).area
            assert inside <= 1e-6 * inner.geometry.area


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("gap", [0.02, 1e-3])
def test_outer_bounds_alone_hold_the_regions(name: str, gap: float) -> None:
    case = solved(name)
    bounds = outer_bounds(case.cage, None, gap)
    regions = regions_of(case)
    assert len(bounds) == 3
    for finger, bound in enumerate(bounds, start=1):
        inner = regions[finger, "inner"].geometry
        assert inner.difference(bound.buffer(4e-9 * case.ring.diameter)).area <= 1e-7 * inner.area
        assert bound.area <= 1.1 * regions[finger, "outer"].geometry.area


@pytest.mark.parametrize("name", SLICED)
def test_points_of_the_inner_regions_are_reached(name: str) -> None:
    """Some hand below sigma_max has its finger there: tried on a grid of theta and sigma."""
    case = solved(name)
    cage, rng = case.cage, np.random.default_rng(22)
    theta = np.linspace(-np.pi, np.pi, 361)[:-1]
    sigma = np.linspace(0.02, 1.0, 40)[1:] ** 0.5 * cage.sigma_max * (1.0 - 1e-6)
    turn, size = (g.ravel() for g in np.meshgrid(theta, sigma))
    regions = regions_of(case)
    for finger in range(3):
        inner = regions[finger + 1, "inner"].geometry
        # close to the rim few of all theta and sigma do: keep off it by what the grid can see
        for point in points_in(inner.buffer(-0.015 * case.ring.diameter), rng, 6):
            arm = size * np.exp(1j * turn) * cage.hand.z[finger]
            rows = np.column_stack([point[0] - arm.real, point[1] - arm.imag, turn, size])
            assert query(cage, rows).in_cage.any()


@pytest.mark.parametrize(
    "name", [SLICED[0], *(pytest.param(name, marks=pytest.mark.slow) for name in SLICED[1:])]
)
def test_slices_fill_the_regions_from_inside(name: str) -> None:
    """Bounded pockets of (x, y) at fixed theta and sigma: exact polygons, an inner bound."""
    case = solved(name)
    cage = case.cage
    ring = case.ring.polygon
    pockets: list[list[shapely.Geometry]] = [[], [], []]
    seen = wander(cage, ("target", "caged"), np.random.default_rng(23), 150, steps=160)[:, 2]
    low, high = seen.min() - 0.1 * np.ptp(seen), seen.max() + 0.1 * np.ptp(seen)
    least = min(cage.sigma_0, *(g.sigma for g in cage.grasps))
    for sigma in np.linspace(least, cage.sigma_max * (1.0 - 1e-8), 11)[1:]:
        for theta in np.linspace(low, high, 100):
            w = sigma * np.exp(1j * theta)
            for pocket in free_pockets(ring, w * cage.hand.z):
                inside = pocket.representative_point()
                row = np.array([[inside.x, inside.y, theta, sigma]])
                if not query(cage, row).in_cage[0]:
                    continue
                for k in range(3):
                    move = w * cage.hand.z[k]
                    shift = np.array([move.real, move.imag])
                    pockets[k].append(shapely.transform(pocket, lambda xy, s=shift: xy + s))
    regions = regions_of(case)
    for k in range(3):
        filled = shapely.union_all(pockets[k])
        outer, inner = regions[k + 1, "outer"].geometry, regions[k + 1, "inner"].geometry
        assert filled.difference(outer.buffer(1e-8 * case.ring.diameter)).area <= 1e-9 * outer.area
        assert filled.area >= 0.8 * inner.area


def free_pockets(ring: Polygon, arms: np.ndarray) -> list[Polygon]:
    """Bounded free parts of the positions d of a hand whose fingers are at d + arms."""
    shifts = np.column_stack([arms.real, arms.imag])
    union = shapely.union_all([shapely.transform(ring, lambda xy, s=s: xy - s) for s in shifts])
    return [
        Polygon(hole)
        for part in shapely.get_parts(union)
        for hole in part.interiors
        if Polygon(hole).area > 1e-9 * ring.area
    ]


def points_in(region: shapely.Geometry, rng: np.random.Generator, count: int) -> Floats:
    """``count`` uniform points of a region, (count, 2); none if it is empty."""
    if region.is_empty:
        return np.zeros((0, 2))
    low_x, low_y, high_x, high_y = region.bounds
    tried = rng.uniform((low_x, low_y), (high_x, high_y), (20_000, 2))
    return tried[shapely.contains_xy(region, tried[:, 0], tried[:, 1])][:count]
