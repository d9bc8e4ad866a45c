"""The options that say how a drawing is to be read, wherever a drawing may stand."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from experiments.io.options import UNITS, number, positive

if TYPE_CHECKING:
    from icage.case import Case
    from icage.formats.drawings.reading import Reading

DRAWINGS_HELP = "SVG, DXF, STL, OBJ, PLY, PNG, JPG, GeoJSON or WKT"


def add_reading(parser: argparse.ArgumentParser, tolerance: bool = True) -> None:
    """``--width --unit --pick`` and all the others; ``--tolerance`` unless the command has one."""
    group = parser.add_argument_group("drawings", f"How a drawing ({DRAWINGS_HELP}) is read.")
    group.add_argument(
        "--width", type=positive, metavar="W",
        help="longer side of the object, in UNIT (the size that the drawing states, if any)",
    )  # fmt: skip
    group.add_argument(
        "--unit", choices=UNITS,
        help="unit of the answer and of all lengths here (the one in which the drawing states its "
        "size; m if it states none); of a DXF file or a mesh, the unit of its coordinates",
    )  # fmt: skip
    if tolerance:
        group.add_argument(
            "--tolerance", type=positive, metavar="T",
            help="largest distance between drawing and outline, in UNIT (0.1 %% of the width)",
        )  # fmt: skip
    group.add_argument(
        "--pick", metavar="N|largest|id=NAME",
        help="which of several separate parts: by area, from 1, or the shapes, group or layer of "
        "that name",
    )  # fmt: skip
    group.add_argument(
        "--strokes", choices=("ignore", "outline", "drawn"),
        help="lines without a fill: leave them out (default; not in CAD files), take what they "
        "enclose, or what their drawn width covers, too",
    )  # fmt: skip
    group.add_argument(
        "--gap", type=positive, metavar="G",
        help="loose ends of lines nearer than G are joined, in UNIT (the tolerance)",
    )  # fmt: skip
    group.add_argument(
        "--no-background", dest="background", action="store_const", const=False,
        help="leave out a shape that covers all others",
    )  # fmt: skip
    group.add_argument(
        "--safe", choices=("inside", "outside"),
        help="an outline that lies inside the drawing (its sigma_max is a lower bound), or one "
        "around it (an upper bound)",
    )  # fmt: skip
    group.add_argument(
        "--layers", metavar="NAME", action="append",
        help="of a DXF file, read this layer; may be given several times (all visible ones)",
    )  # fmt: skip
    group.add_argument(
        "--section", type=number, metavar="H",
        help="of a mesh, the section at height H, in UNIT (its silhouette)",
    )  # fmt: skip
    group.add_argument("--axis", choices=("x", "y", "z"), help="along which to look at a mesh (z)")
    group.add_argument(
        "--threshold", type=number, metavar="P",
        help="of an image, from 0 to 1: darker (more opaque) pixels are the object (chosen by the "
        "image)",
    )  # fmt: skip


def reading_of(args: argparse.Namespace, tolerance: bool = True) -> Reading:
    """The options as one value; ``tolerance`` False: that option means something else here.

    Raises
    ------
    InputError:
        A value that is not allowed.
    """
    from dataclasses import fields

    from icage.formats.drawings.reading import Reading

    values: dict[str, Any] = {
        field.name: getattr(args, field.name, None) for field in fields(Reading)
    }
    if not tolerance:
        values["tolerance"] = None
    if values["layers"] is not None:
        values["layers"] = tuple(values["layers"])
    return Reading(**values)


def reading_words(reading: Reading) -> list[str]:
    """The options again, as words of a command line.

    >>> from icage.formats.drawings.reading import Reading
    >>> reading_words(Reading(unit="mm", background=False, layers=("a", "b")))
    ['--unit', 'mm', '--no-background', '--layers', 'a', '--layers', 'b']
    """
    words: list[str] = []
    for name, value in reading.given().items():
        if name == "background":
            words += [] if value else ["--no-background"]
        elif name == "layers":
            words += [word for layer in value for word in ("--layers", layer)]
        else:
            words += [f"--{name}", f"{value!r}" if isinstance(value, float) else str(value)]
    return words


def say_notes(case: Case) -> None:
    """What a user must know about how the drawing was read, on standard error."""
    for note in case.notes:
        print(f"icage: warning: {case.name}: {note}", file=sys.stderr, flush=True)
