"""Strokes as lines of a drawing: the path, and how wide it is drawn. [SVG2018, Sec. 13]"""

from __future__ import annotations

from typing import Final, Literal
from xml.etree.ElementTree import Element

from icage.errors import FormatError
from icage.formats.drawings.drawing import Line
from icage.formats.svg.document import Document
from icage.formats.svg.lengths import length
from icage.formats.svg.matrices import placed, similarity_scale
from icage.formats.svg.path_data import Subpath
from icage.formats.svg.rings import closing
from icage.formats.svg.structure import State
from icage.formats.svg.xml_tree import local_name, refused

_CAPS: Final[dict[str, Literal["flat", "round", "square"]]] = {
    "butt": "flat", "round": "round", "square": "square",
}  # fmt: skip
_JOINS: Final[dict[str, Literal["mitre", "round", "bevel"]]] = {
    "miter": "mitre", "round": "round", "bevel": "bevel",
}  # fmt: skip

_LONGEST: Final = 1_000
"""Characters of a list of dashes that could all be zero."""


def lines_of(
    document: Document, element: Element, state: State, parts: list[Subpath], width: float,
    drawn: bool,
) -> list[Line]:  # fmt: skip
    """The lines of a stroked element; ``drawn``: their drawn width counts.

    Raises
    ------
    FormatError:
        Where the drawn width counts: dashes, or a width that is not the same everywhere.
    """
    style = state.style
    scale = similarity_scale(state.matrix)
    if style.text("stroke-dasharray") != "none" and not _is_solid(element, state):
        if drawn:
            given = style.given("stroke-dasharray").text
            raise refused(element, "stroke-dasharray", given, "is not supported as a drawn width")
        document.note("dashed lines count as whole lines")
    cap, join, limit = "butt", "miter", 4.0
    if drawn:
        style.one_of(element, "vector-effect", "none")
        if scale is None:
            raise FormatError(
                f"the line of a <{local_name(element)}> is stretched by its transform, which is "
                "not supported as a drawn width"
            )
        cap = style.one_of(element, "stroke-linecap", *_CAPS)
        join = style.one_of(element, "stroke-linejoin", *_JOINS)
        text = style.given("stroke-miterlimit").text
        limit = length(element, "stroke-miterlimit", text, "x", state.measure)
        limit = max(limit, 1.0)
    found: list[Line] = []
    for part in parts:
        chain = [placed(curve, state.matrix) for curve in part.curves]
        if part.closed:
            chain.append(closing(chain))
        found.append(
            Line(
                tuple(chain),
                state.names,
                width=width * (scale or 0.0),
                cap=_CAPS[cap],
                join=_JOINS[join],
                mitre_limit=limit,
                clips=state.clips,
                capped=not part.closed,
            )
        )
    return found


def _is_solid(element: Element, state: State) -> bool:
    """Whether a list of dashes means none: all of them are zero."""
    text = state.style.given("stroke-dasharray").text
    if len(text) > _LONGEST:
        return False
    words = text.replace(",", " ").split()
    return not any(
        length(element, "stroke-dasharray", word, "both", state.measure) for word in words
    )
