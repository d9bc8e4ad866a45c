"""The largest sigma in a component that never escapes. Our own."""

from __future__ import annotations

import numpy as np

from icage.cells.free_space import Search
from icage.cells.kernels.largest import largest_sigma


def largest_sigma_in(found: Search) -> float:
    """Largest |w| over all visited cells, [unit]."""
    space = found.free_space
    return float(largest_sigma(space.pieces, space.z, found.nodes, np.inf))


def opens_to(found: Search, level: float) -> bool:
    """Whether a visited cell holds a hand as wide as ``level``, [unit]."""
    space = found.free_space
    return bool(largest_sigma(space.pieces, space.z, found.nodes, level) >= level)
