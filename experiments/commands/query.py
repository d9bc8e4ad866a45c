"""``icage query CASE-or-DRAWING PLACEMENTS``: is the object caged by a hand that stands there?"""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of
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
    add_case(parser)
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

    from icage.errors import InputError
    from icage.formats.json_out import write_json
    from icage.formats.placements_csv import read_placements, read_placements_stream

    case = case_of(args)
    check_output("--json", args.json, *case.sources, Path(args.placements))
    if args.placements == "-":
        if sys.stdin is None:
            raise InputError("standard input is closed; placements are needed there")
        placements = read_placements_stream(sys.stdin.buffer)
    else:
        placements = read_placements(Path(args.placements))

    from experiments.cases.chosen import chosen, say_how_to_keep
    from icage.cells.membership import query  # only now: it takes a second to load
    from icage.formats.query_json import query_document, query_summary
    from icage.planner import plan

    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    cage = plan(case.outline, case.contacts, case.finger_radius)
    answers = query(cage, placements)
    if args.json is not None:
        write_json(query_document(answers), args.json)
    if args.json != "-":
        print("\n".join(query_summary(answers, case.unit)))
    return 0
