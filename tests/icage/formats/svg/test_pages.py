"""Sizes of pages, names of shapes, notes, and what a reader tells besides areas."""

from __future__ import annotations

import pytest

from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading, Strokes
from icage.formats.svg.reader import read
from tests.icage.formats.svg.drawings import drawing

R = '<rect width="40" height="30"/>'
BOX = 'viewBox="0 0 100 50"'


def found(body: str, attributes: str = "", strokes: Strokes | None = None) -> Drawing:
    space = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
    return read(drawing(body, space + attributes).encode(), Reading(strokes=strokes))


@pytest.mark.parametrize(
    ("attributes", "frame", "unit"),
    [
        ("", None, None),
        (BOX, (0, -50, 100, 0), None),
        (f'width="200" {BOX}', (0, -100, 200, 0), None),
        (f'height="200px" {BOX}', (0, -200, 400, 0), None),
        ('width="96" height="50%"', None, None),
        (f'width="1in" {BOX}', (0, -48, 96, 0), "in"),
        (f'width="100%" height="1IN" {BOX}', (0, -96, 192, 0), "in"),
        (f'width="auto" height=" 2.54 cm " {BOX}', (0, -96, 192, 0), "cm"),
        (f'width="72pt" height="6pc" {BOX}', (0, -96, 96, 0), "pt"),
        (f'width="96px" height="25.4mm" {BOX}', (0, -96, 96, 0), "mm"),
        (f'style="width:1in;height:101.6q" {BOX}', (0, -96, 96, 0), "in"),
        (f'width="2em" height="4rem" font-size="10" {BOX}', (0, -40, 20, 0), None),
        ('viewBox="-10 -20 100 50"', (-10, -30, 90, 20), None),
    ],
)
def test_a_page_has_the_size_that_it_states(
    attributes: str, frame: tuple[float, ...] | None, unit: str | None
):
    page = found(R, attributes)
    assert page.frame == (None if frame is None else pytest.approx(frame))
    assert (page.metre is None) == (unit is None)
    assert page.size_from == ("" if unit is None else f"the file's {unit}")


@pytest.mark.parametrize(
    "attributes",
    [
        'width="0mm"',
        'width="-4mm"',
        'height="1e999mm"',
        'width="4 furlong"',
        'width="fine"',
        'width="calc(4mm + 2mm)"',
        'width="10vw"',
        'style="width:40"',
        'viewBox="0 0 0 9"',
        'viewBox="0 0 9 -9"',
        'viewBox="0 0 9 1e999"',
        f'width="9" height="9" {BOX} preserveAspectRatio="xMidYMid fit"',
        'transform="scale(2)"',
        'clip-path="url(#c)"',
    ],
)
def test_what_is_no_page_is_quoted(attributes: str):
    name, _, value = attributes.partition('="')
    with pytest.raises(FormatError) as caught:
        found(R, attributes)
    if name == "style":
        name, value = "width", "40"
    assert f"{name}=" in str(caught.value) or "preserveAspectRatio" in str(caught.value)
    assert value.split('"')[0] in str(caught.value) or "preserveAspectRatio" in str(caught.value)


def test_a_share_of_no_page_is_refused():
    with pytest.raises(FormatError, match=r"width='50%'.* states no size"):
        found('<rect width="50%" height="9"/>')


def test_shapes_and_lines_know_the_names_around_them():
    body = (
        '<g id="layer1" inkscape:label="Tool"><rect id="r" width="9" height="9" stroke="red"/></g>'
        '<defs><path id="p" d="M0 0h9v9z"/></defs><use id="u" href="#p"/>'
    )
    both = found(body, 'id="root"')
    assert [shape.names for shape in both.shapes] == [
        ("root", "layer1", "Tool", "r"),
        ("root", "u", "p"),
    ]
    assert both.lines[0].names == ("root", "layer1", "Tool", "r")


@pytest.mark.parametrize(
    ("body", "note"),
    [
        ("<text>a</text>", "text is left out: convert it to paths"),
        ('<image href="a.png" width="9" height="9"/>', "an image in the drawing is left out"),
        ("<foreignObject/>", "foreignObject"),
        ("<script>x</script>", "scripts in the drawing are not run"),
        ('<path d="M0 0h9" stroke="red" stroke-dasharray="1 2" fill="none"/>', "dashed lines"),
        ('<path d="M0 0h9" stroke="red" fill="none" marker-end="url(#m)"/>', "arrow heads"),
        (
            '<pattern id="p"><path/></pattern><rect width="9" height="9" fill="url(#p)"/>',
            "filled with a pattern",
        ),
    ],
)
def test_what_is_left_out_is_said_once(body: str, note: str):
    notes = found(R + body + body.replace('id="p"', "")).notes
    assert len(notes) == 1
    assert note in notes[0]


def test_what_nobody_sees_is_not_said():
    hidden = '<g display="none"><text>a</text></g><text visibility="hidden">a</text>'
    assert found(R + hidden).notes == ()


def test_markers_on_lines_that_count_are_refused():
    line = '<path d="M0 0h9v9z" stroke="red" fill="none" marker-end="url(#m)"/>'
    with pytest.raises(FormatError, match="marker-end='url"):
        found(line, strokes="outline")
