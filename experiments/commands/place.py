"""``icage place CASE-or-DRAWING``: where to put the open hand, and how far it may be off."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of
from experiments.io.options import add_json, check_output, one_coefficient, positive, same


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "place",
        help="where to put the open hand so that it may be off by most",
        description="Find the placement of the open hand from which closing ends in the target "
        "and whose fingers may each be off by most: by less than the tolerance they meet nothing "
        "and closing still ends there. Without an option the hand chooses how far it opens and "
        "keeps that size.",
    )
    add_case(parser)
    parser.add_argument(
        "--friction",
        type=one_coefficient,
        default=0.0,
        metavar="MU",
        help="of the fingers, up to MU (0): the level is then the one that `icage plan "
        "--friction MU` gives",
    )
    parser.add_argument(
        "--opening",
        type=positive,
        metavar="S",
        help="the size sigma of the open hand, in the object's unit",
    )
    parser.add_argument(
        "--opening-error",
        action="store_true",
        help="the opening may be off as the fingers are: it keeps away from the level (with "
        "--opening: S is meant, and missed)",
    )
    add_json(parser)
    parser.add_argument(
        "--figure", metavar="FILE", help="draw the placement into FILE (.svg or .png)"
    )


def run(args: argparse.Namespace) -> int:
    """Plan, place, write what was asked for."""
    from pathlib import Path

    from icage.errors import InputError
    from icage.formats.json_out import json_text, write_json
    from icage.formats.place_json import place_document, place_summary

    case = case_of(args)
    check_output("--json", args.json, *case.sources)
    check_output("--figure", args.figure, *case.sources)
    if args.figure is not None and Path(args.figure).suffix.lower() not in (".svg", ".png"):
        raise InputError(f"--figure {args.figure!r}: a name ending in .svg or .png is needed")
    if args.figure is not None and args.json not in (None, "-") and same(args.json, args.figure):
        raise InputError(f"--json and --figure both name {args.json!r}")
    from experiments.cases.chosen import chosen, say_how_to_keep
    from icage.placing.best import place
    from icage.planner import plan

    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    cage = plan(case)
    best = place(cage, args.friction, args.opening, args.opening_error)
    document = place_document(best)
    json_text(document)  # a number that cannot be written fails before any file appears
    if args.figure is not None:
        from experiments.figures.placement import draw_placement

        draw_placement(cage, best, case.name, case.unit, Path(args.figure))
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        print("\n".join(place_summary(best, case.name, case.unit)))
    return 0
