"""Drawn widths: areas worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.errors import FormatError
from icage.formats.drawings.area import drawn_area
from icage.formats.drawings.curves import Polyline
from icage.formats.drawings.drawing import Line

SQUARE = np.array([[0, 0], [10, 0], [10, 10], [0, 10], [0, 0.0]])


def line(points: object, **more: object) -> Line:
    return Line((Polyline(np.asarray(points, dtype=float)),), width=2.0, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("turn", [20.0, 60.0, 100.0, 150.0, -150.0])
@pytest.mark.parametrize("limit", [1.0, 2.0, 50.0])
def test_a_mitre_is_whole_or_none(turn: float, limit: float):
    angle = math.radians(turn)
    corner = [[0, 0], [40, 0], [40 + 40 * math.cos(angle), 40 * math.sin(angle)]]
    area = drawn_area(line(corner, mitre_limit=limit), 1e-6).area
    half = abs(angle) / 2.0
    # Outside of the corner: the bevel's triangle, and the mitre's kite with the same two sides.
    bevel, mitre = math.sin(2.0 * half) / 2.0, math.tan(half)
    inside = math.tan(half)
    outside = mitre if 1.0 / math.cos(half) <= limit else bevel
    assert area == pytest.approx(160.0 - inside + outside, rel=1e-9)


def test_where_ends_meet_they_join_unless_they_are_capped():
    assert drawn_area(line(SQUARE), 1e-6).area == pytest.approx(12**2 - 8**2)
    assert drawn_area(line(SQUARE, capped=True), 1e-6).area == pytest.approx(12**2 - 8**2 - 1)


def test_a_point_more_than_once_changes_nothing():
    twice = np.repeat(SQUARE, 2, axis=0)
    assert drawn_area(line(twice), 1e-6).area == pytest.approx(12**2 - 8**2)


def test_a_width_has_a_limit():
    with pytest.raises(FormatError, match="wider than"):
        drawn_area(Line((Polyline(SQUARE),), width=1e300), 1e-6)
