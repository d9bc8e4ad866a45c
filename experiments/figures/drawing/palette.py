"""One set of colours for every picture, readable with any kind of colour blindness.

The three fingers take blue, vermillion and bluish green of Okabe and Ito's palette
[Okabe2008], which stay apart for protan, deutan and tritan vision; numbers beside
the fingers say the same without colour.
"""

from __future__ import annotations

from typing import Final

Colour = tuple[float, float, float]
"""Red, green, blue in 0..1."""


def _rgb(text: str) -> Colour:
    value = int(text, 16)
    return ((value >> 16) / 255.0, (value >> 8 & 255) / 255.0, (value & 255) / 255.0)


FINGERS: Final[tuple[Colour, Colour, Colour]] = (_rgb("0072B2"), _rgb("D55E00"), _rgb("009E73"))
"""Fingers 1, 2, 3."""

OBJECT_FILL: Final = _rgb("E4E1DA")
OBJECT_EDGE: Final = _rgb("3A3A3A")
INK: Final = _rgb("1E2429")
QUIET_INK: Final = _rgb("68727A")
RULE: Final = _rgb("C9CED2")
PAPER: Final = (1.0, 1.0, 1.0)
GOOD: Final = _rgb("1B7F5A")
BAD: Final = _rgb("B3261E")
SKY: Final = _rgb("56B4E9")
ORANGE: Final = _rgb("E69F00")
PURPLE: Final = _rgb("A8478A")
"""More of the same palette, for marks that are no fingers (the purple darker, to show on grey)."""


def tint(colour: Colour, strength: float) -> Colour:
    """The colour over white paper, ``strength`` of 1 keeps it: opaque, so that regions that meet
    along an edge show no seam as two translucent ones would.

    >>> tint((0.0, 0.0, 0.0), 0.25)
    (0.75, 0.75, 0.75)
    """
    red, green, blue = (1.0 - strength * (1.0 - part) for part in colour)
    return red, green, blue
