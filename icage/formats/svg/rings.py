"""Subpaths as the closed rings that a fill has."""

from __future__ import annotations

import numpy as np

from icage.formats.drawings.curves import Curve
from icage.formats.drawings.drawing import Ring
from icage.formats.svg.matrices import Matrix, placed
from icage.formats.svg.path_data import Subpath, line


def rings(parts: list[Subpath], matrix: Matrix) -> tuple[Ring, ...]:
    """Subpaths as closed rings, mapped: a fill closes what is open."""
    found: list[Ring] = []
    for part in parts:
        chain = [placed(curve, matrix) for curve in part.curves]
        found.append((*chain, closing(chain)))
    return tuple(found)


def closing(chain: list[Curve]) -> Curve:
    """The line from the end of a chain to its start."""
    first, last = chain[0].at(np.zeros(1))[0], chain[-1].at(np.ones(1))[0]
    return line((last[0], last[1]), (first[0], first[1]))
