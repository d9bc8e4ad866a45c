"""Numbers and lengths of SVG and CSS, in user units. [SVG2018, Sec. 4] [CSS2024, Sec. 6]"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Final, Literal
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.svg.xml_tree import refused

NUMBER: Final = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"

ABSOLUTE: Final = {
    "px": 1.0, "in": 96.0, "cm": 96.0 / 2.54, "mm": 96.0 / 25.4, "q": 96.0 / 101.6,
    "pt": 96.0 / 72.0, "pc": 16.0,
}  # fmt: skip
"""[px] One of each unit. [CSS2024, Sec. 6.2]"""

PHYSICAL: Final = ("mm", "cm", "in", "pt", "pc", "q")

MAX_NUMBERS: Final = 100_000
"""Of one list."""

_LENGTH: Final = re.compile(rf"({NUMBER})([a-zA-Z]+|%)?")
_WINDOW: Final = ("vw", "vh", "vi", "vb", "vmin", "vmax")

Along = Literal["x", "y", "both"]
"""Of which side of the viewport a percentage is."""


@dataclass(frozen=True, slots=True)
class Measure:
    """What relative lengths of an element refer to, in its user units.

    Attributes
    ----------
    width, height:
        Of the nearest viewport; None if the page states no size.
    font_size, root_font_size:
        For ``em`` and ``rem``; a text that could not be understood as it stands.
    """

    width: float | None
    height: float | None
    font_size: float | str = 16.0
    root_font_size: float | str = 16.0

    def side(self, along: Along) -> float | None:
        """What 100 % are."""
        if along == "x":
            return self.width
        if along == "y":
            return self.height
        if self.width is None or self.height is None:
            return None
        return math.sqrt((self.width**2 + self.height**2) / 2.0)


def length(
    element: Element, name: str, text: str, along: Along, measure: Measure, css: bool = False
) -> float:
    """[user] A length; ``css``: only 0 may stand without a unit.

    Raises
    ------
    FormatError:
        Not a length, a unit that is not understood or has nothing to refer to, not finite.
    """
    match = _LENGTH.fullmatch(text.strip())
    if match is None:
        raise refused(element, name, text, "cannot be read as a length")
    number, unit = float(match[1]), (match[2] or "").lower()
    if not math.isfinite(number):
        raise refused(element, name, text, "is not finite")
    if not unit:
        if css and number != 0.0:
            raise refused(element, name, text, "has no unit, as CSS needs one")
        return number
    if unit in ABSOLUTE:
        return number * ABSOLUTE[unit]
    if unit == "%":
        side = measure.side(along)
        if side is None:
            raise refused(element, name, text, "is a share of a page that states no size")
        return number / 100.0 * side
    if unit in ("em", "rem"):
        size = measure.font_size if unit == "em" else measure.root_font_size
        if isinstance(size, str):
            raise refused(element, name, text, f"needs the font-size {size!r:.60}: not understood")
        return number * size
    if unit in ("ex", "ch", "cap", "ic", "lh", "rlh"):
        raise refused(element, name, text, "depends on the font")
    if unit in _WINDOW:
        raise refused(element, name, text, "depends on the window of the browser")
    raise refused(element, name, text, "cannot be read as a length")


def numbers(text: str) -> list[float] | None:
    """Numbers with white space, a comma, or nothing between them; None if it is no such list.

    >>> numbers("0,0 24-1.5.5"), numbers("1,,2"), numbers("1 x")
    ([0.0, 0.0, 24.0, -1.5, 0.5], None, None)
    """
    found: list[float] = []
    place = 0
    text = text.strip(SPACE)
    while place < len(text):
        match = (_NEXT if found else _FIRST).match(text, place)
        if match is None:
            return None
        found.append(float(match[1]))
        if len(found) > MAX_NUMBERS:
            raise FormatError(f"the drawing has a list of more than {MAX_NUMBERS} numbers")
        place = match.end()
    return found


SPACE: Final = " \t\r\n\f"
_FIRST: Final = re.compile(rf"({NUMBER})")
_NEXT: Final = re.compile(rf"[ \t\r\n\f]*,?[ \t\r\n\f]*({NUMBER})")


def share(element: Element, name: str, text: str) -> float:
    """A number or a percentage from 0 to 1, as of an opacity; beyond them the nearer one."""
    match = re.fullmatch(rf"({NUMBER})(%?)", text.strip())
    if match is None:
        raise refused(element, name, text)
    value = float(match[1]) / (100.0 if match[2] else 1.0)
    return min(max(value, 0.0), 1.0)
