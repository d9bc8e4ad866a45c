from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, EllipseArc, flatten

number = st.floats(-10, 10).map(lambda x: round(x, 9))  # GEOS divides by subnormal lengths
point = st.tuples(number, number)
bezier = st.lists(point, min_size=2, max_size=4).map(lambda p: Bezier(np.array(p)))
arc = st.builds(
    lambda c, a, b, start, sweep: EllipseArc(np.array(c), np.array(a), np.array(b), start, sweep),
    point,
    point,
    point,
    st.floats(-7, 7),
    st.floats(-2 * math.pi, 2 * math.pi),
)


@given(st.one_of(bezier, arc), st.sampled_from([1.0, 1e-2, 1e-4]))
def test_a_polyline_stays_within_the_distance_both_ways(curve: Bezier | EllipseArc, within: float):
    flat = flatten(curve, within)
    fine = curve.at(np.linspace(0, 1, 3001))
    line = shapely.LineString(flat)
    sampled = shapely.LineString(fine)
    resolution = float(np.hypot(*np.diff(fine, axis=0).T).max()) ** 2 + 1e-9
    assert shapely.distance(line, shapely.points(fine)).max() <= within * (1 + 1e-9) + 1e-12
    middles = (flat[1:] + flat[:-1]) / 2
    assert shapely.distance(sampled, shapely.points(middles)).max() <= within + resolution


@given(st.one_of(bezier, arc))
def test_a_polyline_has_the_bounding_box_of_its_curve(curve: Bezier | EllipseArc):
    flat = flatten(curve, 1.0)
    fine = curve.at(np.linspace(0, 1, 5001))
    assert (flat.min(axis=0) <= fine.min(axis=0) + 1e-12).all()
    assert (flat.max(axis=0) >= fine.max(axis=0) - 1e-12).all()


def test_ends_are_exact():
    curve = Bezier(np.array([[0.1, 0.2], [3.0, 4.0], [0.3, 0.7]]))
    flat = flatten(curve, 1e-3)
    assert flat[0].tolist() == [0.1, 0.2]
    assert flat[-1].tolist() == [0.3, 0.7]


def test_a_finer_polyline_is_not_made_without_end():
    circle = EllipseArc(np.zeros(2), np.array([1.0, 0]), np.array([0, 1.0]), 0.0, 2 * math.pi)
    with pytest.raises(FormatError, match="larger tolerance"):
        flatten(circle, 1e-12)
