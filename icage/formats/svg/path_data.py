"""Path data, by the grammar of SVG; what a browser would draw up to an error is refused here.

[SVG2018, Sec. 9]
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from icage.errors import FormatError
from icage.formats.drawings.curves import Bezier, Curve, EllipseArc
from icage.formats.svg.lengths import NUMBER

MAX_CURVES: Final = 50_000
"""Lines and curves of a drawing."""

Point = tuple[float, float]

_ARGUMENTS: Final = {
    "M": "nn", "L": "nn", "H": "n", "V": "n", "C": "nnnnnn", "S": "nnnn", "Q": "nnnn", "T": "nn",
    "A": "nnnffnn", "Z": "",
}  # fmt: skip
_GAP: Final = re.compile(r"[ \t\r\n\f]*")
_COMMA: Final = re.compile(r"[ \t\r\n\f]*,?[ \t\r\n\f]*")
_TOKENS: Final = {"n": re.compile(NUMBER), "f": re.compile("[01]")}

_FLAT: Final = 1e-14
"""Square of half a chord over the radius: below it an arc bulges by 2.5e-8 chords, a line here."""


class Malformed(ValueError):
    """Path data that break the grammar, with the place (a character from 1)."""

    def __init__(self, place: int) -> None:
        super().__init__(place)
        self.place = place


@dataclass(slots=True)
class Subpath:
    """Curves end to start, in the order in which they are drawn, and whether they are closed."""

    curves: list[Curve] = field(default_factory=list[Curve])
    closed: bool = False


def line(start: Point, end: Point) -> Bezier:
    """A straight edge."""
    return Bezier(np.array([start, end], dtype=np.float64))


def subpaths(text: str) -> list[Subpath]:
    """The subpaths that path data draw.

    Raises
    ------
    Malformed:
        Not path data.
    FormatError:
        Too many curves, or numbers that are not finite.

    Examples
    --------
    >>> [(len(one.curves), one.closed) for one in subpaths("M0 0h9v5z m1,1 2-3.5.5 1")]
    [(2, True), (2, False)]
    """
    pen = _Pen()
    place = _end(_GAP, text, 0)
    if text.strip().lower() == "none":
        return []
    while place < len(text):
        letter = text[place]
        kinds = _ARGUMENTS.get(letter.upper())
        if kinds is None or not (pen.begun or letter in "Mm"):
            raise Malformed(place + 1)
        place = _end(_GAP, text, place + 1)
        repeated = False
        while True:
            values, place = _values(text, place, kinds)
            pen.draw(_implied(letter) if repeated else letter, values)
            if not kinds:
                place = _end(_GAP, text, place)
                break
            after = _end(_COMMA, text, place)
            if after < len(text) and _TOKENS["n"].match(text, after):
                place, repeated = after, True
                continue
            gap = _end(_GAP, text, place)
            if gap != after:
                raise Malformed(after + 1)  # a comma with no number behind it
            place = gap
            break
    pen.lift()
    return pen.done


def _implied(letter: str) -> str:
    """What further numbers behind a command mean: behind a move, lines."""
    return {"M": "L", "m": "l"}.get(letter, letter)


def _end(pattern: re.Pattern[str], text: str, place: int) -> int:
    match = pattern.match(text, place)
    return match.end() if match else place


def _values(text: str, place: int, kinds: str) -> tuple[list[float], int]:
    values: list[float] = []
    for kind in kinds:
        if values:
            place = _end(_COMMA, text, place)
        match = _TOKENS[kind].match(text, place)
        if match is None:
            raise Malformed(place + 1)
        values.append(float(match[0]))
        place = match.end()
    if not all(map(math.isfinite, values)):
        raise FormatError("a path has numbers that are not finite")
    return values, place


class _Pen:
    """Draws commands one by one."""

    def __init__(self) -> None:
        self.done: list[Subpath] = []
        self.open = Subpath()
        self.begun = False
        self.at: Point = (0.0, 0.0)
        self.start: Point = (0.0, 0.0)
        self.last = ""
        self.control: Point = (0.0, 0.0)
        self.count = 0

    def lift(self) -> None:
        if self.open.curves:
            self.done.append(self.open)
        self.open = Subpath()

    def draw(self, letter: str, values: list[float]) -> None:
        command = letter.upper()
        relative = letter != command
        x, y = self.at if relative else (0.0, 0.0)
        control = self.at
        if command == "Z":
            if not self.open.curves and self.last == "M":
                self.to(self.at)  # drawn as a dot, if its line has caps
            self.open.closed = True
            self.lift()
            self.at = self.start
        elif command == "M":
            self.lift()
            self.begun = True
            self.at = self.start = (x + values[0], y + values[1])
        elif command == "H":
            self.to((x + values[0], self.at[1]))
        elif command == "V":
            self.to((self.at[0], y + values[0]))
        elif command == "A":
            self.arc(values[:5], (x + values[5], y + values[6]))
        else:
            points = [(x + p, y + q) for p, q in zip(values[::2], values[1::2], strict=True)]
            if command in "ST":
                mirrored = self.last in ("CS" if command == "S" else "QT")
                points.insert(0, self.mirror() if self.last and mirrored else self.at)
            if command != "L":
                control = points[-2]
            self.to(*points)
        self.last = command
        self.control = control

    def mirror(self) -> Point:
        return 2.0 * self.at[0] - self.control[0], 2.0 * self.at[1] - self.control[1]

    def to(self, *points: Point) -> None:
        self.add(Bezier(np.array([self.at, *points], dtype=np.float64)), points[-1])

    def add(self, curve: Curve, end: Point) -> None:
        self.count += 1
        if self.count > MAX_CURVES:
            raise FormatError(f"the drawing has more than {MAX_CURVES} lines and curves")
        self.open.curves.append(curve)
        self.at = end

    def arc(self, values: list[float], end: Point) -> None:
        if end == self.at:
            return
        curve = ellipse_arc(self.at, values, end)
        if curve is None:
            self.to(end)
        else:
            self.add(curve, end)


def ellipse_arc(start: Point, values: list[float], end: Point) -> EllipseArc | None:
    """The arc by its centre, for rx, ry, rotation and the two flags; None if it is a line.

    In coordinates where the ellipse is the unit circle around c, the ends are u and -u. Radii
    too small are scaled up. [SVG2018, Sec. 9]
    """
    rx, ry, degrees, large, sweeping = values
    rx, ry = abs(rx), abs(ry)
    if rx == 0.0 or ry == 0.0:
        return None
    turn = math.radians(math.fmod(degrees, 360.0))
    c, s = math.cos(turn), math.sin(turn)
    half = (start[0] - end[0]) / 2.0, (start[1] - end[1]) / 2.0
    u, v = (c * half[0] + s * half[1]) / rx, (-s * half[0] + c * half[1]) / ry
    square = u * u + v * v
    if not math.isfinite(square):
        raise FormatError("an arc of the drawing has numbers that are not finite")
    if square > 1.0:
        grown = math.sqrt(square)
        rx, ry, u, v, square = rx * grown, ry * grown, u / grown, v / grown, 1.0
    if square < _FLAT:
        if large:
            raise FormatError("an arc of the drawing has radii that are too large for its chord")
        return None
    side = math.sqrt((1.0 - square) / square) * (1.0 if large != sweeping else -1.0)
    p, q = side * v, -side * u
    first, last = math.atan2(v - q, u - p), math.atan2(-v - q, -u - p)
    angle = last - first
    if sweeping and angle < 0.0:
        angle += 2.0 * math.pi
    elif not sweeping and angle > 0.0:
        angle -= 2.0 * math.pi
    centre = (
        c * rx * p - s * ry * q + (start[0] + end[0]) / 2.0,
        s * rx * p + c * ry * q + (start[1] + end[1]) / 2.0,
    )
    along, across = np.array([c, s]) * rx, np.array([-s, c]) * ry
    return EllipseArc(np.array(centre), along, across, first, angle)
