"""Everything that a query about placements reads, as plain arrays: to answer it elsewhere.

``icage.cells.membership`` searches where nobody has been yet; a page in a browser does not search.
What its answers follow from are these tables: the pieces of the plane, the cells of the cage with
the level at which each joins and the merge tree over them, and all other cells that hold the
object. Our own. [docs/decisions/0021-explore.md]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.cage import Cage
from icage.cells.free_space import inside_cells
from icage.cells.held_outside import HeldOutside, held_outside
from icage.cells.membership import HELD, held_when_lost
from icage.cells.work import CageWork, work_of
from icage.geometry.near_frame import NearFrame
from icage.kernels.tips import RIGHT, tips_of
from icage.tolerance import COLLISION, LEVEL


@dataclass(frozen=True, slots=True)
class PieceTables:
    """Convex pieces: piece k has the corners and inward normals ``start[k]:start[k + 1]``.

    A corner sharper than a right angle comes again, with the bisector for its normal: outside of a
    piece these half planes say how far a point is beyond a tip.

    Attributes
    ----------
    start:
        (m + 1,)
    corners, normals:
        (s, 2) relative to ``QueryTables.pieces_at``, [unit]; unit normals.
    """

    start: IntArray
    corners: FloatArray
    normals: FloatArray


@dataclass(frozen=True, slots=True)
class CageTables:
    """The cells of the cage, in the order in which the search from the target entered them.

    Attributes
    ----------
    cells:
        (n, fingers) piece of each finger.
    level:
        (n,) level at which the cell joins the target's, [unit].
    parent, stamp:
        (n,) the merge tree: what a cell is hung below, and at which level, [unit]; inf at a root.
    grasp_nodes, grasp_sigmas:
        (g,) row of each grasp, by id, and its sigma, [unit].
    """

    cells: IntArray
    level: FloatArray
    parent: IntArray
    stamp: FloatArray
    grasp_nodes: tuple[int, ...]
    grasp_sigmas: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class QueryTables:
    """What the answers of ``icage.cells.membership.query`` follow from. Lengths in [unit].

    Of contacts that are no cage there are no pieces and no cells: nothing but a collision is told
    from an escape.

    Attributes
    ----------
    frame_at:
        (2,) origin of the frame near the object, in the object's own.
    pieces_at:
        (2,) origin of the pieces, in the frame near the object.
    cap:
        Size at and above which every hand has escaped that the cage does not hold.
    collision, held, held_lost:
        How deep a finger may be inside the object; how far outside a piece it may be and still lie
        in it; and how far if no piece was found so.
    same_level:
        [1] Two levels this close (relative) are one.
    first:
        ``Cage.sigma_guaranteed``; None if closing ends in the target however far the hand opens.
    polygon_first:
        As ``CageWork.polygon_first``.
    pieces, cage:
        Point location, and the cells of the cage.
    outside, outside_level:
        (k, fingers) cells outside the cage that hold the object; (k,) their escape levels, inf:
        never.
    """

    frame_at: FloatArray
    pieces_at: FloatArray
    cap: float
    collision: float
    held: float
    held_lost: float
    same_level: float
    first: float | None
    polygon_first: float | None
    pieces: PieceTables
    cage: CageTables
    outside: IntArray
    outside_level: FloatArray


def query_tables(cage: Cage, workers: int = 1) -> QueryTables:
    """The tables of a cage.

    Complexity: that of ``icage.sublevels``; seconds for 300 vertices, discs with their arcs.

    Raises
    ------
    MethodError:
        The cage was planned by the contact space.
    InputError, GeometryError:
        The outline is too large for this, see ``held_outside``.
    """
    work = work_of(cage)
    size = cage.outline.diameter
    if work is None:
        cap, polygon_first, sagitta, origin = 0.0, None, 0.0, np.zeros(2)
        held = HeldOutside(np.empty((0, len(cage.hand.z)), dtype=np.int64), np.empty(0))
    else:
        free_space, polygon_first, sagitta = (
            work.search.free_space,
            work.polygon_first,
            work.sagitta,
        )
        cap, origin = free_space.cap, free_space.origin
        held = held_outside(work, workers)
    return QueryTables(
        frame_at=NearFrame.of(cage.outline).origin,
        pieces_at=origin,
        cap=cap,
        collision=COLLISION * size,
        held=HELD * size,
        held_lost=held_when_lost(sagitta, size),
        same_level=LEVEL,
        first=cage.sigma_guaranteed,
        polygon_first=polygon_first,
        pieces=_pieces(work),
        cage=_cage(cage, work),
        outside=held.cells,
        outside_level=held.escapes,
    )


def _pieces(work: CageWork | None) -> PieceTables:
    if work is None:
        return PieceTables(np.zeros(1, dtype=np.int64), np.empty((0, 2)), np.empty((0, 2)))
    pieces = work.search.free_space.pieces
    corner, tips = pieces.slot_vertex, tips_of(pieces, RIGHT)
    after = np.repeat(pieces.ptr[1:], np.diff(tips.tip_ptr))
    corners = np.column_stack([pieces.x[corner], pieces.y[corner]])
    normals = np.column_stack([pieces.normal_x, pieces.normal_y])
    return PieceTables(
        pieces.ptr + tips.tip_ptr,
        np.insert(corners, after, np.column_stack([tips.tip_x, tips.tip_y]), axis=0),
        np.insert(normals, after, np.column_stack([tips.tip_nx, tips.tip_ny]), axis=0),
    )


def _cage(cage: Cage, work: CageWork | None) -> CageTables:
    if work is None:
        none = np.empty(0, dtype=np.int64)
        return CageTables(none.reshape(0, len(cage.hand.z)), np.empty(0), none, np.empty(0), (), ())
    found, tree = work.search, work.tree
    inside = inside_cells(found)
    return CageTables(
        found.cells[:inside],
        found.node_level[:inside],
        tree.parent,
        tree.stamp,
        work.minimum_node,
        tuple(grasp.sigma for grasp in cage.grasps),
    )
