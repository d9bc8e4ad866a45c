"""Depths in polygons: what a shift of the ring makes of vertices that are nearly one."""

from __future__ import annotations

import numpy as np
import pytest

from icage.kernels.locate import depth_inside

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
POINTS = np.array([[1.0, 1.0], [1.0, 0.25], [3.0, 1.0], [-0.5, 0.5], [0.0, 0.0]])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_vertex_that_stands_twice_changes_nothing(times: int) -> None:
    depth = depth_inside(np.repeat(SQUARE, times, axis=0), POINTS, 0.125)
    assert depth.tolist() == [1.125, 0.375, -0.875, -0.375, 0.125]


def test_an_edge_whose_square_is_nothing_is_passed_over() -> None:
    ring = np.insert(SQUARE, 1, [2.0 - 1e-200, 0.0], axis=0)
    ring[0] = [1e-170, 0.0]
    assert depth_inside(ring, POINTS, 0.0)[:4].tolist() == [1.0, 0.25, -1.0, -0.5]
