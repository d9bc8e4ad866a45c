"""An SVG file as a drawing: what it fills, what it strokes, the size that it states."""

from __future__ import annotations

from dataclasses import replace
from typing import Final
from xml.etree.ElementTree import Element

from icage.formats.drawings.drawing import Drawing, Line, Shape
from icage.formats.drawings.reading import Reading
from icage.formats.svg.clips import ClipPaths
from icage.formats.svg.conditions import holds
from icage.formats.svg.document import Document
from icage.formats.svg.lengths import share
from icage.formats.svg.matrices import Matrix, product
from icage.formats.svg.page import Page, page_of
from icage.formats.svg.paint import is_filled, is_stroked, stroke_width
from icage.formats.svg.rings import rings
from icage.formats.svg.shapes import subpaths_of
from icage.formats.svg.strokes import lines_of
from icage.formats.svg.structure import (
    NOT_READ,
    Met,
    State,
    Walk,
    names_of,
    refuse_animations,
    refuse_given,
)
from icage.formats.svg.styles import INITIAL, check_supported
from icage.formats.svg.xml_tree import local_name, parse, refused

_PIXEL: Final = 0.0254 / 96.0
"""[m] A pixel of a drawing that states its size: 96 an inch. [CSS2024, Sec. 6.2]"""

_UPWARDS: Final[Matrix] = (1.0, 0.0, 0.0, -1.0, 0.0, 0.0)
_MARKERS: Final = ("marker-start", "marker-mid", "marker-end")
_MARKED: Final = ("path", "line", "polyline", "polygon")

_LEFT_OUT: Final = {
    "text": "text is left out: convert it to paths in the drawing program",
    "image": "an image in the drawing is left out",
    "foreignObject": "a foreignObject in the drawing is left out",
}


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing in an SVG document, as a browser shows it.

    Raises
    ------
    FormatError:
        Not a readable SVG drawing, or something in it that is not understood.
    """
    root = parse(content)
    document = Document(root)
    style = document.style_of(root, INITIAL)
    page = page_of(root, style)
    shapes: list[Shape] = []
    lines: list[Line] = []
    refuse_animations(root)
    if (
        holds(root)
        and style.text("display") != "none"
        and share(root, "opacity", style.text("opacity")) > 0.0
    ):
        check_supported(root, style)
        refuse_given(root, style, "transform")
        refuse_given(root, style, "clip-path")
        matrix = product(_UPWARDS, page.matrix)
        state = State(style, matrix, page.width, page.height, names=names_of(root))
        for met in Walk(document, ClipPaths(document)).page(root, state):
            _draw(document, met, reading, shapes, lines)
    return _sized(Drawing(tuple(shapes), tuple(lines), notes=tuple(document.notes)), page)


def _draw(
    document: Document, met: Met, reading: Reading, shapes: list[Shape], lines: list[Line]
) -> None:
    """Add what one element paints."""
    element, state = met.element, met.state
    tag, style = local_name(element), state.style
    if style.one_of(element, "visibility", "visible", "hidden", "collapse") != "visible":
        return
    if tag in NOT_READ:
        document.note(_LEFT_OUT[tag])
        return
    filled = tag != "line" and is_filled(document, element, style)
    stroked = is_stroked(document, element, style)
    width = stroke_width(element, style, state.measure) if stroked else 0.0
    stroked = width > 0.0
    marked = tag in _MARKED and any(style.text(name) != "none" for name in _MARKERS)
    if not (filled or stroked or marked):
        return
    parts = subpaths_of(element, style, state.measure)
    if not parts:
        return
    document.add_curves(sum(len(part.curves) for part in parts))
    document.clip(state.clips)
    counts = filled or (stroked and reading.strokes not in (None, "ignore"))
    if marked:
        _check_markers(document, element, state, counts)
    if filled:
        rule = style.one_of(element, "fill-rule", "nonzero", "evenodd")
        fill_rule = "evenodd" if rule == "evenodd" else "nonzero"
        shapes.append(Shape(rings(parts, state.matrix), state.names, fill_rule, state.clips))
    if stroked:
        lines += lines_of(document, element, state, parts, width, reading.strokes == "drawn")


def _check_markers(document: Document, element: Element, state: State, counts: bool) -> None:
    """Refuse the markers of what counts, tell of the others."""
    for name in _MARKERS:
        text = state.style.given(name).text
        if text.lower() == "none":
            continue
        if counts:
            raise refused(element, name, text, "is not supported")
        document.note("markers (arrow heads) on lines are left out")


def _sized(drawing: Drawing, page: Page) -> Drawing:
    """With the page, and the size that it states."""
    frame = page.frame
    if frame is not None:
        x_low, y_low, x_high, y_high = frame
        drawing = replace(drawing, frame=(x_low, -y_high, x_high, -y_low))
    if page.unit is None:
        return drawing
    unit = "cm" if page.unit == "cm" else "mm"
    size_from = f"the file's {page.unit}"
    return replace(drawing, metre=_PIXEL, unit=unit, size_from=size_from)
