"""``icage outline DRAWING``: the polygon of a drawing, as a case file that awaits its grasp."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.io.options import UNITS, add_json, check_output, file_name, positive


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "outline",
        help="the polygon of an SVG drawing",
        description="Turn an SVG drawing into a polygon with a stated tolerance; add a grasp to "
        "the JSON and it is a case file.",
    )
    parser.add_argument("drawing", metavar="DRAWING", type=file_name, help="SVG file")
    parser.add_argument(
        "--width",
        type=positive,
        help="longer side of the bounding box, in UNIT (the size the drawing states, if any)",
        metavar="W",
    )
    parser.add_argument(
        "--tolerance",
        type=positive,
        help="largest distance between drawing and polygon, in UNIT (0.1 %% of the width)",
        metavar="T",
    )
    parser.add_argument(
        "--unit",
        choices=UNITS,
        help="unit of W, T and the answer (the one in which the drawing states its size; m if it "
        "states none)",
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Read the drawing and write its vertices."""
    from pathlib import Path

    from experiments.cases.asked import size_words
    from icage.formats.case_json import FORMAT
    from icage.formats.drawings.reading import Reading
    from icage.formats.json_out import write_json
    from icage.formats.load import read_drawing

    path = Path(args.drawing)
    check_output("--json", args.json, path)
    reading = Reading(width=args.width, unit=args.unit, tolerance=args.tolerance)
    case = read_drawing(path, reading)
    outline = case.outline
    command = f"icage outline {path.name} --unit {case.unit}"
    for option in ("width", "tolerance"):
        if getattr(args, option) is not None:
            command += f" --{option} {getattr(args, option):g}"
    document = {
        "format": FORMAT,
        "name": path.stem,
        "unit": case.unit,
        "outline": {"vertices": outline.vertices},
        "made_by": command,
    }
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        print(
            f"{path.stem}: {len(outline)} vertices, diameter {outline.diameter:.6g} {case.unit}\n"
            f"size {size_words(case)}"
        )
    return 0
