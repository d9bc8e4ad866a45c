"""How many pieces lines would be cut into: counted before a union that may take minutes and GB."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError

MAX_NEAR: Final = 1_500_000
"""Pairs of edges whose boxes meet."""

MAX_CROSSINGS: Final = 60_000
"""Pairs of edges that cross."""

_STEP: Final = 50


def check_crossings(paths: Sequence[FloatArray]) -> None:
    """Refuse polylines, each (k, 2), whose edges cross too often.

    Raises
    ------
    FormatError:
        More than ``MAX_NEAR`` or ``MAX_CROSSINGS`` pairs.
    """
    ends = [np.stack([path[:-1], path[1:]], axis=1) for path in paths]
    edges = np.asarray(shapely.linestrings(np.concatenate(ends)))
    tree = shapely.STRtree(edges)
    near, crossings = 0, 0
    for start in range(0, len(edges), _STEP):
        own, others = tree.query(edges[start : start + _STEP])
        own = own + start
        later = own < others
        near += int(later.sum())
        if near > MAX_NEAR:
            raise FormatError(f"more than {MAX_NEAR} pairs of lines lie over each other: a tangle")
        crossings += int(shapely.crosses(edges[own[later]], edges[others[later]]).sum())
        if crossings > MAX_CROSSINGS:
            raise FormatError(f"lines cross more than {MAX_CROSSINGS} times: a tangle")
