from __future__ import annotations

import numpy as np
import pytest

from icage.errors import FormatError
from icage.formats.drawings.crossings import check_crossings


def star(corners: int) -> np.ndarray:
    return np.random.default_rng(3).uniform(0.0, 1.0, (corners, 2))


def test_few_edges_are_never_counted():
    check_crossings([star(400)], most=1)


def test_a_long_curve_that_crosses_nothing_is_no_work():
    angle = np.linspace(0.0, 300.0, 20_000)
    spiral = np.column_stack([angle * np.cos(angle), angle * np.sin(angle)])
    check_crossings([spiral], most=100)


@pytest.mark.parametrize(("corners", "count"), [(600, 41_000), (3000, 1_000_000)])
def test_the_estimate_is_near_the_count(corners: int, count: int):
    # Two chords of uniform points in a square cross with probability 0.23. [Sylvester's problem]
    check_crossings([star(corners)], most=int(1.5 * count))
    with pytest.raises(FormatError, match="cross one another about"):
        check_crossings([star(corners)], most=count // 2)
