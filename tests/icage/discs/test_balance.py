"""Forces that push: as near as scipy's, degenerate or not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from icage.discs.balance import pushing


def columns_of(kind: str, count: int, rng: np.random.Generator) -> np.ndarray:
    """Slopes of gaps (4, count): some the same, dependent, nearly the same, or on one line."""
    columns = rng.normal(size=(4, count))
    if kind == "same":
        columns[:, -1] = columns[:, 0]
    elif kind == "dependent":
        columns[:, -1] = columns[:, : count - 1].sum(axis=1)
    elif kind == "nearly the same":
        columns[:, -1] = columns[:, 0] + 1e-13 * rng.normal(size=4)
    elif kind == "on a line":
        columns = np.outer(columns[:, 0], rng.choice([-1.0, 1.0], size=count))
    elif kind == "round":
        columns = np.round(columns)
    return columns


@pytest.mark.parametrize(
    "kind", ["any", "same", "dependent", "nearly the same", "on a line", "round"]
)
def test_no_forces_come_nearer(kind: str) -> None:
    rng = np.random.default_rng(len(kind))
    for count in [2, 3, 4, 5, 8] * 40:
        columns = columns_of(kind, count, rng)
        balanced = columns @ np.maximum(rng.normal(size=count), 0.0)
        for wanted in (rng.normal(size=4), balanced, np.zeros(4)):
            _, least = nnls(columns, wanted)
            force, miss = pushing(columns, wanted)
            assert force.min() >= 0.0
            assert miss == pytest.approx(np.linalg.norm(columns @ force - wanted), abs=1e-12)
            assert miss == pytest.approx(least, abs=1e-9)


def test_the_only_forces_are_found() -> None:
    rng = np.random.default_rng(5)
    for _ in range(100):
        columns, wanted = rng.normal(size=(4, 3)), rng.uniform(0.5, 2.0, size=3)
        force, miss = pushing(columns, columns @ wanted)
        assert force == pytest.approx(wanted, rel=1e-9)
        assert miss < 1e-12
