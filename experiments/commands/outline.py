"""``icage outline DRAWING``: the polygon of a drawing, as a case file that awaits its grasp."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from experiments.cases.reading import DRAWINGS_HELP, add_reading
from experiments.io.options import add_json, check_output, file_name

if TYPE_CHECKING:
    from icage.formats.drawings.trace import Traced


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "outline",
        help="the polygon of a drawing",
        description=f"Turn a drawing ({DRAWINGS_HELP}) into a polygon with a stated tolerance, and "
        "say how far it is from the drawing; add a grasp to the JSON and it is a case file.",
    )
    parser.add_argument("drawing", metavar="DRAWING", type=file_name, help=DRAWINGS_HELP)
    add_reading(parser)
    parser.add_argument(
        "--figure", metavar="FILE.svg", type=file_name, help="draw the outline over the drawing"
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Read the drawing and write its vertices."""
    import shlex
    from pathlib import Path

    from experiments.cases.asked import size_words
    from experiments.cases.reading import reading_of, reading_words, say_notes
    from experiments.io.options import same
    from icage.errors import InputError
    from icage.formats.case_json import FORMAT
    from icage.formats.drawings.read import trace_file
    from icage.formats.json_out import write_json
    from icage.formats.load import case_of
    from icage.formats.picture import outline_picture
    from icage.formats.whole_files import whole_file

    path = Path(args.drawing)
    check_output("--json", args.json, path)
    check_output("--figure", args.figure, path)
    if args.figure is not None and Path(args.figure).suffix.lower() != ".svg":
        raise InputError(f"--figure {args.figure!r}: a name ending in .svg is needed")
    if args.figure is not None and args.json not in (None, "-") and same(args.json, args.figure):
        raise InputError(f"--json and --figure both name {args.json!r}")
    reading = reading_of(args)
    traced = trace_file(path, reading)
    case = case_of(path, reading, traced)
    say_notes(case)
    command = ["icage", "outline", path.name, *reading_words(reading)]
    if reading.unit is None:
        command += ["--unit", case.unit]
    document = {
        "format": FORMAT,
        "name": case.name,
        "unit": case.unit,
        "outline": {"vertices": case.outline.vertices},
        "source": source_document(traced),
        "made_by": shlex.join(command),
    }
    if args.figure is not None:
        with whole_file(Path(args.figure)) as drawn:
            drawn.write_text(outline_picture(traced.outline, traced.source), encoding="utf-8")
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        outline = case.outline
        unit = case.unit
        print(
            f"{case.name}: {len(outline)} vertices, area {outline.area:.6g} {unit}^2, "
            f"diameter {outline.diameter:.6g} {unit}\n"
            f"size {size_words(case)}\n"
            f"symmetric difference to the drawing {traced.symmetric_difference:.3g} {unit}^2 "
            f"({100.0 * traced.symmetric_difference / traced.source.area:.2g} %), "
            f"boundaries at most {traced.distance:.3g} {unit} apart"
            + (f", {args.safe} the drawing" if args.safe else "")
        )
    return 0


def source_document(traced: Traced) -> dict[str, Any]:
    """What the outline was made from, and how near it is."""
    return {
        "size_from": traced.size_from,
        "tolerance": traced.tolerance,
        "area": traced.source.area,
        "symmetric_difference": traced.symmetric_difference,
        "distance": traced.distance,
        "notes": list(traced.notes),
    }
