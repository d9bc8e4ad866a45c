"""Which contact forces balance and squeeze: all basic solutions of many small linear programs.

Four rows, force, torque and the sum of the loads, leave four loads at a time. They come from
Cramer's rule: the row of ones makes every determinant a sum of minors of force and torque, which
quadruples share, and many systems are solved at once.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tests.oracles.geometry import Floats

SINGULAR = 1e-12
"""[1] Four columns with a smaller determinant are no basis."""


def squeezing(wrench: Floats) -> NDArray[np.bool_]:
    """Which of the systems (n, 5, c) have loads that balance and do negative work, (n,).

    Rows: force, force, torque, one, and the work of opening; a column for each edge of a cone.
    """
    columns = np.ascontiguousarray(wrench.transpose(2, 1, 0))
    x, y, torque, _, work = columns.transpose(1, 0, 2)
    crossed = {
        (b, c): y[b] * torque[c] - y[c] * torque[b] for b, c in combinations(range(len(x)), 2)
    }
    minor = {
        (a, b, c): x[a] * crossed[b, c] - x[b] * crossed[a, c] + x[c] * crossed[a, b]
        for a, b, c in combinations(range(len(x)), 3)
    }
    jam = np.zeros(len(wrench), dtype=np.bool_)
    for a, b, c, d in combinations(range(len(x)), 4):
        # each load times the determinant: its minor, signed as in the expansion along the ones
        share = (-minor[b, c, d], minor[a, c, d], -minor[a, b, d], minor[a, b, c])
        det = sum(share)
        done = sum(part * work[k] for part, k in zip(share, (a, b, c, d), strict=True))
        pushes = np.ones(len(wrench), dtype=np.bool_)
        for part in share:
            pushes &= part * det >= 0.0
        jam |= pushes & (np.abs(det) > SINGULAR) & (done * np.sign(det) < -1e-9 * np.abs(det))
    return jam
