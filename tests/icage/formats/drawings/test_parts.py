"""Which area is the object: background, parts that touch, parts that are picked, lines."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage.errors import FormatError, InputError
from icage.formats.drawings.curves import EllipseArc, Polyline
from icage.formats.drawings.drawing import Drawing, Line, Shape
from icage.formats.drawings.reading import Reading
from icage.formats.drawings.trace import traced


def box(x: float, y: float, w: float, h: float, *names: str) -> Shape:
    corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]]
    return Shape(((Polyline(np.array(corners, dtype=float)),),), names)


def disc(x: float, y: float, radius: float) -> Shape:
    one = np.eye(2) * radius
    return Shape(((EllipseArc(np.array([x, y]), one[0], one[1], 0.0, 2 * math.pi),),))


def lines(*paths: list[list[float]], names: tuple[str, ...] = ()) -> tuple[Line, ...]:
    return tuple(Line((Polyline(np.array(path, dtype=float)),), names) for path in paths)


def area(drawing: Drawing, **reading: object) -> float:
    return traced(drawing, Reading(width=10.0, **reading)).outline.area  # type: ignore[arg-type]


def notes(drawing: Drawing, **reading: object) -> str:
    return " ".join(traced(drawing, Reading(width=10.0, **reading)).notes)  # type: ignore[arg-type]


TWO = Drawing((box(0, 0, 10, 10, "plate", "all"), box(20, 0, 5, 10, "bar", "all")))


def test_several_parts_are_picked_by_area_or_name():
    with pytest.raises(FormatError, match=r"2 separate filled parts \(areas 66.7 %, 33.3 %\)"):
        area(TWO)
    assert area(TWO, pick="largest") == pytest.approx(100.0)
    assert area(TWO, pick=1) == pytest.approx(100.0)
    assert area(TWO, pick="2") == pytest.approx(50.0)
    assert area(TWO, pick="id=bar") == pytest.approx(50.0)
    assert "largest was taken" in notes(TWO, pick="largest")
    with pytest.raises(FormatError, match="pick is 3; the drawing has 2 separate"):
        area(TWO, pick=3)
    with pytest.raises(FormatError, match=r"'bolt'; the drawing has 'plate', 'all', 'bar'"):
        area(TWO, pick="id=bolt")
    with pytest.raises(FormatError, match="2 separate"):
        area(TWO, pick="id=all")
    with pytest.raises(FormatError, match="the drawing has one part"):
        area(Drawing(TWO.shapes[:1]), pick=2)


@pytest.mark.parametrize("pick", ["", "id=", "0", "smallest", 0, -1, True, 1.5])
def test_a_pick_that_says_nothing_is_refused(pick: object):
    with pytest.raises(InputError, match="pick is"):
        Reading(pick=pick)  # type: ignore[arg-type]


def test_parts_nearer_than_the_tolerance_are_one():
    gap = 0.005
    two = Drawing((box(0, 0, 5, 2), box(5 + gap, 0, 5 - gap, 2)))
    assert area(two) == pytest.approx(20.0, rel=1e-3)
    with pytest.raises(FormatError, match="2 separate"):
        area(two, tolerance=gap / 2)


def test_three_parts_in_a_chain_are_one_and_a_far_one_is_not():
    chain = [box(2.0 * k + 0.004 * k, 0, 2.0, 2) for k in range(3)]
    assert area(Drawing(tuple(chain))) == pytest.approx(100 / 3.0, rel=3e-3)
    with pytest.raises(FormatError, match="2 separate"):
        area(Drawing((*chain, box(9, 0, 1, 1))))


@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_parts_that_are_near_at_a_corner_alone_are_one(gap: float):
    two = Drawing((box(0, 0, 5, 5), box(5 + gap, 5 + gap, 5 - gap, 5 - gap)))
    found = traced(two, Reading(width=10.0))
    assert found.outline.area == pytest.approx(50.0, rel=1e-3)
    assert found.distance <= found.tolerance
    tip = Shape(((Polyline(np.array([[5 + gap, 2], [10, 0], [10, 4], [5 + gap, 2]])),),))
    assert area(Drawing((box(0, 0, 5, 5), tip))) == pytest.approx(35.0, rel=1e-3)
    board = [box(x, y, 1, 1) for x in range(10) for y in range(10) if (x + y) % 2 == 0]
    assert area(Drawing(tuple(board))) > 50.0  # squares that touch around holes
    if gap:
        with pytest.raises(FormatError, match="2 separate"):
            area(two, tolerance=gap / 2)


def test_slivers_that_touch_the_object_do_not_grow_into_parts_of_their_own():
    thin = Shape(((Polyline(np.array([[0, 0], [10, 0], [10, 1e-7], [0, 0]])),),))
    far = traced(Drawing((box(0, 0, 10, 5), thin, box(0, -1e-9, 10, 0))), Reading(width=10.0))
    assert far.outline.area == pytest.approx(50.0, rel=1e-3)
    below = Shape(((Polyline(np.array([[0, 0], [10, -0.0005], [10, -0.0006], [0, 0]])),),))
    found = traced(Drawing((box(0, 0, 10, 5), below)), Reading(width=10.0))
    assert found.outline.area == pytest.approx(50.0, rel=1e-3)
    assert found.distance <= found.tolerance


def test_a_background_is_said_and_can_be_left_out():
    page = Drawing((box(0, 0, 20, 20), disc(10, 10, 5)), frame=(0, 0, 20, 20))
    assert "covers all others" in notes(page)
    assert area(page) == pytest.approx(100.0)
    assert area(page, background=False) == pytest.approx(25 * math.pi, rel=3e-3)
    round_page = Drawing((disc(10, 10, 10), box(5, 5, 10, 10)), frame=(0, 0, 20, 20))
    assert "covers all others" in notes(round_page)
    assert area(round_page, background=False) == pytest.approx(100.0)
    details = Drawing((disc(10, 10, 10), box(5, 5, 10, 10)), frame=(-9, -9, 40, 40))
    assert "covers" not in notes(details)
    assert "covers" not in notes(Drawing((box(0, 0, 2, 1), box(0, 0, 2, 1))))


def test_a_background_around_lines_is_said_and_can_be_left_out():
    page, path = box(0, 0, 20, 20), lines([[5, 5], [15, 5], [15, 10], [5, 5]])
    both = Drawing((page,), path)
    assert "the lines are left out; if it is the background" in notes(both)
    assert "covers all others" in notes(both, strokes="outline")
    assert area(both, strokes="outline", background=False) == pytest.approx(25.0)
    assert "lines" not in notes(Drawing((page,), lines([[5, 5], [25, 5]])))
    assert "lines" not in notes(Drawing((disc(10, 10, 9),), path))


def test_frames_of_lines_are_said_and_can_be_left_out():
    def ring(x: float, y: float, w: float, h: float) -> list[list[float]]:
        return [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]]

    sheet = [ring(0, 0, 50, 40), ring(1, 1, 48, 38), ring(30, 1, 19, 5)]  # with a title block
    part = [[[10, 10], [20, 10], [10, 20], [10, 10]], ring(12, 12, 1, 1)]
    drawing = Drawing(lines=lines(*sheet, *part), edges=True)
    assert "if that is a frame, --no-background leaves it out" in notes(drawing)
    assert area(drawing, background=False) == pytest.approx(50.0)
    said = notes(drawing, background=False)
    assert "a frame around all other contours was left out" in said
    assert "a closed contour inside the outline left out: the outer ring counts" in said
    assert "frame" not in notes(Drawing(lines=lines(*part), edges=True))
    filled = Drawing(TWO.shapes[:1], lines(ring(-5, -5, 20, 20)))
    assert "covers all others" in notes(filled, strokes="outline")
    assert area(filled, strokes="outline", background=False) == pytest.approx(100.0)


def test_holes_are_left_out_and_said():
    ring = Shape((disc(0, 0, 5).rings[0], disc(0, 0, 2).rings[0]), (), "evenodd")
    assert area(Drawing((ring,))) == pytest.approx(25 * math.pi, rel=3e-3)
    assert "a hole inside the outline left out" in notes(Drawing((ring,)))


def test_clips_cut_a_shape():
    clip = (box(0, 0, 5, 20), box(0, 0, 20, 5))
    cut = Shape(box(0, 0, 10, 10).rings, (), "nonzero", (clip,))
    assert area(Drawing((cut,))) == pytest.approx(75.0)
    twice = Shape(box(0, 0, 10, 10).rings, (), "nonzero", (clip, (box(0, 0, 10, 2),)))
    assert area(Drawing((twice,))) == pytest.approx(20.0)


SQUARE = ([[0, 0], [10, 0]], [[10, 10], [10, 0]], [[10, 10], [0, 10]], [[0, 10], [0, 0]])


def test_lines_count_only_if_asked_for_or_in_cad():
    drawn = Drawing(lines=lines(*map(list, SQUARE)))
    with pytest.raises(FormatError, match="strokes only: try --strokes outline"):
        area(drawn)
    assert area(drawn, strokes="outline") == pytest.approx(100.0)
    assert area(Drawing(lines=drawn.lines, edges=True)) == pytest.approx(100.0)
    with pytest.raises(FormatError, match="strokes only"):
        area(Drawing(lines=drawn.lines, edges=True), strokes="ignore")
    with pytest.raises(FormatError, match="nothing in the drawing is filled"):
        area(Drawing())


def test_loose_ends_are_joined_across_a_gap():
    loose = ([[0, 0], [9.9, 0]], [[10, 0.05], [10, 10]], [[10, 10], [0, 10]], [[0, 10], [0, 0]])
    drawing = Drawing(lines=lines(*map(list, loose)), edges=True)
    with pytest.raises(FormatError, match="--gap G"):
        area(drawing)
    assert area(drawing, gap=0.2) == pytest.approx(100.0, rel=2e-2)


def test_nested_contours_are_the_outer_one_and_crossings_close_areas():
    inner = [[[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]]
    assert area(Drawing(lines=lines(*map(list, SQUARE), *inner), edges=True)) == pytest.approx(100)
    cross = ([[-1, 0], [11, 0]], [[-1, 10], [11, 10]], [[0, -1], [0, 11]], [[10, -1], [10, 11]])
    assert area(Drawing(lines=lines(*map(list, cross)), edges=True)) == pytest.approx(100.0)


def test_the_drawn_width_of_a_line_counts_if_asked_for():
    line = Line((Polyline(np.array([[0.0, 0.0], [8.0, 0.0]])),), (), 2.0, "square")
    assert area(Drawing(lines=(line,)), strokes="drawn") == pytest.approx(20.0)
    with pytest.raises(FormatError, match="enclose no area"):
        area(Drawing(lines=(line,)), strokes="outline")
    ring = Line(disc(0, 0, 4).rings[0], (), 2.0)
    whole = traced(Drawing(lines=(ring,)), Reading(width=10.0, strokes="drawn"))
    assert whole.outline.area == pytest.approx(25 * math.pi, rel=3e-3)
