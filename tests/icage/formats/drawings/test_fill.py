from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from icage.formats.drawings.fill import filled

OUTER = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
INNER = np.array([[1.0, 1], [3, 1], [3, 3], [1, 3]])
STAR = np.array([[np.cos(u), np.sin(u)] for u in 2 * np.pi * np.arange(0, 10, 2) / 5])


def test_a_ring_inside_a_ring_by_either_rule():
    assert filled([OUTER, INNER], "nonzero").area == pytest.approx(16)
    assert filled([OUTER, INNER[::-1]], "nonzero").area == pytest.approx(12)
    assert filled([OUTER, INNER], "evenodd").area == pytest.approx(12)
    assert filled([OUTER, INNER[::-1]], "evenodd").area == pytest.approx(12)


def test_a_pentagram_has_its_middle_by_nonzero_only():
    whole, pierced = filled([STAR], "nonzero"), filled([STAR], "evenodd")
    middle = shapely.Point(0, 0)
    assert whole.contains(middle)
    assert not pierced.contains(middle)
    pentagon = whole.difference(pierced)
    # A pentagram in the unit circle has an inner pentagon of circumradius golden ratio^-2.
    radius = ((1 + 5**0.5) / 2) ** -2
    assert pentagon.area == pytest.approx(2.5 * radius**2 * np.sin(2 * np.pi / 5))


def test_a_figure_eight_has_both_loops_by_nonzero():
    eight = np.array([[0.0, 0], [2, 2], [2, 0], [0, 2]])
    assert filled([eight], "nonzero").area == pytest.approx(2)


def test_lines_fill_nothing():
    assert filled([np.array([[0.0, 0], [1, 1], [0, 0]])], "nonzero").is_empty
    assert filled([], "nonzero").is_empty


grid = st.integers(0, 6).map(float)
rings = st.lists(st.lists(st.tuples(grid, grid), min_size=3, max_size=7), min_size=1, max_size=3)


@given(rings, st.sampled_from(["nonzero", "evenodd"]))
def test_a_point_is_filled_by_its_winding_number(rings, rule):
    arrays = [np.array(ring) for ring in rings]
    region = filled(arrays, rule)
    at = complex(2.5 + 1 / 7, 3.5 + 1 / 11)
    if any(_distance(ring, at) < 1e-6 for ring in arrays):
        return
    winding = round(sum(_winding(ring, at) for ring in arrays))
    expected = winding != 0 if rule == "nonzero" else winding % 2 == 1
    assert region.contains(shapely.Point(at.real, at.imag)) == expected


def _winding(ring: np.ndarray, at: complex) -> float:
    """By adding up angles: independent of crossings."""
    z = ring[:, 0] + 1j * ring[:, 1] - at
    return float(np.angle(np.roll(z, -1) / z).sum() / (2 * np.pi))


def _distance(ring: np.ndarray, at: complex) -> float:
    return shapely.LinearRing(ring).distance(shapely.Point(at.real, at.imag))
