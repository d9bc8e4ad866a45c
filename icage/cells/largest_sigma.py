"""The largest sigma in a component that never escapes. Our own.

sigma is convex on a cell, so its maximum is at an extreme point: two fingers at corners of their
pieces, or one at a corner and the others on edges.
"""

from __future__ import annotations

import numpy as np

from icage.cells.free_space import Search
from icage.cells.kernels.largest import largest_in


def largest_sigma_in(found: Search) -> float:
    """Largest |w| over all visited cells, [unit]."""
    return _largest(found, np.inf)


def opens_to(found: Search, level: float) -> bool:
    """Whether a visited cell holds a hand as wide as ``level``, [unit]."""
    return _largest(found, level) >= level


def _largest(found: Search, enough: float) -> float:
    """The largest sigma, or any that is ``enough``."""
    free_space = found.free_space
    cells = np.ascontiguousarray(found.cells)
    return float(largest_in(free_space.pieces, free_space.z, cells, enough))
