"""One outline from a drawing, and how far it is from what the drawing shows. Our own.

The outline is the outer ring of the object's area, simplified within the tolerance, scaled to the
size that the drawing states or the user gives, x to the right and y upwards, and moved so that the
lower left corner of the area's bounding box is (0, 0).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import shapely

from icage.arrays import FloatArray
from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing, Line, Shape
from icage.formats.drawings.parts import (
    FLATTEN,
    check_painted,
    corners_of,
    lines_count,
    object_part,
    shapes_meant,
    size,
)
from icage.formats.drawings.reading import Reading
from icage.formats.drawings.simplify import simplified
from icage.library_faults import geometry_told
from icage.outline import Outline
from icage.units import METRES, Unit

DEFAULT_TOLERANCE: Final = 1e-3
"""[width] Tolerance where none is given. [docs/formats.md, Case file]"""

TOLERANCE_RANGE: Final = (1e-6, 0.1)
"""[width] Finer is beyond any drawing, coarser is no outline of it."""

_SIMPLIFY: Final = 0.95
"""[tolerance] Share of simplification; flattening takes ``FLATTEN`` of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Traced:
    """An outline and what it was made from.

    Attributes
    ----------
    outline:
        In ``unit``.
    unit:
        Unit of all lengths here.
    size_from:
        Where the size is from, in words.
    tolerance:
        [unit] Largest distance between the drawing's area and the outline that was allowed.
    source:
        The drawing's area, flattened to ``FLATTEN`` of the tolerance, in the outline's frame.
    notes:
        Warnings, a sentence each.
    """

    outline: Outline
    unit: Unit
    size_from: str
    tolerance: float
    source: shapely.Polygon
    notes: tuple[str, ...]

    @property
    def symmetric_difference(self) -> float:
        """[unit^2] Area that is in the drawing or in the outline, but not in both."""
        with geometry_told():
            return float(self.source.symmetric_difference(self.outline.polygon).area)

    @property
    def distance(self) -> float:
        """[unit] Largest distance of a vertex of either boundary from the other one."""
        ring, own = self.source.exterior, self.outline.polygon.exterior
        with geometry_told():
            return float(shapely.hausdorff_distance(ring, own))


def traced(drawing: Drawing, reading: Reading) -> Traced:
    """The outline of the drawing's object.

    Raises
    ------
    FormatError:
        Nothing is filled, several parts and none picked, no size stated where none is given, or
        numbers out of range.
    OutlineError:
        The outline has more vertices than an ``Outline`` may have.
    """
    if reading.width is not None:
        _relative(reading.tolerance, reading.width)
    unit, scale, size_from, notes = _sized(drawing, reading)
    drawing = shapes_meant(drawing, reading)
    check_painted(drawing, reading)
    counted = (*drawing.shapes, *(drawing.lines if lines_count(drawing, reading) else ()))
    drawn = size(corners_of(counted))
    # What has no area, or is not picked, may reach further than the object: measured once more.
    rough = DEFAULT_TOLERANCE * drawn
    rough_gap = _gap(reading, rough, scale)
    part = object_part(drawing, reading, rough, rough_gap)
    drawn = size(part.area)
    width = drawn * scale if reading.width is None else reading.width
    tolerance = _relative(reading.tolerance, width) * drawn
    scale = width / drawn
    gap = _gap(reading, tolerance, scale)
    if (tolerance, gap) != (rough, rough_gap):  # most often they are the same
        part = object_part(drawing, reading, tolerance, gap)
    ring = _ring(part.area)
    if reading.safe is None:
        fewer = simplified(ring, _SIMPLIFY * tolerance)
    else:
        from icage.formats.drawings.one_sided import one_sided

        straight = all(_is_straight(one) for one in counted)
        fewer = one_sided(
            ring, _SIMPLIFY * tolerance, reading.safe, 0.0 if straight else FLATTEN * tolerance
        )
    low = ring.min(axis=0)
    scale = width / float((ring.max(axis=0) - low).max())
    outline = Outline((fewer - low) * scale)
    source = shapely.Polygon((ring - low) * scale)
    notes = (*drawing.notes, *notes, *part.notes)
    return Traced(outline, unit, size_from, tolerance * scale, source, tuple(dict.fromkeys(notes)))


def _sized(drawing: Drawing, reading: Reading) -> tuple[Unit, float, str, tuple[str, ...]]:
    """Unit, [unit] one of the file's lengths, where from in words, and what is to be warned of."""
    own = drawing.unit
    unit: Unit = reading.unit or own or "m"
    notes: list[str] = []
    if reading.width is not None:
        words = f"from --width {reading.width:g} {unit}"
        if reading.unit is None:
            why = "as in the file" if own else "the file states none"
            words += f" (no --unit given: {unit} is assumed, {why})"
        return unit, 1.0, words, ()
    if drawing.metre is None:
        if reading.unit is None or drawing.sure:
            raise FormatError(
                "the drawing states no size in mm, cm or in; a width is needed"
                + (" (--width W)" if drawing.sure else " (--width W --unit U), or --unit U")
            )
        return unit, 1.0, f"from --unit {unit}", ()
    if not drawing.sure and reading.unit is not None:
        return unit, 1.0, f"from --unit {unit} (not {drawing.size_from})", ()
    if not drawing.sure:
        notes.append(
            f"the size is from {drawing.size_from}, which is often wrong: check it, "
            "or give --unit or --width"
        )
    return unit, drawing.metre / METRES[unit], f"from {drawing.size_from}", tuple(notes)


def _relative(tolerance: float | None, width: float) -> float:
    """The tolerance as a share of the width."""
    relative = DEFAULT_TOLERANCE if tolerance is None else tolerance / width
    low, high = TOLERANCE_RANGE
    if not low * (1 - 1e-9) <= relative <= high * (1 + 1e-9):
        raise FormatError(
            f"tolerance is {relative * width:g}; {low * width:g} to {high * width:g} is allowed "
            f"({low:g} to {high:g} of the width)"
        )
    return relative


def _gap(reading: Reading, tolerance: float, scale: float) -> float:
    """[file] Nearer ends of lines are joined."""
    return tolerance if reading.gap is None else reading.gap / scale


def _is_straight(piece: Shape | Line) -> bool:
    if piece.clips and not all(_is_straight(one) for clip in piece.clips for one in clip):
        return False
    chains = piece.rings if isinstance(piece, Shape) else (piece.chain,)
    return all(curve.bend() == 0.0 for chain in chains for curve in chain)


def _ring(part: shapely.Polygon) -> FloatArray:
    return shapely.get_coordinates(part.exterior)[:-1]
