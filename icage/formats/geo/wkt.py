"""WKT: one geometry or several, as databases write them, EWKT's SRID too. [Herring2011]"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

import numpy as np
import shapely

from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.files import decode
from icage.formats.geo.shapes import DEGREES, Found, add, drawing_of

MAX_DEPTH: Final = 50
"""Brackets in brackets; the parser's stack is not endless."""

_SRID: Final = re.compile(r"\s*SRID\s*=\s*(\d{1,9})\s*;", re.IGNORECASE)

_DEGREES: Final = frozenset((4326, 4269, 4258, 4979))
"""Numbers of systems that count in degrees."""


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing in a WKT text. Raises FormatError."""
    found, notes = Found(), dict[str, None]()
    for text in _geometries(decode(content, "the WKT file")):
        srid = _SRID.match(text)
        if srid:
            text = text[srid.end() :]
            if int(srid[1]) in _DEGREES:
                notes[DEGREES] = None
        try:
            with np.errstate(all="ignore"):
                geometry = shapely.from_wkt(text)
        except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
            why = " ".join(str(error).split())[:100]
            raise FormatError(f"{text.strip()[:30]!r}... is no WKT that is read: {why}") from error
        add(geometry, (), found)
    return drawing_of(found, notes)


def _geometries(text: str) -> Iterator[str]:
    """Pieces of the text that are whole: brackets closed, before the next word or a semicolon."""
    depth, start = 0, 0
    for mark in re.finditer(r"[()]", text):
        depth += 1 if mark[0] == "(" else -1
        if depth > MAX_DEPTH:
            raise FormatError(f"the WKT is nested more than {MAX_DEPTH} deep")
        if depth < 0:
            raise FormatError("the WKT closes a bracket that it did not open")
        if depth == 0:
            yield text[start : mark.end()].lstrip(" \t\r\n;")
            start = mark.end()
    rest = text[start:].strip(" \t\r\n;")
    if depth > 0:
        raise FormatError("the WKT is cut off: a bracket is not closed")
    if rest:
        yield rest
