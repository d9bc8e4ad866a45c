"""What holds the object besides the cage: every cell that another grasp of the hand reaches.

A query outside the cage asks of one cell when the object escapes from it. Here all cells are found
from which it does not escape at once, so that a query can be answered by a table. Our own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cells.free_space import CELL_LIMIT, inside_cells
from icage.cells.kernels.escape import EXACT, escape_levels, new_memory
from icage.cells.sublevels import minima_in
from icage.cells.work import CageWork
from icage.errors import GeometryError
from icage.kernels.locate import nodes_of
from icage.tolerance import LEVEL


@dataclass(frozen=True, slots=True)
class HeldOutside:
    """Cells outside a cage that hold the object, with the level at which it escapes from each.

    A hand of size sigma in one of them holds it if the level is above sigma. A cell that is neither
    here nor in the cage lets the object escape, but for basins that are no deeper than the depth
    cut. [docs/theory.md, Sec. 2.5]

    Attributes
    ----------
    cells:
        (k, fingers) pieces of the cells, ascending.
    escapes:
        (k,) escape level, [unit]; inf: never.
    """

    cells: IntArray
    escapes: FloatArray


def held_outside(work: CageWork, workers: int = 1) -> HeldOutside:
    """All cells outside the cage that hold the object.

    Each of them is reached from a minimum of the hand below that minimum's escape; so a search from
    every minimum outside the cage, in the order of the minima, meets them all.

    Raises
    ------
    InputError, GeometryError:
        The outline is too large for all minima to be listed (``icage.cells.sublevels``), or a
        search met more than ``CELL_LIMIT`` cells.
    """
    found = work.search
    free_space = found.free_space
    minima = minima_in(free_space, workers)
    outside = ~_in_cage(work, minima.cells)
    # the highest first, as in a query: what they teach answers most of the others
    order = np.flatnonzero(outside)[::-1]
    levels, memory = escape_levels(
        free_space.pieces, free_space.z, minima.cells[order],
        minima.births[order] * (1.0 + LEVEL), free_space.cap, free_space.worst, CELL_LIMIT,
        new_memory(),
    )  # fmt: skip
    if np.isnan(levels).any():
        raise GeometryError(f"a search for the escape gave up after {CELL_LIMIT} cells")
    known = (memory.keys >= 0) & ~np.isnan(memory.levels[:, EXACT])
    keys = np.sort(memory.keys[known])
    escapes = memory.levels[known, EXACT][np.argsort(memory.keys[known])]
    cells = _cells_of_keys(keys, free_space.pieces.total)
    kept = ~_in_cage(work, cells)
    return HeldOutside(cells[kept], escapes[kept])


def _in_cage(work: CageWork, cells: IntArray) -> BoolArray:
    found = work.search
    m = found.free_space.pieces.total
    inside: BoolArray = nodes_of(found.keys, found.values, cells, m, inside_cells(found)) >= 0
    return inside


def _cells_of_keys(keys: IntArray, m: int) -> IntArray:
    """Pieces (k, 3) of the keys (k,) under which searches remember cells."""
    return np.column_stack([keys // (m * m), keys // m % m, keys % m])
