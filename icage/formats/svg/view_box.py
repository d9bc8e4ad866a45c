"""View boxes and how they fit into their viewport. [SVG2018, Sec. 8]"""

from __future__ import annotations

import math
from typing import Final, NamedTuple
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.svg.lengths import numbers
from icage.formats.svg.matrices import Matrix
from icage.formats.svg.xml_tree import local_name, quoted, refused

_ALONG_X: Final = {"xMin": 0.0, "xMid": 0.5, "xMax": 1.0}
_ALONG_Y: Final = {"YMin": 0.0, "YMid": 0.5, "YMax": 1.0}
"""Which share of the room that is left lies before the box."""


class ViewBox(NamedTuple):
    """Lower left corner and size, in user units."""

    x: float
    y: float
    width: float
    height: float


def view_box(element: Element) -> ViewBox | None:
    """The view box that an element states, if any.

    Raises
    ------
    FormatError:
        Not four finite numbers, or no area.
    """
    text = element.get("viewBox", "").strip()
    if not text:
        return None
    values = numbers(text)
    if values is None or len(values) != 4 or not all(map(math.isfinite, values)):
        raise refused(element, "viewBox", text)
    box = ViewBox(*values)
    if box.width <= 0.0 or box.height <= 0.0:
        raise refused(element, "viewBox", text, "has no area")
    return box


def fitted(element: Element, box: ViewBox, width: float, height: float) -> Matrix:
    """The map of a view box into (0, 0, width, height), by ``preserveAspectRatio``.

    Raises
    ------
    FormatError:
        A ``preserveAspectRatio`` that is not understood.
    """
    text = element.get("preserveAspectRatio", "").strip()
    words = [word for word in text.split() if word != "defer"] or ["xMidYMid"]
    x, y = width / box.width, height / box.height
    align, fit = words[0], words[1] if len(words) > 1 else "meet"
    if len(words) > 2 or fit not in ("meet", "slice"):
        raise refused(element, "preserveAspectRatio", text)
    if align == "none":
        return (x, 0.0, 0.0, y, -x * box.x, -y * box.y)
    if align[:4] not in _ALONG_X or align[4:] not in _ALONG_Y:
        raise refused(element, "preserveAspectRatio", text)
    scale = min(x, y) if fit == "meet" else max(x, y)
    left = _ALONG_X[align[:4]] * (width - scale * box.width)
    top = _ALONG_Y[align[4:]] * (height - scale * box.height)
    return (scale, 0.0, 0.0, scale, left - scale * box.x, top - scale * box.y)


def check_finite(element: Element, matrix: Matrix) -> None:
    """Refuse a map that no coordinates survive."""
    if not all(map(math.isfinite, matrix)):
        name = element.get("id")
        where = f"<{local_name(element)}>" + (f" {quoted(name)}" if name else "")
        raise FormatError(f"the transforms around {where} have numbers that are not finite")
