"""``icage query CASE PLACEMENTS``: is the object caged by a hand that stands there?"""

from __future__ import annotations

import argparse
from typing import Any

from experiments.io.options import add_json, check_output, file_name


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "query",
        help="whether placements of the hand cage the object",
        description="Ask of every placement whether closing from there can end only in the "
        "target, holds the object at all, or lets it escape; and by how much the hand may open "
        "before that changes (`margin` and `target_margin` of the JSON: openings, in sigma, and no "
        "room for the hand to stand elsewhere).",
    )
    parser.add_argument(
        "case", metavar="CASE", type=file_name, help="case file, or a shipped object's name"
    )
    parser.add_argument(
        "placements",
        metavar="PLACEMENTS",
        type=file_name,
        help="CSV with the header x,y,theta,sigma: finger 1 at (x, y), finger 2 at distance sigma "
        "in direction theta (radians); - for standard input",
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Plan, ask, write the answers in the order of the rows."""
    import sys
    from pathlib import Path

    from experiments.cases.named import find_case
    from icage.errors import InputError
    from icage.formats.json_out import write_json
    from icage.formats.placements_csv import read_placements, read_placements_stream

    case = find_case(args.case)
    check_output("--json", args.json, *case.sources, Path(args.placements))
    if args.placements == "-":
        if sys.stdin is None:
            raise InputError("standard input is closed; placements are needed there")
        placements = read_placements_stream(sys.stdin.buffer)
    else:
        placements = read_placements(Path(args.placements))

    from icage.cells.membership import query  # only now: it takes a second to load
    from icage.formats.query_json import query_document, query_summary
    from icage.planner import plan

    cage = plan(case.outline, case.contacts, case.finger_radius)
    answers = query(cage, placements)
    if args.json is not None:
        write_json(query_document(answers), args.json)
    if args.json != "-":
        print("\n".join(query_summary(answers, case.unit)))
    return 0
