"""All minima of sigma for one hand and where they merge, by the cells' method. Our own.

The counterpart of ``icage.contact_space.sublevel``: two ways to one diagram.
"""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.columns import LOW_LEVEL, MERGE_LOSE
from icage.cells.kernels.tree import all_passes, merge
from icage.errors import InputError
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import DEPTH_CUT

MOST_PIECES = 80
"""Pieces of the plane beyond which the table of all passes would take more than a GB."""


def births_and_merges(outline: Outline, hand: HandShape) -> FloatArray:
    """(m, 2) = sigma of every minimum, level at which it merges with a deeper one; by sigma.

    A pinched hand is the deepest minimum of all. inf: it never merges.

    Raises
    ------
    InputError:
        The outline needs more than ``MOST_PIECES`` convex pieces around it.
    """
    free_space = FreeSpace.around(outline, hand)
    if free_space.pieces.total > MOST_PIECES:
        raise InputError(
            f"the outline needs {free_space.pieces.total} pieces; up to {MOST_PIECES} are "
            "allowed here"
        )
    passes = all_passes(free_space.pieces, free_space.z, free_space.cap, free_space.worst)
    low = passes.births
    joined = merge(low, passes.edges, passes.values, np.inf)
    ended = np.where(np.isfinite(low), np.inf, -np.inf)
    ended[joined.merges[:, MERGE_LOSE]] = joined.lows[:, LOW_LEVEL]
    deep = ended - low > DEPTH_CUT * outline.diameter
    kept = np.flatnonzero(deep & (low > 0.0) & np.isfinite(low))
    rows = np.column_stack([low[kept], ended[kept]])
    return rows[np.lexsort((rows[:, 1], rows[:, 0]))]
