"""Is the object caged by a hand that stands here? Queries about many placements at once.

A placement lies in its own cell, and a cell's sublevel sets are connected: its verdict follows
from the level at which its cell joins the target's cell, and from the level at which it escapes.
Both come from the same best-first search; no ray shooting. Our own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cage import Cage
from icage.cells.free_space import CELL_LIMIT, FreeSpace, inside_cells
from icage.cells.kernels.escape import Memory, escape_levels, new_memory, shrinkable
from icage.cells.kernels.tree import find_at
from icage.cells.work import CageWork, work_of
from icage.errors import GeometryError, PlacementError
from icage.geometry.near_frame import NearFrame
from icage.kernels.locate import Buckets, build_buckets, cells_of, depth_inside, nodes_of
from icage.library_faults import geometry_told
from icage.placement_class import PlacementClass, PlacementCode
from icage.tolerance import COLLISION, LEVEL

VERDICTS: Final = tuple(one.value for one in PlacementClass)
"""Meaning of the verdict codes 0..4. [docs/formats.md, icage query]"""

TARGET, CAGED, OTHER, ESCAPES, COLLIDES = PlacementCode

_GRID = 96
"""Squares along a side of the grid of point location."""

HELD: Final = 1e-12
"""[diameter] A piece holds a finger this far outside it: the rounding of a position."""


@dataclass(frozen=True, slots=True)
class PlacementAnswer:
    """What the query says of one placement. Lengths in the object's unit.

    Attributes
    ----------
    verdict:
        Which class the placement is of.
    sigma:
        Its size.
    margin:
        By how much the hand may still open before the object can escape: an opening, no room for
        misplacement. None if it never escapes, 0 for ``escapes`` and ``collision``.
    target_margin:
        By how much it may open while closing still ends in the target only; None but for the
        class ``target``, and where no such level exists.
    grasps:
        Ids of the plan's grasps that the placement's component holds.
    in_cage:
        Whether it joins the target below sigma_max.
    """

    verdict: PlacementClass
    sigma: float
    margin: float | None
    target_margin: float | None
    grasps: tuple[int, ...]
    in_cage: bool


@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """What the query says of n placements. Lengths in the object's unit.

    ``margin`` = escape level of the placement's component - sigma (nan: never escapes; 0 for the
    verdicts escapes and collision); ``target_margin`` = sigma_first - sigma for the verdict
    target (nan otherwise, or if no level is first). Both say how much further the hand may open
    from there, not how far off it may stand. ``in_cage``: whether it joins the target below
    sigma_max.
    """

    verdict: IntArray
    sigma: FloatArray
    margin: FloatArray
    target_margin: FloatArray
    in_cage: BoolArray
    _cage: Cage = field(repr=False)
    _nodes: IntArray = field(repr=False)

    def __len__(self) -> int:
        return len(self.verdict)

    def __getitem__(self, row: int) -> PlacementAnswer:
        """The answer about one placement, counted from 0."""
        margin, target_margin = float(self.margin[row]), float(self.target_margin[row])
        return PlacementAnswer(
            PlacementCode(int(self.verdict[row])).placement_class,
            float(self.sigma[row]),
            None if math.isnan(margin) else margin,
            None if math.isnan(target_margin) else target_margin,
            self.grasps_of(row % len(self)),
            bool(self.in_cage[row]),
        )

    def grasps_of(self, row: int) -> tuple[int, ...]:
        """Ids of the plan's grasps in the component of placement ``row`` at its own sigma."""
        work, node = self._cage.work, int(self._nodes[row])
        if work is None or node < 0 or self.verdict[row] >= ESCAPES:
            return ()
        if work.polygon_first is not None and self.verdict[row] == TARGET:
            return (0,)  # on the true curve there is no other, whatever minima chords have
        level = float(self.sigma[row]) * (1.0 + LEVEL)
        tree = work.tree
        here = find_at(tree.parent, tree.stamp, node, level)
        return tuple(
            grasp.id
            for grasp, at in zip(self._cage.grasps, work.minimum_node, strict=True)
            if grasp.sigma <= level and find_at(tree.parent, tree.stamp, at, level) == here
        )


class EscapeLevels:
    """Escape levels of cells outside the cage, found when asked for and remembered."""

    def __init__(self, free_space: FreeSpace) -> None:
        self._free_space = free_space
        self._memory: Memory = new_memory()

    def of(self, cells: IntArray, sigma: FloatArray) -> FloatArray:
        """Escape level (n,) of each cell (n, 3); where it is not above sigma, any such level.

        Raises
        ------
        GeometryError:
            A search met more than ``CELL_LIMIT`` cells.
        """
        free_space = self._free_space
        levels, self._memory = escape_levels(
            free_space.pieces, free_space.z, cells, sigma, free_space.cap, free_space.worst,
            CELL_LIMIT, self._memory,
        )  # fmt: skip
        if np.isnan(levels).any():
            raise GeometryError(f"a search for the escape gave up after {CELL_LIMIT} cells")
        return levels


@dataclass(frozen=True, slots=True)
class Locator:
    """Point location in the pieces of one free space."""

    free_space: FreeSpace
    buckets: Buckets

    @classmethod
    def of(cls, free_space: FreeSpace) -> Locator:
        """Bucket the pieces on a grid over the object's surroundings."""
        ring = free_space.outline.vertices - free_space.origin
        margin = 0.25 * free_space.outline.diameter
        low = ring.min(axis=0) - margin
        size = float((ring.max(axis=0) + margin - low).max()) / _GRID
        return cls(free_space, build_buckets(free_space.pieces, low[0], low[1], size, _GRID))

    def cells(self, fingers: FloatArray, tolerance: float) -> IntArray:
        """Pieces (n, f) of fingers (n, f, 2) in the free space's frame; -1 where there is none."""
        at = fingers - self.free_space.origin
        return cells_of(self.free_space.pieces, at, self.buckets, tolerance)


@geometry_told()
def query(cage: Cage, placements: FloatArray) -> Answers:
    """Verdicts about placements (n, 4) = x, y, theta, sigma in the object's frame.

    Verdicts speak of the placement's component at its own sigma. With disc fingers a collision is
    judged on the true offset, and the cage on its inner polygon (the safe side).

    Raises
    ------
    PlacementError:
        Not (n, 4), not finite, or a negative sigma; names the row (from 0).
    MethodError:
        The cage was planned by the contact space.

    Notes
    -----
    About 4 us a placement at 100 vertices once the cells outside the cage have been met.
    """
    rows = checked_placements(placements)
    work = work_of(cage)
    sigma = rows[:, 3].copy()
    frame = NearFrame.of(cage.outline)
    rows = frame.rows_into(rows)
    fingers = cage.hand.fingers(rows)
    size = cage.outline.diameter
    verdict = np.full(len(rows), ESCAPES, dtype=np.int64)
    margin = np.zeros(len(rows))
    target_margin = np.full(len(rows), np.nan)
    in_cage = np.zeros(len(rows), dtype=np.bool_)
    nodes = np.full(len(rows), -1, dtype=np.int64)
    found = (
        np.full(fingers.shape[:2], -1)
        if work is None
        else _locator(work).cells(fingers, HELD * size)
    )
    collides = _collides(cage, frame, fingers, found >= 0)
    verdict[collides] = COLLIDES
    if work is not None:
        free = np.flatnonzero(~collides)
        cells = _cells(work, fingers[free], found[free], size)
        nodes[free] = _inside_nodes(work, cells)
        _judge_inside(cage, work, sigma, nodes, verdict, margin, target_margin, in_cage)
        _judge_outside(cage, work, rows, free, cells, nodes, verdict, margin)
    return Answers(verdict, sigma, margin, target_margin, in_cage, cage, nodes)


def checked_placements(placements: FloatArray) -> FloatArray:
    """The placements as (n, 4) floats, or a PlacementError that names the row."""
    rows = np.asarray(placements, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 4:
        raise PlacementError(f"placements must be rows x, y, theta, sigma; found {rows.shape}")
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise PlacementError(f"placement {bad[0]}: numbers must be finite")
    bad = np.flatnonzero(rows[:, 3] < 0.0)
    if len(bad):
        raise PlacementError(f"placement {bad[0]}: sigma = {rows[bad[0], 3]}; at least 0 is needed")
    return rows


def _collides(cage: Cage, frame: NearFrame, fingers: FloatArray, located: BoolArray) -> BoolArray:
    """Which hands (n,) have a finger in the object; ``located`` (n, 3) are those a piece holds.

    ``fingers`` (n, 3, 2) are in the frame near the object.

    A point finger in a piece is clear: the pieces touch the object no deeper than MERGE_VERTEX,
    which is less than COLLISION. The pieces around an inner polygon say nothing about a disc.
    """
    asked = ~located if cage.finger_radius == 0.0 else np.ones_like(located)
    inside = np.zeros(located.shape, dtype=np.bool_)
    ring = frame.into(cage.outline.vertices)
    depth = depth_inside(ring, fingers[asked], cage.finger_radius)
    inside[asked] = depth > COLLISION * cage.outline.diameter
    collides: BoolArray = np.any(inside, axis=1)
    return collides


def _cells(work: CageWork, fingers: FloatArray, found: IntArray, size: float) -> IntArray:
    """Cells of collision-free placements; a finger a hair inside the object goes to the nearest."""
    cells = found.copy()
    lost = np.flatnonzero((cells < 0).any(axis=1))
    if len(lost):
        near = held_when_lost(work.sagitta, size)
        cells[lost] = _locator(work).cells(fingers[lost], near)
    return cells


def held_when_lost(sagitta: float, size: float) -> float:
    """How far outside its piece a finger may lie that no piece holds but for rounding, [unit].

    ``size`` is the object's diameter; ``sagitta`` is that of ``CageWork``.
    """
    return 4.0 * max(COLLISION * size, sagitta)


def _inside_nodes(work: CageWork, cells: IntArray) -> IntArray:
    found = work.search
    m = found.free_space.pieces.total
    return nodes_of(found.keys, found.values, cells, m, inside_cells(found))


def _judge_inside(
    cage: Cage, work: CageWork, sigma: FloatArray, nodes: IntArray, verdict: IntArray,
    margin: FloatArray, target_margin: FloatArray, in_cage: BoolArray,
) -> None:  # fmt: skip
    """Placements whose cell joins the target's below the escape."""
    escape = np.inf if cage.sigma_max is None else cage.sigma_max
    first = escape if cage.sigma_guaranteed is None else cage.sigma_guaranteed
    at = np.flatnonzero(nodes >= 0)
    s = sigma[at]
    joined = work.search.node_level[nodes[at]] <= s * (1.0 + LEVEL)
    if work.polygon_first is not None:
        # chords may have minima of their own below sigma_first, and join others a hair too early
        beyond = work.search.node_level[nodes[at]] >= work.polygon_first * (1.0 - LEVEL)
        joined = ~beyond | (joined & (s >= first))
    inside = s < escape
    code = np.where(joined, np.where(s < first, TARGET, CAGED), OTHER)
    verdict[at] = np.where(inside, code, ESCAPES)
    in_cage[at] = inside
    margin[at] = np.where(inside, np.nan if np.isinf(escape) else escape - s, 0.0)
    if not np.isinf(first):
        is_target = verdict[at] == TARGET
        target_margin[at[is_target]] = first - s[is_target]


def _judge_outside(
    cage: Cage, work: CageWork, rows: FloatArray, free: IntArray, cells: IntArray,
    nodes: IntArray, verdict: IntArray, margin: FloatArray,
) -> None:  # fmt: skip
    """Placements in other cells: is there a way out at their own sigma?"""
    free_space = work.search.free_space
    sigma = rows[free, 3]
    asked = np.flatnonzero((nodes[free] < 0) & (cells >= 0).all(axis=1) & (sigma < free_space.cap))
    # most hands off the object can shrink to a point where they stand
    at = rows[free[asked]]
    hands = np.column_stack(
        [
            at[:, :2] - free_space.origin,
            sigma[asked, None] * np.column_stack([np.cos(at[:, 2]), np.sin(at[:, 2])]),
        ]
    )
    asked = asked[~shrinkable(free_space.pieces, free_space.z, hands)]
    # small sigmas last: what the large ones have taught answers most of them
    asked = asked[np.argsort(-sigma[asked], kind="stable")]
    reach = sigma[asked] * (1.0 + LEVEL)
    levels = _escape_levels(work).of(cells[asked], reach)
    held = levels > reach
    verdict[free[asked[held]]] = OTHER
    never = np.isinf(levels[held])
    margin[free[asked[held]]] = np.where(never, np.nan, levels[held] - sigma[asked[held]])


def _locator(work: CageWork) -> Locator:
    """The point location of a cage, built once."""
    kept = work.remembered.get("locator")
    if not isinstance(kept, Locator):
        kept = Locator.of(work.search.free_space)
        work.remembered["locator"] = kept
    return kept


def _escape_levels(work: CageWork) -> EscapeLevels:
    """The escape levels met so far."""
    kept = work.remembered.get("escapes")
    if not isinstance(kept, EscapeLevels):
        kept = EscapeLevels(work.search.free_space)
        work.remembered["escapes"] = kept
    return kept
