"""``icage plan CASE``: the cage of a target grasp."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.options import add_json, check_output


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "plan",
        help="how far the hand on a target grasp may open",
        description="Compute the cage of a target grasp: sigma_0, sigma_first, sigma_max, "
        "punctures, grasps, escape path and caging regions.",
    )
    parser.add_argument("case", metavar="CASE", help="case file, or a shipped object's name")
    add_json(parser)
    parser.add_argument("--figure", metavar="FILE", help="draw the cage into FILE (.svg or .png)")


def run(args: argparse.Namespace) -> int:
    """Plan, then write what was asked for."""
    from pathlib import Path

    from experiments.inputs import case_file
    from experiments.json_out import json_text, write_json
    from experiments.plan_json import plan_document, plan_summary
    from icage.errors import InputError
    from icage.formats.case_json import read_case

    path = case_file(args.case)
    check_output("--json", args.json, path)
    check_output("--figure", args.figure, path)
    if args.figure is not None and Path(args.figure).suffix.lower() not in (".svg", ".png"):
        raise InputError(f"--figure {args.figure!r}: a name ending in .svg or .png is needed")
    if args.figure is not None and args.json is not None and args.json == args.figure:
        raise InputError(f"--json and --figure both name {args.json!r}")
    case = read_case(path)

    from icage.planner import plan  # only now: it takes a second to load
    from icage.regions import caging_regions

    cage = plan(case.outline, case.contacts, case.finger_radius)
    document: dict[str, Any] = {}
    if args.json is not None:
        regions = caging_regions(cage) if cage.verdict != "not_a_cage" else ()
        document = plan_document(cage, regions, case.name, case.unit)
        json_text(document)  # a number that cannot be written fails before any file appears
    if args.figure is not None:
        from experiments.figures import draw_plan, figure_regions

        draw_plan(cage, figure_regions(cage), case.name, case.unit, Path(args.figure))
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        print("\n".join(plan_summary(cage, case.name, case.unit)))
    return 0
