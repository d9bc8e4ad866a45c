"""An SVG file as a drawing: what it fills, what it strokes, the size that it states."""

from __future__ import annotations

from typing import Final

from icage.formats.drawings.drawing import Drawing, Shape
from icage.formats.drawings.reading import Reading
from icage.formats.svg.shapes import drawn_shapes
from icage.formats.svg.tree import drawable

_PIXEL: Final = 0.0254 / 96.0
"""[m] A pixel of a drawing that states its size: 96 an inch. [CSS2024, Sec. 6.2]"""


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing in an SVG document.

    Raises
    ------
    FormatError:
        Not a readable SVG drawing, or something in it that is not understood.
    """
    reduced, own_unit = drawable(content)
    shapes = tuple(
        Shape(tuple(tuple(ring) for ring in rings), (), rule)
        for rule, rings in drawn_shapes(reduced)
    )
    if own_unit is None:
        return Drawing(shapes)
    unit = "cm" if own_unit == "cm" else "mm"
    return Drawing(shapes, metre=_PIXEL, unit=unit, size_from=f"the file's own size, in {own_unit}")
