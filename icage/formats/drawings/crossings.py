"""How often edges cross, before anyone pays minutes and gigabytes for a union. Our own.

Areas may cross millions of times, so theirs are estimated from a sample; lines are cut at every
crossing and may lie over each other without crossing, so theirs are counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError

MAX_CROSSINGS: Final = 100_000
"""Of the edges of a path: seconds."""

MAX_OVERLAPS: Final = 2_000_000
"""Of the edges of all shapes, whose union is cheaper: most of them are inside it."""

MAX_NEAR: Final = 1_500_000
"""Pairs of edges of lines whose boxes meet."""

MAX_TANGLE: Final = 60_000
"""Pairs of edges of lines that cross."""

_STEP: Final = 50

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


def check_tangle(paths: Sequence[FloatArray]) -> None:
    """Refuse polylines, each (k, 2), whose edges cross too often.

    Raises
    ------
    FormatError:
        More than ``MAX_NEAR`` or ``MAX_TANGLE`` pairs.
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
        if crossings > MAX_TANGLE:
            raise FormatError(f"lines cross more than {MAX_TANGLE} times: a tangle")
