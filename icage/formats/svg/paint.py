"""Whether a fill or a stroke paints: colours, paint servers, opacities. [SVG2018, Sec. 13]"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final
from xml.etree.ElementTree import Element

from tinycss2.color4 import parse_color

from icage.formats.svg.document import Document
from icage.formats.svg.lengths import Measure, length, share
from icage.formats.svg.styles import Style
from icage.formats.svg.xml_tree import local_name, refused

URL: Final = re.compile(r"""url\(\s*(["']?)(.*?)\1\s*\)\s*(.*)""", re.IGNORECASE | re.DOTALL)

_SYSTEM: Final = {
    "accentcolor", "accentcolortext", "activetext", "buttonborder", "buttonface", "buttontext",
    "canvas", "canvastext", "field", "fieldtext", "graytext", "highlight", "highlighttext",
    "linktext", "mark", "marktext", "selecteditem", "selecteditemtext", "visitedtext", "window",
    "windowtext", "menu", "menutext", "background", "buttonhighlight", "buttonshadow",
}  # fmt: skip
"""Colours of the user's system: all opaque. [CSSColor2022, Sec. 6]"""

_LONGEST: Final = 200
"""Characters of a colour."""

_ICC: Final = re.compile(r"\s+icc-color\([^()]*\)$", re.IGNORECASE)


def is_filled(document: Document, element: Element, style: Style) -> bool:
    """Whether the element's area is painted.

    Raises
    ------
    FormatError:
        A paint that is not understood.
    """
    return _paints(document, element, style, "fill")


def is_stroked(document: Document, element: Element, style: Style) -> bool:
    """Whether the element's line is painted, if it has a width."""
    return _paints(document, element, style, "stroke")


def stroke_width(element: Element, style: Style, measure: Measure) -> float:
    """[user] The drawn width of the element's line."""
    text = style.given("stroke-width").text
    value = length(element, "stroke-width", text, "both", measure)
    if value < 0.0:
        raise refused(element, "stroke-width", text, "is negative")
    return value


def _paints(document: Document, element: Element, style: Style, name: str) -> bool:
    opacity = share(element, f"{name}-opacity", style.text(f"{name}-opacity"))
    given = style.given(name).text
    if given.lower() == "none":
        return False
    match = URL.fullmatch(given)
    if match is None:
        return opacity > 0.0 and _is_seen(element, name, given, style)
    url, fallback = match[2].strip(), match[3].strip()
    if url.startswith("#") and not document.has(url):
        # A missing paint is the one named behind it, else none.  [SVG2018, Sec. 13]
        seen = bool(fallback) and fallback.lower() != "none"
        return opacity > 0.0 and seen and _is_seen(element, name, fallback, style)
    server = document.target(element, name, url)
    if server not in document.paints:
        document.paints[server] = _server_paints(document, element, name, server)
    return opacity > 0.0 and document.paints[server]


def _is_seen(element: Element, name: str, colour: str, style: Style) -> bool:
    if colour.lower() == "currentcolor":
        name, colour = "color", style.given("color").text
        if colour.lower() == "currentcolor":
            return True
    alpha = _alpha(_ICC.sub("", colour))
    if alpha is None:
        raise refused(element, name, colour)
    return alpha > 0.0


@lru_cache(maxsize=10_000)
def _alpha(colour: str) -> float | None:
    if len(colour) > _LONGEST:
        return None
    if colour.lower() in _SYSTEM:
        return 1.0
    parsed = parse_color(colour)
    if parsed is None or isinstance(parsed, str):
        return None
    return float(getattr(parsed, "alpha", 1.0))


def _server_paints(document: Document, user: Element, name: str, server: Element) -> bool:
    """Whether a gradient has a stop that is seen, or a pattern anything to repeat."""
    tag = local_name(server)
    if tag not in ("linearGradient", "radialGradient", "pattern"):
        raise refused(user, name, f"url(#{server.get('id')})", f"is a <{tag}>: not supported")
    seen: set[Element] = set()
    source: Element | None = server
    while source is not None and source not in seen:
        seen.add(source)
        document.step()
        if tag == "pattern":
            if len(source):
                document.note("what is filled with a pattern counts as filled wholly")
                return True
        else:
            stops = [stop for stop in source if local_name(stop) == "stop"]
            if stops:
                return any(_stop_is_seen(document, stop) for stop in stops)
        source = document.template(source)
    return False


def _stop_is_seen(document: Document, stop: Element) -> bool:
    document.step()
    style = document.style_in_place(stop)
    if share(stop, "stop-opacity", style.text("stop-opacity")) <= 0.0:
        return False
    return _is_seen(stop, "stop-color", style.given("stop-color").text, style)
