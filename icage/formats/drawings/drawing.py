"""What a reader finds in a file: areas and lines, in the file's own lengths, x right and y up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from icage.formats.drawings.curves import Curve
from icage.formats.drawings.fill import FillRule
from icage.units import Unit

Ring = tuple[Curve, ...]
"""Curves end to start; of a shape the last one ends where the first one starts."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """An area: closed rings, and the rule by which they fill it together.

    Attributes
    ----------
    rings:
        Closed chains of curves.
    names:
        The ids by which it can be picked: its own, those of the groups around it, its layer.
    rule:
        How the rings fill.
    clips:
        Each is a union of areas; what is outside of any of them is cut away.
    """

    rings: tuple[Ring, ...]
    names: tuple[str, ...] = ()
    rule: FillRule = "nonzero"
    clips: tuple[tuple[Shape, ...], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A drawn line: a chain of curves, closed or open, that fills nothing.

    Attributes
    ----------
    chain:
        Curves end to start.
    names:
        As of a shape.
    width:
        [file] The drawn width; 0 for a line that has none.
    cap, join, mitre_limit:
        How its ends and corners are drawn, in shapely's words.
    clips:
        As of a shape; they cut the drawn width, not the path itself.
    capped:
        Whether its ends are drawn as ends even where they meet.
    """

    chain: Ring
    names: tuple[str, ...] = ()
    width: float = 0.0
    cap: Literal["flat", "round", "square"] = "flat"
    join: Literal["mitre", "round", "bevel"] = "mitre"
    mitre_limit: float = 4.0
    clips: tuple[tuple[Shape, ...], ...] = ()
    capped: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """What a file holds.

    Attributes
    ----------
    shapes:
        Filled areas.
    lines:
        Drawn lines.
    metre:
        [m] One unit of the file's coordinates; None if the file does not say.
    unit:
        Unit to answer in where none is asked for; None if the file does not say.
    size_from:
        Where ``metre`` is from, in words ("the file's mm"); empty if the file does not say.
    sure:
        Whether that can be relied on. A DXF header is often a leftover, so a ``--unit`` that is
        given is then taken as the unit of the coordinates, in place of the file's.
    edges:
        Whether lines bound the areas, as in CAD; else they count only if asked for.
    frame:
        x_low, y_low, x_high, y_high of the page, in the file's lengths; None without a page.
    notes:
        What a reader must know about how the file was understood, a sentence each.
    """

    shapes: tuple[Shape, ...] = ()
    lines: tuple[Line, ...] = ()
    metre: float | None = None
    unit: Unit | None = None
    size_from: str = ""
    sure: bool = True
    edges: bool = False
    frame: tuple[float, float, float, float] | None = None
    notes: tuple[str, ...] = ()
