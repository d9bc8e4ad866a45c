"""How a drawing is to be read: the options that every format shares, and those of some."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Final, Literal, TypeAlias, TypedDict, cast

from icage.checks import a_number, one_of
from icage.errors import FormatError, InputError
from icage.units import UNITS, Unit

Strokes: TypeAlias = Literal["ignore", "outline", "drawn"]
Side: TypeAlias = Literal["inside", "outside"]
Axis: TypeAlias = Literal["x", "y", "z"]

STROKES: Final[tuple[Strokes, ...]] = ("ignore", "outline", "drawn")
SIDES: Final[tuple[Side, ...]] = ("inside", "outside")
AXES: Final[tuple[Axis, ...]] = ("x", "y", "z")

LARGEST: Final = "largest"
"""``pick``: the part with the largest area."""

BY_ID: Final = "id="
"""``pick``: begins the id of the shapes, the group or the layer that is meant."""


class ReadingOptions(TypedDict, total=False):
    """The fields of ``Reading``, as keywords of ``icage.load``."""

    width: float | None
    unit: Unit | None
    tolerance: float | None
    strokes: Strokes | None
    gap: float | None
    pick: int | str | None
    background: bool | None
    safe: Side | None
    layers: tuple[str, ...] | None
    section: float | None
    axis: Axis | None
    threshold: float | None


@dataclass(frozen=True, slots=True)
class Reading:
    """How a drawing is to be read; every field may be left out (None).

    Attributes
    ----------
    width:
        [unit] Longer side of the outline's bounding box; the size that the file states if None.
    unit:
        Unit of the answer and of all lengths here; the file's own if None, else m.
    tolerance:
        [unit] Largest distance between drawing and outline; 0.1 % of the width if None.
    strokes:
        Lines without a fill: "ignore" them, take the area that they enclose ("outline"), or what
        their drawn width covers, too ("drawn"). "ignore" if None.
    gap:
        [unit] Loose ends of lines nearer than this are joined; the tolerance if None.
    pick:
        Which of several separate parts: a number from 1, by area; "largest"; or "id=NAME", the
        shapes, group or layer of that name.
    background:
        False: a shape that covers all others is left out.
    safe:
        An outline that lies "inside" the drawing (sigma_max is then a lower bound) or one that
        holds it ("outside": an upper bound), still within the tolerance.
    layers:
        Layers of a DXF file to read; all that are visible if None.
    section:
        Height along ``axis`` at which a mesh is cut, in its own coordinates; its silhouette if
        None.
    axis:
        Along which a mesh is looked at: "z" if None.
    threshold:
        0 to 1: pixels of an image that are darker (or, with an alpha channel, more opaque) than
        this are the object; if None, the middle between the dark and the light pixels' medians
        (of an alpha channel 0.5).

    Raises
    ------
    InputError:
        A value that is not allowed.
    """

    width: float | None = None
    unit: Unit | None = None
    tolerance: float | None = None
    strokes: Strokes | None = None
    gap: float | None = None
    pick: int | str | None = None
    background: bool | None = None
    safe: Side | None = None
    layers: tuple[str, ...] | None = None
    section: float | None = None
    axis: Axis | None = None
    threshold: float | None = None

    def __post_init__(self) -> None:
        for name in ("width", "tolerance", "gap"):
            value = getattr(self, name)
            if value is not None and a_number(value, name, FormatError) <= 0.0:
                raise FormatError(f"{name} is {value:g}; a finite number above 0 is needed")
        if self.section is not None:
            a_number(self.section, "section")
        for name, allowed in (
            ("unit", UNITS), ("strokes", STROKES), ("safe", SIDES), ("axis", AXES)
        ):  # fmt: skip
            if getattr(self, name) is not None:
                one_of(getattr(self, name), allowed, name)
        if self.threshold is not None and not 0.0 < a_number(self.threshold, "threshold") < 1.0:
            raise InputError(f"threshold is {self.threshold:g}; between 0 and 1 is needed")
        if self.layers is not None and not _is_names(self.layers):
            raise InputError(f"layers is {self.layers!r:.60}; a tuple of names is needed")
        if self.background is not None and not _is_flag(self.background):
            raise InputError(f"background is {self.background!r:.60}; true or false is needed")
        if self.pick is not None:
            object.__setattr__(self, "pick", _picked(self.pick))

    def given(self) -> dict[str, Any]:
        """The fields that are not None.

        >>> Reading(unit="mm", pick="2").given()
        {'unit': 'mm', 'pick': 2}
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


def _is_flag(value: object) -> bool:
    return isinstance(value, bool)


def _is_names(value: object) -> bool:
    """Whether this is a tuple of words."""
    if not isinstance(value, tuple):
        return False
    return all(isinstance(name, str) for name in cast("tuple[object, ...]", value))


def _picked(pick: object) -> int | str:
    """A number from 1, "largest" or "id=NAME"."""
    if isinstance(pick, str):
        if pick == LARGEST or (pick.startswith(BY_ID) and len(pick) > len(BY_ID)):
            return pick
        if pick.isascii() and pick.isdigit() and int(pick[:9]) > 0:
            return int(pick[:9])
    elif isinstance(pick, int) and not isinstance(pick, bool) and pick > 0:
        return pick
    raise InputError(f"pick is {pick!r}; a number from 1, {LARGEST!r} or '{BY_ID}NAME' is needed")


def option_of(name: str) -> str:
    """How a field is called on the command line.

    >>> option_of("pick"), option_of("background")
    ('--pick', '--no-background')
    """
    return "--no-background" if name == "background" else f"--{name}"
