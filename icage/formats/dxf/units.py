"""What a number of $INSUNITS means. [DXF2012]"""

from __future__ import annotations

from typing import Final, NamedTuple

from icage.units import Unit


class HeaderUnit(NamedTuple):
    """A unit of a header.

    Attributes
    ----------
    name:
        In words.
    metre:
        [m] One of it.
    unit:
        To answer in.
    """

    name: str
    metre: float
    unit: Unit


UNITS: Final[dict[int, HeaderUnit]] = {
    1: HeaderUnit("inches", 0.0254, "mm"),
    2: HeaderUnit("feet", 0.3048, "m"),
    4: HeaderUnit("mm", 1e-3, "mm"),
    5: HeaderUnit("cm", 1e-2, "cm"),
    6: HeaderUnit("m", 1.0, "m"),
    7: HeaderUnit("km", 1e3, "m"),
    8: HeaderUnit("microinches", 0.0254e-6, "mm"),
    9: HeaderUnit("mils", 0.0254e-3, "mm"),
    10: HeaderUnit("yards", 0.9144, "m"),
    12: HeaderUnit("nanometres", 1e-9, "mm"),
    13: HeaderUnit("micrometres", 1e-6, "mm"),
    14: HeaderUnit("dm", 0.1, "cm"),
    15: HeaderUnit("dam", 10.0, "m"),
    16: HeaderUnit("hm", 100.0, "m"),
    21: HeaderUnit("US survey feet", 1200.0 / 3937.0, "m"),
}
"""Those in which a part may be drawn; 0 is none, others are taken for none."""
