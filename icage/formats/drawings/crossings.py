"""How often edges cross, estimated before anyone pays for it. Our own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError

MAX_CROSSINGS: Final = 100_000
"""Of the edges of a path, or of all lines that enclose areas: seconds."""

MAX_OVERLAPS: Final = 2_000_000
"""Of the edges of all shapes, whose union is cheaper: most of them are inside it."""

_FEW: Final = 500
"""Edges that may all cross one another."""

_SAMPLE: Final = 200


def check_crossings(chains: Sequence[FloatArray], most: int = MAX_CROSSINGS) -> None:
    """Refuse chains of points (k, 2) whose edges cross too often, by a sample of the edges.

    Raises
    ------
    FormatError:
        Says about how often they cross.
    """
    if sum(len(chain) for chain in chains) <= _FEW:
        return
    edges = np.concatenate([np.stack([chain[:-1], chain[1:]], axis=1) for chain in chains])
    lines = np.asarray(shapely.linestrings(edges))
    tree = shapely.STRtree(list(lines))
    sample = lines[np.linspace(0, len(lines) - 1, _SAMPLE).astype(np.int64)]
    count = 0
    for k, one in enumerate(sample):
        count += len(tree.query(one, predicate="intersects"))
        # An edge meets itself and its two neighbours.
        crossings = (count / (k + 1) - 3.0) * len(lines) / 2.0
        if (k + 1 >= _SAMPLE // 10 and crossings > 4 * most) or (
            k + 1 == _SAMPLE and crossings > most
        ):
            raise FormatError(
                f"the lines of the drawing cross one another about {crossings:.1g} times; "
                f"at most {most} times is allowed"
            )
