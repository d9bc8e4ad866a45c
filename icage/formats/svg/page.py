"""The page of a drawing: its size, its unit, and the map of its view box. [SVG2018, Sec. 8]"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Final
from xml.etree.ElementTree import Element

from icage.formats.svg.lengths import ABSOLUTE, NUMBER, PHYSICAL, length
from icage.formats.svg.matrices import IDENTITY, Matrix
from icage.formats.svg.styles import Style
from icage.formats.svg.view_box import fitted, view_box
from icage.formats.svg.xml_tree import refused

_SIZE: Final = re.compile(rf"({NUMBER})\s*([a-zA-Z]*|%)")


@dataclass(frozen=True, slots=True)
class Page:
    """Where the contents of the root are drawn.

    Attributes
    ----------
    matrix:
        From the root's user units to drawing coordinates: pixels where the page has a size, else
        user units; y downwards.
    width, height:
        [user] Of the viewport, for percentages; None if unknown.
    frame:
        x_low, y_low, x_high, y_high of the page in drawing coordinates, y downwards, if it has one.
    unit:
        Physical unit in which the file says how large it is, in small letters, if it does.
    """

    matrix: Matrix
    width: float | None
    height: float | None
    frame: tuple[float, float, float, float] | None
    unit: str | None


def page_of(root: Element, style: Style) -> Page:
    """The page that the root element describes.

    A size of which only one side is given, the other being missing or a percentage of a window
    that nobody has, has the shape of its view box.

    Raises
    ------
    FormatError:
        A size that is not understood, or of no area.
    """
    box = view_box(root)
    width, wide = _size(root, style, "width")
    height, high = _size(root, style, "height")
    unit = wide or high
    if box is not None:
        if width is None and height is None:
            frame = (box.x, box.y, box.x + box.width, box.y + box.height)
            return Page(IDENTITY, box.width, box.height, frame, None)
        if width is None:
            width = (height or 0.0) * box.width / box.height
        if height is None:
            height = width * box.height / box.width
        matrix = fitted(root, box, width, height)
        return Page(matrix, box.width, box.height, (0.0, 0.0, width, height), unit)
    known = width is not None and height is not None
    frame = (0.0, 0.0, width or 0.0, height or 0.0) if known else None
    return Page(IDENTITY, width, height, frame, unit)


def _size(root: Element, style: Style, name: str) -> tuple[float | None, str | None]:
    """[px] One side of the page, and its physical unit; None where it has none."""
    given = style.given(name)
    text = given.text
    if not text or text.lower() == "auto":
        return None, None
    match = _SIZE.fullmatch(text)
    if match is None:
        raise refused(root, name, text)
    number, unit = float(match[1]), match[2].lower()
    if number <= 0.0 or not math.isfinite(number):
        raise refused(root, name, text, "is no size")
    if unit == "%":
        return None, None
    if unit in PHYSICAL:
        return number * ABSOLUTE[unit], unit
    plain = text if unit else match[1]
    return length(root, name, plain, "x", style.measure(None, None), given.css), None
