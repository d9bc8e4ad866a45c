"""Transforms: the attribute, the CSS property, and where their origin is. [SVG2018, Sec. 8]"""

from __future__ import annotations

import math
import re
from typing import Final
from xml.etree.ElementTree import Element

from icage.formats.svg.lengths import NUMBER, SPACE, Measure, length
from icage.formats.svg.matrices import IDENTITY, Matrix, product, translation
from icage.formats.svg.xml_tree import refused

_FUNCTION: Final = re.compile(r"[\s,]*([A-Za-z0-9]+)\s*\(([^()]*)\)")
_ARGUMENT: Final = re.compile(rf"\s*,?\s*({NUMBER})([a-zA-Z]+|%)?")
_DEGREES: Final = {"deg": 1.0, "grad": 0.9, "rad": 180.0 / math.pi, "turn": 360.0}
_COUNTS: Final = {
    "matrix": (6,), "translate": (1, 2), "translatex": (1,), "translatey": (1,), "scale": (1, 2),
    "scalex": (1,), "scaley": (1,), "rotate": (1, 3), "skew": (1, 2), "skewx": (1,), "skewy": (1,),
}  # fmt: skip
_KEYWORDS: Final = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}


def transform(element: Element, text: str, css: bool, measure: Measure) -> Matrix:
    """The map of a transform list; ``css``: of the property, where numbers need their units.

    Raises
    ------
    FormatError:
        Not a list of the plane's transforms.
    """
    text = text.strip(SPACE)
    if text.lower() in ("", "none"):
        return IDENTITY
    total, place = IDENTITY, 0
    while place < len(text):
        match = _FUNCTION.match(text, place)
        step = match and _step(element, text, match[1].lower(), match[2], css, measure)
        if match is None or step is None:
            raise refused(element, "transform", text, kind="malformed ")
        total = product(total, step)
        place = match.end()
    if not all(map(math.isfinite, total)):
        raise refused(element, "transform", text, "is not finite")
    return total


def about_origin(
    element: Element, matrix: Matrix, origin: str, css: bool, measure: Measure
) -> Matrix:
    """The map with its origin at ``transform-origin``."""
    words = origin.lower().split()
    if not 1 <= len(words) <= 3:
        raise refused(element, "transform-origin", origin)
    first, second = words[0], words[1] if len(words) > 1 else "center"
    if first in ("top", "bottom") or (second in ("left", "right") and first not in _KEYWORDS):
        first, second = second, first
    if second in ("left", "right") and first == "center":
        first, second = second, first
    if first in ("top", "bottom") or second in ("left", "right"):
        raise refused(element, "transform-origin", origin)
    x = length(element, "transform-origin", _KEYWORDS.get(first, first), "x", measure, css)
    y = length(element, "transform-origin", _KEYWORDS.get(second, second), "y", measure, css)
    return product(product(translation(x, y), matrix), translation(-x, -y))


def _step(
    element: Element, text: str, name: str, inside: str, css: bool, measure: Measure
) -> Matrix | None:
    """One function of the list; None if it is not one of the plane."""
    given: list[tuple[str, str]] = []
    place = 0
    inside = inside.strip(SPACE)
    while place < len(inside):
        match = _ARGUMENT.match(inside, place)
        if match is None or (not given and inside.startswith(",")):
            return None
        given.append((match[1], match[2] or ""))
        place = match.end()
    if len(given) not in _COUNTS.get(name, ()) or (css and name == "rotate" and len(given) == 3):
        return None

    def moved(k: int) -> float:
        number, unit = given[k]
        along = "y" if name == "translatey" or (name == "translate" and k == 1) or k == 2 else "x"
        return length(element, "transform", number + unit, along, measure, css)

    if name.startswith("translate"):
        if name == "translatey":
            return translation(0.0, moved(0))
        return translation(moved(0), moved(1) if len(given) == 2 else 0.0)
    if name == "rotate":
        angle = _radians(*given[0], css)
        if angle is None:
            return None
        x, y = (moved(1), moved(2)) if len(given) == 3 else (0.0, 0.0)
        c, s = _cosine_sine(angle)
        turn: Matrix = (c, s, -s, c, 0.0, 0.0)
        return product(product(translation(x, y), turn), translation(-x, -y))
    if name.startswith("skew"):
        angles = [_radians(*one, css) for one in given]
        if None in angles:
            return None
        tangents = [math.tan(angle) for angle in angles if angle is not None]
        if name == "skewy":
            return (1.0, tangents[0], 0.0, 1.0, 0.0, 0.0)
        return (1.0, tangents[1] if len(tangents) == 2 else 0.0, tangents[0], 1.0, 0.0, 0.0)
    if any(unit for _, unit in given):
        return None
    values = [float(number) for number, _ in given]
    if name == "matrix":
        a, b, c, d, e, f = values
        return (a, b, c, d, e, f)
    x, y = values[0], values[-1]
    if name == "scalex":
        y = 1.0
    elif name == "scaley":
        x = 1.0
    return (x, 0.0, 0.0, y, 0.0, 0.0)


def _radians(number: str, unit: str, css: bool) -> float | None:
    value = float(number)
    if not unit:
        return None if css and value != 0.0 else math.radians(value)
    factor = _DEGREES.get(unit.lower())
    return None if factor is None else math.radians(value * factor)


def _cosine_sine(angle: float) -> tuple[float, float]:
    if not math.isfinite(angle):
        return math.nan, math.nan
    return math.cos(angle), math.sin(angle)
