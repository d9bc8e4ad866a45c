"""Basic shapes and paths as subpaths, in their own user units. [SVG2018, Sec. 9, Sec. 10]"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Final
from xml.etree.ElementTree import Element

import numpy as np

from icage.formats.drawings.curves import EllipseArc
from icage.formats.svg.lengths import Along, Measure, length, numbers
from icage.formats.svg.path_data import Malformed, Point, Subpath, line, subpaths
from icage.formats.svg.styles import Style
from icage.formats.svg.xml_tree import local_name, refused

SHAPES: Final = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")


def subpaths_of(element: Element, style: Style, measure: Measure) -> list[Subpath]:
    """The subpaths of a shape.

    Raises
    ------
    FormatError:
        A malformed attribute, or a length that is not understood.
    """
    tag = local_name(element)
    if tag == "path":
        return _path(element, style)
    if tag in ("polyline", "polygon"):
        return _poly(element, tag == "polygon")
    read = _Lengths(element, style, measure)
    if tag == "rect":
        return _rect(read)
    if tag == "line":
        ends = [read.attribute(name, along) for name, along in _LINE]
        return [Subpath([line((ends[0], ends[1]), (ends[2], ends[3]))])]
    if tag == "circle":
        rx = ry = read.size("r", "both") or 0.0
    else:
        rx, ry = _radii(read)
    return _ellipse(read.length("cx", "x"), read.length("cy", "y"), rx, ry)


_LINE: Final[tuple[tuple[str, Along], ...]] = (("x1", "x"), ("y1", "y"), ("x2", "x"), ("y2", "y"))


class _Lengths:
    """Reads the lengths of one element."""

    def __init__(self, element: Element, style: Style, measure: Measure) -> None:
        self.element = element
        self.style = style
        self.measure = measure

    def length(self, name: str, along: Along) -> float:
        """A length, 0 if there is none."""
        given = self.style.given(name)
        if not given.text or given.text == "auto":
            return 0.0
        return length(self.element, name, given.text, along, self.measure, given.css)

    def size(self, name: str, along: Along) -> float | None:
        """A length that cannot be negative, None if there is none."""
        given = self.style.given(name)
        if not given.text or given.text == "auto":
            return None
        value = length(self.element, name, given.text, along, self.measure, given.css)
        if value < 0.0:
            raise refused(self.element, name, given.text, "is negative")
        return value

    def attribute(self, name: str, along: Along) -> float:
        """A length that is an attribute only."""
        text = self.element.get(name, "").strip() or "0"
        return length(self.element, name, text, along, self.measure)


def _path(element: Element, style: Style) -> list[Subpath]:
    given = style.given("d")
    text = given.text
    if given.css:
        inside = text.removeprefix("path(").removesuffix(")").strip()
        if not text.startswith("path(") or inside[:1] not in ("'", '"'):
            raise refused(element, "d", text)
        text = inside[1:-1]
    try:
        return subpaths(text)
    except Malformed as error:
        place = error.place
        near = "at its end" if place > len(text) else f"at character {place}"
        raise refused(element, "d", text, f"breaks off {near}", "malformed ") from error


def _poly(element: Element, closed: bool) -> list[Subpath]:
    text = element.get("points", "")
    values = numbers(text)
    if values is None or len(values) % 2:
        raise refused(element, "points", text, "is no list of pairs", "malformed ")
    if not all(map(math.isfinite, values)):
        raise refused(element, "points", text, "is not finite")
    points: list[Point] = list(zip(values[::2], values[1::2], strict=True))
    edges = [line(a, b) for a, b in pairwise(points)]
    return [Subpath([*edges], closed)] if edges else []


def _rect(read: _Lengths) -> list[Subpath]:
    x, y = read.length("x", "x"), read.length("y", "y")
    w, h = read.size("width", "x") or 0.0, read.size("height", "y") or 0.0
    rx, ry = _radii(read)
    if w == 0.0 or h == 0.0:
        return []
    rx, ry = min(rx, w / 2.0), min(ry, h / 2.0)
    if rx == 0.0 or ry == 0.0:
        corners: list[Point] = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
        return [Subpath([line(a, b) for a, b in pairwise(corners)], True)]
    ring = Subpath(closed=True)
    quarter = math.pi / 2.0
    pen: Point | None = None
    for k, (cx, cy) in enumerate(
        ((x + w - rx, y + ry), (x + w - rx, y + h - ry), (x + rx, y + h - ry), (x + rx, y + ry))
    ):
        arc = _arc(cx, cy, rx, ry, (k - 1) * quarter, quarter)
        first, last = arc.at(np.array([0.0, 1.0])).tolist()
        if pen is not None and pen != (first[0], first[1]):
            ring.curves.append(line(pen, (first[0], first[1])))
        ring.curves.append(arc)
        pen = (last[0], last[1])
    return [ring]


def _radii(read: _Lengths) -> tuple[float, float]:
    """The radii rx and ry; where one is not given, it is the other one."""
    rx, ry = read.size("rx", "x"), read.size("ry", "y")
    return rx if rx is not None else ry or 0.0, ry if ry is not None else rx or 0.0


def _ellipse(cx: float, cy: float, rx: float, ry: float) -> list[Subpath]:
    if rx == 0.0 or ry == 0.0:
        return []
    return [Subpath([_arc(cx, cy, rx, ry, 0.0, 2.0 * math.pi)], True)]


def _arc(cx: float, cy: float, rx: float, ry: float, start: float, sweep: float) -> EllipseArc:
    return EllipseArc(np.array([cx, cy]), np.array([rx, 0.0]), np.array([0.0, ry]), start, sweep)
