"""The caging regions of the fingers: where each may be below a level.

[Bunis2018, Sec. III-B, Sec. VI]. Every configuration of the target's component below the level puts
finger i into its region, and every point of the region is reached by one. The converse, "each
finger in its region and sigma below the level", is the paper's condition: nearly always right and
not always (docs/paper_map.md); the joint query is the authority.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.arrays import FloatArray, IntArray
from icage.cage import Cage
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.columns import BIRTH_SIGMA, BIRTH_WX, BIRTH_WY, BORN_FINGER, BORN_SLOT
from icage.cells.kernels.region import all_sandwiches, least_points
from icage.cells.work import CageWork, work_of
from icage.errors import InputError
from icage.geometry.geos import union
from icage.geometry.near_frame import NearFrame
from icage.library_faults import geometry_told
from icage.tolerance import REGION_LEVEL

Polygons: TypeAlias = NDArray[np.object_]
"""Polygons of shapely, (n,)."""

_ROUGH = 3e-6
"""[diameter^2] The area of a cell's inner and outer polygon never differs by more than this."""
_SHARE = 0.3
"""[1] First try at that difference, over the wanted gap times the largest of the first few sets:
most regions then are within the gap at once, and tight sets hide more of each other."""
_FIRST_FEW = 64
_REFINEMENTS = 6
_SLACK = 1e-7
"""[diameter] A set that another covers but for this is left out."""
_GRID = 1e-9
"""[diameter] Neighbouring cells meet on a common edge: unions are noded on this grid."""
_FINEST_GRID = 1e-14
"""[diameter] No grid is finer: below it there is only the rounding of coordinates."""
_GRID_SHARE = 1e-3
"""[1] A grid moves a boundary by less than this share of the gap that is asked for."""


@dataclass(frozen=True, slots=True)
class FingerRegion:
    """The caging region of one finger (1..3) at a level, between two certified bounds.

    ``area_gap`` = (area of the outer bound - area of the inner) / area of the outer.
    """

    finger: int
    level_name: str
    level: float
    bound: Literal["inner", "outer"]
    area_gap: float
    geometry: shapely.MultiPolygon


@geometry_told()
def caging_regions(
    cage: Cage, level: float | None = None, gap: float = 1e-3
) -> tuple[FingerRegion, ...]:
    """Inner and outer bounds of the regions of all fingers (two for each, inner first).

    Parameters
    ----------
    level:
        sigma below which the hand stays, [unit]; None for sigma_max (everything, for a hand that
        never escapes).
    gap:
        Wanted relative difference of area between the two bounds. In a region so thin that
        doubles cannot resolve it more is left; ``area_gap`` tells.

    Raises
    ------
    InputError:
        The level is not between sigma_0 and sigma_max, or the gap not in (0, 1).
    """
    work = work_of(cage)
    if work is None:
        return ()
    chosen, below = _levels(cage, work, level, gap)
    name = _level_name(cage, chosen)
    regions: list[FingerRegion] = []
    back = NearFrame.of(cage.outline).back
    for finger in range(len(cage.hand.z)):
        *bounds, found = _bounds(work, finger, below, gap)
        inner, outer = (shapely.transform(bound, back) for bound in bounds)
        regions.append(FingerRegion(finger + 1, name, chosen, "inner", found, inner))
        regions.append(FingerRegion(finger + 1, name, chosen, "outer", found, outer))
    return tuple(sorted(regions, key=lambda r: (r.bound != "inner", r.finger)))


@geometry_told()
def outer_bounds(
    cage: Cage, level: float | None = None, gap: float = 1e-3
) -> tuple[shapely.MultiPolygon, ...]:
    """The outer bounds alone, at a third of the price: nobody checks that they are within ``gap``.

    They hold the regions as surely as those of ``caging_regions``. Raises what it raises.
    """
    work = work_of(cage)
    if work is None:
        return ()
    _, below = _levels(cage, work, level, gap)
    size = work.search.free_space.pieces.diameter
    bounds: list[shapely.MultiPolygon] = []
    back = NearFrame.of(cage.outline).back
    for finger in range(len(cage.hand.z)):
        nodes, points = _cells_and_points(work, finger, below)
        enough = _first_try(work, finger, below, gap, nodes, points)
        _, around = _sandwiches(work, finger, below, enough, nodes, points)
        bound = _union(work.search.free_space, around, _grid(around, gap, size))
        bounds.append(shapely.transform(bound, back))
    return tuple(bounds)


def _levels(cage: Cage, work: CageWork, level: float | None, gap: float) -> tuple[float, float]:
    """The level asked for, checked, and the one just below it that is computed with."""
    if not 0.0 < gap < 1.0:
        raise InputError(f"area gap {gap}; a number between 0 and 1 is needed")
    top = cage.sigma_max if cage.sigma_max is not None else work.search.free_space.cap
    chosen = top if level is None else float(level)
    if not cage.sigma_0 < chosen <= top:
        raise InputError(f"level {chosen}; above sigma_0 = {cage.sigma_0}, up to {top} is allowed")
    own = work.search.level
    if work.polygon_first is not None and chosen <= (cage.sigma_first or 0.0):
        own = min(own, work.polygon_first)  # or the polygon joins others before the true curve does
    return chosen, min(chosen, own) * (1.0 - REGION_LEVEL)


def _level_name(cage: Cage, level: float) -> str:
    if cage.sigma_max is None and level >= (cage.sigma_largest or np.inf):
        return "all"
    if level == cage.sigma_max:
        return "sigma_max"
    return "sigma_first" if level == cage.sigma_first else "sigma"


def _bounds(
    work: CageWork, finger: int, level: float, gap: float
) -> tuple[shapely.MultiPolygon, shapely.MultiPolygon, float]:
    """Inner and outer region of a finger (0..2), refined until their areas agree."""
    free_space = work.search.free_space
    nodes, points = _cells_and_points(work, finger, level)
    size = free_space.pieces.diameter
    enough = _first_try(work, finger, level, gap, nodes, points)
    inner = outer = shapely.MultiPolygon()
    found = 1.0
    for attempt in range(_REFINEMENTS + 1):
        within, around = _sandwiches(work, finger, level, enough, nodes, points)
        grid = _grid(around, gap, size)
        inner = _union(free_space, within, grid)
        outer = _union(free_space, around, grid)
        found = 1.0 - inner.area / outer.area if outer.area > 0.0 else 0.0
        if found <= gap:
            break
        target = gap * outer.area / max(8, len(around)) ** 0.5
        enough = min(0.1 * enough, 0.5 * target * 10.0 ** -max(0, attempt - 1))
    return inner, outer, max(0.0, found)


def _first_try(
    work: CageWork, finger: int, level: float, gap: float, nodes: IntArray, points: FloatArray
) -> float:
    """[unit^2] How much area inner and outer polygon of a cell may differ by at first."""
    rough = _ROUGH * work.search.free_space.pieces.diameter**2
    few = nodes[:_FIRST_FEW], points[:_FIRST_FEW]
    _, around = _sandwiches(work, finger, level, rough, *few)
    largest = float(shapely.area(around).max(initial=0.0))
    return min(rough, _SHARE * gap * largest) if largest > 0.0 else rough


def _sandwiches(
    work: CageWork, finger: int, level: float, enough: float, nodes: IntArray, points: FloatArray
) -> tuple[Polygons, Polygons]:
    """Convex polygons within and around where a finger may be, cell by cell."""
    free_space = work.search.free_space
    slack = _SLACK * free_space.pieces.diameter
    found = all_sandwiches(
        free_space.pieces, free_space.z, finger, nodes, points, level, enough, slack
    )
    return _polygons(found.inner, found.inner_counts), _polygons(found.outer, found.outer_counts)


def _cells_and_points(work: CageWork, finger: int, level: float) -> tuple[IntArray, FloatArray]:
    """Cells of the target's component below the level, and a finger position in each."""
    found, tree = work.search, work.tree
    inside = len(tree.birth)
    use = np.flatnonzero(
        (found.node_level[:inside] <= level) & (tree.birth[:, BIRTH_SIGMA] < level)
    )
    cells = np.ascontiguousarray(found.cells[use])
    birth, at = tree.birth[use], tree.birth_at[use]
    points = least_points(
        found.free_space.pieces, found.free_space.z, finger, cells,
        birth[:, BIRTH_WX], birth[:, BIRTH_WY], at[:, BORN_FINGER], at[:, BORN_SLOT],
    )  # fmt: skip
    return cells, points


def _polygons(corners: FloatArray, counts: IntArray) -> Polygons:
    """The convex polygons of a sandwich; those of fewer than three corners are left out."""
    full = counts >= 3
    ring = np.repeat(np.cumsum(full) - 1, counts)
    keep = np.repeat(full, counts)
    rings = shapely.linearrings(corners[keep], indices=ring[keep])
    return np.asarray(shapely.polygons(rings), dtype=np.object_)


def _grid(polygons: Polygons, gap: float, size: float) -> float:
    """Noding grid, [unit]: ``_GRID``, or less where a thin region would be lost on it."""
    length = shapely.length(polygons)
    thickness = shapely.area(polygons)[length > 0.0] / length[length > 0.0]
    thickest = float(thickness.max(initial=0.0))
    return float(np.clip(_GRID_SHARE * gap * thickest, _FINEST_GRID * size, _GRID * size))


def _union(free_space: FreeSpace, polygons: Polygons, grid: float) -> shapely.MultiPolygon:
    """Union of convex polygons in the free space's frame, outer rings counterclockwise."""
    united = union(polygons, grid, "caging region")
    parts = [p for p in shapely.get_parts(united) if isinstance(p, shapely.Polygon)]
    moved = shapely.transform(shapely.MultiPolygon(parts), lambda xy: xy + free_space.origin)
    oriented = [shapely.orient_polygons(p) for p in shapely.get_parts(moved)]
    return shapely.MultiPolygon(oriented)
