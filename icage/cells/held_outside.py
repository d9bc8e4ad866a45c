"""What holds the object besides the cage: every cell that another grasp of the hand reaches.

A query outside the cage asks of one cell when the object escapes from it. Here all cells are found
from which it does not escape at once, so that a query can be answered by a table. Our own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from icage.arrays import BoolArray, FloatArray, IntArray
from icage.cells.free_space import CELL_LIMIT, inside_cells, search
from icage.cells.sublevels import minima_in
from icage.cells.work import CageWork
from icage.errors import GeometryError
from icage.kernels.locate import nodes_of
from icage.minima import escapes_of
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

    Each of them is reached from a minimum of the hand below the level at which that one escapes. A
    search up to there meets the other minima that escape by the same pass, too.

    Complexity: that of ``icage.sublevels``, and a search over the cells found.

    Raises
    ------
    InputError, GeometryError:
        The outline is too large for all minima to be listed (``icage.cells.sublevels``), or a
        search met more than ``CELL_LIMIT`` cells.
    """
    found = work.search
    free_space = found.free_space
    minima = minima_in(free_space, workers)
    levels = escapes_of(minima.merges, minima.into)
    m = free_space.pieces.total
    known: set[int] = set()
    keys, escapes = [np.empty(0, dtype=np.int64)], [np.empty(0)]
    inside = _in_cage(work, minima.cells)
    # those that end the latest first: what they reach answers most of the others
    for k in np.lexsort((minima.births, -minima.merges)).tolist():
        if inside[k] or _key(minima.cells[k], m) in known:
            continue
        below = float(levels[k]) * (1.0 - 2.0 * LEVEL)
        met = search(free_space, minima.cells[k], 0.0, stop_above=below)
        if met.gave_up:
            raise GeometryError(f"a search for what is held gave up after {CELL_LIMIT} cells")
        new = np.array(sorted({*_key(met.cells.T, m).tolist()} - known), dtype=np.int64)
        known.update(new.tolist())
        keys.append(new)
        escapes.append(np.full(len(new), levels[k]))
    order = np.argsort(np.concatenate(keys))
    cells = _cells_of_keys(np.concatenate(keys)[order], len(free_space.z), m)
    kept = ~_in_cage(work, cells)
    return HeldOutside(cells[kept], np.concatenate(escapes)[order][kept])


def _in_cage(work: CageWork, cells: IntArray) -> BoolArray:
    found = work.search
    m = found.free_space.pieces.total
    inside: BoolArray = nodes_of(found.keys, found.values, cells, m, inside_cells(found)) >= 0
    return inside


def _key(cell: IntArray, m: int) -> Any:
    """One number for a cell of m pieces; for cells as columns (fingers, k) one each."""
    return np.ravel_multi_index(tuple(cell), (m,) * len(cell))


def _cells_of_keys(keys: IntArray, fingers: int, m: int) -> IntArray:
    """Pieces (k, fingers) of the keys (k,)."""
    return np.column_stack(np.unravel_index(keys, (m,) * fingers)).astype(np.int64)
