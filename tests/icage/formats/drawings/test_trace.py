"""Size, unit, frame and distance of a traced outline."""

from __future__ import annotations

from dataclasses import replace

import pytest
import shapely

from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.drawings.trace import traced
from tests.icage.formats.drawings.test_parts import box, disc

SURE = Drawing((box(3, 4, 20, 10),), metre=1e-3, unit="mm", size_from="the file's mm")
UNSURE = replace(SURE, sure=False)
SILENT = Drawing(SURE.shapes, sure=False)


@pytest.mark.parametrize(
    ("drawing", "reading", "wide", "unit", "words"),
    [
        (SURE, Reading(), 20.0, "mm", "from the file's mm"),
        (SURE, Reading(unit="cm"), 2.0, "cm", "from the file's mm"),
        (SURE, Reading(width=5.0), 5.0, "mm", "from --width 5 mm (no --unit given: mm is assumed"),
        (SURE, Reading(width=5.0, unit="m"), 5.0, "m", "from --width 5 m"),
        (UNSURE, Reading(unit="cm"), 20.0, "cm", "from --unit cm (not the file's mm)"),
        (SILENT, Reading(unit="cm"), 20.0, "cm", "from --unit cm"),
        (SILENT, Reading(width=5.0), 5.0, "m", "the file states none"),
    ],
)
def test_whose_size_it_is(drawing: Drawing, reading: Reading, wide: float, unit: str, words: str):
    found = traced(drawing, reading)
    assert max(found.outline.polygon.bounds) == pytest.approx(wide)
    assert found.outline.polygon.bounds[:2] == (0, 0)
    assert found.unit == unit
    assert words in found.size_from
    assert found.notes == ()


def test_a_size_that_is_often_wrong_is_a_warning():
    (note,) = traced(UNSURE, Reading()).notes
    assert "which is often wrong" in note


@pytest.mark.parametrize("drawing", [replace(SILENT, sure=True), SILENT])
def test_no_size_at_all_is_asked_for(drawing: Drawing):
    with pytest.raises(FormatError, match="a width is needed"):
        traced(drawing, Reading())


def test_the_distance_and_the_difference_are_those_of_the_drawing():
    found = traced(Drawing((disc(0, 0, 5),)), Reading(width=10.0, tolerance=0.1))
    assert 0.02 < found.distance <= 0.1
    assert found.tolerance == pytest.approx(0.1)
    apart = found.source.symmetric_difference(found.outline.polygon).area
    assert found.symmetric_difference == pytest.approx(apart) != 0.0


def test_both_sides_stand_in_the_frame_of_the_drawing():
    round_one = Drawing((disc(2, 3, 5), box(2, -2, 9, 2)))
    inside, outside = (
        traced(round_one, Reading(width=50.0, tolerance=0.2, safe=side)).outline.polygon
        for side in ("inside", "outside")
    )
    fine = traced(round_one, Reading(width=50.0, tolerance=1e-3)).outline.polygon
    assert shapely.covers(outside.buffer(-2e-3), inside)
    assert shapely.covers(fine.buffer(1e-3), inside)
    assert shapely.covers(outside, fine.buffer(-1e-3))
    assert len(inside.exterior.coords) < 60 > len(outside.exterior.coords)
