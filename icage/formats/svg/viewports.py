"""Nested drawings and symbols: their place, size and view box. [SVG2018, Sec. 5, Sec. 8]"""

from __future__ import annotations

from itertools import pairwise
from typing import Final, NamedTuple
from xml.etree.ElementTree import Element

from icage.formats.drawings.drawing import Shape
from icage.formats.svg.lengths import Along, Measure, length
from icage.formats.svg.matrices import IDENTITY, Matrix, placed, product, translation
from icage.formats.svg.path_data import line
from icage.formats.svg.styles import Style
from icage.formats.svg.view_box import fitted, view_box
from icage.formats.svg.xml_tree import local_name, refused

Sides = tuple[str | None, str | None]
"""Width and height that ``use`` asks for."""

_PLACE: Final[tuple[tuple[str, Along], ...]] = (("x", "x"), ("y", "y"))
_SIZE: Final[tuple[tuple[str, Along], ...]] = (("width", "x"), ("height", "y"))


class Viewport(NamedTuple):
    """Where a nested drawing is drawn.

    Attributes
    ----------
    place:
        From the viewport, (0, 0) to ``sides``, to the user units around.
    matrix:
        From its contents' user units to those around.
    sides:
        Width and height, in the user units around.
    width, height:
        [user] The same in its contents' units, for percentages.
    cuts:
        Whether what is outside is not shown.
    """

    place: Matrix
    matrix: Matrix
    sides: tuple[float, float]
    width: float
    height: float
    cuts: bool


def shift(element: Element, style: Style, measure: Measure) -> Matrix:
    """By x and y of a nested drawing or a ``use``."""
    x, y = (
        length(element, name, style.given(name).text or "0", along, measure, style.given(name).css)
        for name, along in _PLACE
    )
    return translation(x, y)


def viewport_of(element: Element, style: Style, measure: Measure, asked: Sides) -> Viewport | None:
    """The viewport of an ``svg`` or, where ``use`` draws it, a ``symbol``; None if it has no area.

    Raises
    ------
    FormatError:
        A length that is not understood, or that browsers do not agree about.
    """
    is_symbol = local_name(element) == "symbol"
    sides: list[float] = []
    for (name, along), wanted in zip(_SIZE, asked, strict=True):
        given = style.given(name)
        own = "" if given.text == "auto" else given.text
        if is_symbol:
            if own not in ("", "100%") and not wanted:
                raise refused(element, name, own, "is not supported on a symbol")
            own = ""
        text = wanted or own or "100%"
        side = length(element, name, text, along, measure, given.css and text == own)
        if side < 0.0:
            raise refused(element, name, text, "is negative")
        sides.append(side)
    width, height = sides
    if width == 0.0 or height == 0.0:
        return None
    if is_symbol:
        for name in ("x", "y", "refX", "refY"):
            if element.get(name, "0").strip() not in ("", "0"):
                raise refused(element, name, element.get(name, ""), "is not supported on a symbol")
    place = IDENTITY if is_symbol else shift(element, style, measure)
    cuts = style.text("overflow") or "hidden"
    if cuts not in ("visible", "auto", "hidden", "scroll", "clip"):
        raise refused(element, "overflow", cuts)
    cut = cuts not in ("visible", "auto")
    box = view_box(element)
    if box is None:
        return Viewport(place, place, (width, height), width, height, cut)
    matrix = product(place, fitted(element, box, width, height))
    return Viewport(place, matrix, (width, height), box.width, box.height, cut)


def rectangle(width: float, height: float, matrix: Matrix) -> Shape:
    """(0, 0) to (width, height), mapped."""
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0)]
    edges = pairwise(corners)
    return Shape((tuple(placed(line(a, b), matrix) for a, b in edges),))
