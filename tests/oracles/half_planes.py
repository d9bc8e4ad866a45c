"""The least point of half planes, by trying every foot and every corner."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from tests.oracles.geometry import Floats


def least_norm(g: Floats, c: Floats, slack: float) -> float:
    """Least |w| with g . w >= c - slack, of rows g (n, 2) and c (n,); inf for none."""
    tries = [np.zeros(2), *(g * (c / (g * g).sum(axis=1))[:, None])]
    for a, b in combinations(range(len(g)), 2):
        det = g[a, 0] * g[b, 1] - g[a, 1] * g[b, 0]
        if abs(det) > 1e-12:
            tries.append(np.array([c[a] * g[b, 1] - c[b] * g[a, 1],
                                   g[a, 0] * c[b] - g[b, 0] * c[a]]) / det)  # fmt: skip
    w = np.array(tries)
    held = (w @ g.T >= c - slack).all(axis=1)
    return float(np.hypot(*w[held].T).min()) if held.any() else np.inf
