"""A DXF file as a drawing: the lines that its model space shows, and its header's unit."""

from __future__ import annotations

from icage.errors import FormatError
from icage.formats.drawings.drawing import Drawing
from icage.formats.drawings.reading import Reading
from icage.formats.dxf.blocks import WORLD, Shown, show
from icage.formats.dxf.layers import Layers
from icage.formats.dxf.tags import document
from icage.formats.dxf.units import UNITS
from icage.library_faults import decoding_told


def read(content: bytes, reading: Reading) -> Drawing:
    """The drawing in a DXF document, text or binary.

    Raises
    ------
    FormatError:
        Not a readable DXF drawing, or something in it that is not understood.
    """
    found = document(content)
    with decoding_told("ezdxf", "the DXF file"):  # it raises what it meets where it is asked
        space = found.content.modelspace()
        if not len(space):
            raise FormatError(_nothing(found.content))
        shown = Shown(Layers(found.content, reading.layers))
        show(space, WORLD, shown)
    if not shown.lines:
        passed = ", ".join(repr(name) for name in sorted(shown.layers.passed)[:20])
        raise FormatError(
            "the model space shows no lines"
            + (f"; the layers {passed} are not read" if passed else "")
            + (f"; it has {_counts(shown)} only" if shown.left_out.total() else "")
        )
    notes = [*found.notes, *shown.notes]
    if shown.left_out.total():
        notes.append(f"left out, as no outline: {_counts(shown)}")
    low, high = shown.heights
    if high - low > 1e-9 * max(abs(low), abs(high), 1.0):
        notes.append(f"entities lie at heights z from {low:g} to {high:g}, which are left out")
    unit = UNITS.get(found.insunits or 0)
    if unit is None:
        return Drawing(lines=tuple(shown.lines), sure=False, edges=True, notes=tuple(notes))
    return Drawing(
        lines=tuple(shown.lines),
        metre=unit.metre,
        unit=unit.unit,
        size_from=f"the header's {unit.name} ($INSUNITS)",
        sure=False,
        edges=True,
        notes=tuple(notes),
    )


def _nothing(content: object) -> str:
    """Why there is nothing to read."""
    papers = [layout for layout in content.layouts if layout.name != "Model"]  # type: ignore[attr-defined]
    drawn = [(layout.name, len(layout)) for layout in papers if len(layout)]
    if not drawn:
        return "the drawing is empty: its model space has no entities"
    told = ", ".join(f"{name!r} has {count}" for name, count in drawn[:5])
    return f"the model space is empty; paper space is not read (the layout {told} entities)"


def _counts(shown: Shown) -> str:
    return ", ".join(f"{count} {kind}" for kind, count in sorted(shown.left_out.items()) if count)
