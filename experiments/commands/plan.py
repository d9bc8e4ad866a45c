"""``icage plan CASE-or-DRAWING``: the cage of a target grasp."""

from __future__ import annotations

import argparse
import sys
from math import radians
from typing import TYPE_CHECKING, Any

from experiments.cases.asked import add_case, case_of
from experiments.io.options import (
    add_json,
    check_output,
    not_negative,
    not_negative_list,
    same,
)

if TYPE_CHECKING:
    from icage.cage import Cage
    from icage.case import Case
    from icage.friction.levels import JamTolerance

METHODS = ("cells", "contact-space", "both")


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "plan",
        help="how far the hand on a target grasp may open",
        description="Compute the cage of a target grasp: sigma_0, sigma_first, sigma_max, "
        "punctures, grasps, escape path and caging regions. A caging region is where one finger "
        "may be; the JSON has each from inside and from outside (`bound`). The inner one is on the "
        "safe side: draw that one, as --figure does.",
    )
    add_case(parser)
    add_json(parser)
    parser.add_argument("--figure", metavar="FILE", help="draw the cage into FILE (.svg or .png)")
    parser.add_argument(
        "--method",
        choices=METHODS,
        default="cells",
        help="cells (default, exact and fast); contact-space: the paper's I-CAGE; both: run both "
        "and exit with 1 if a level differs by more than 1e-7",
    )
    parser.add_argument(
        "--bracket",
        action="store_true",
        help="of a drawing: plan the grasp on an outline inside the drawing and on one around it, "
        "too; the drawing's own sigma_max lies between theirs",
    )
    parser.add_argument(
        "--no-tunnels",
        action="store_true",
        help="with --method contact-space: leave out the tunnel edges of Sec. V-B; unsafe, to show "
        "what they are for",
    )
    parser.add_argument(
        "--exact-fit",
        action="store_true",
        help="say, too, from which opening on the guarantee hangs on an exact fit, where there is "
        "one: fingers 1e-5 of the diameter thinner or thicker would end elsewhere",
    )
    parser.add_argument(
        "--friction",
        type=not_negative_list,
        metavar="MU[,MU...]",
        help="for these coefficients of friction, too: the level below which closing ends near the "
        "target",
    )
    parser.add_argument(
        "--friction-figure",
        metavar="FILE",
        help="with --friction: draw the jams that limit these levels, and the level over the "
        "coefficient, into FILE (.svg or .png)",
    )
    parser.add_argument(
        "--within-position",
        type=not_negative,
        metavar="SHARE",
        help="with --friction: near is so many diameters (0.005)",
    )
    parser.add_argument(
        "--within-angle-deg",
        type=not_negative,
        metavar="ANGLE",
        help="with --friction: and so many degrees (1.146, which is 0.02 rad)",
    )


def _tolerance(args: argparse.Namespace) -> JamTolerance | None:
    """What counts as near the target, if friction is asked for."""
    from icage.errors import InputError

    within = (args.within_position, args.within_angle_deg)
    if args.friction is None:
        if within != (None, None):
            raise InputError("--within-position and --within-angle-deg go with --friction only")
        if args.friction_figure is not None:
            raise InputError("--friction-figure goes with --friction only")
        return None
    from icage.friction.levels import JamTolerance

    usual = JamTolerance()
    return JamTolerance(
        usual.position if within[0] is None else within[0],
        usual.angle if within[1] is None else radians(within[1]),
    )


def _friction(
    cage: Cage, args: argparse.Namespace, tolerance: JamTolerance | None
) -> tuple[dict[str, Any], list[str]]:
    """Keys and lines about friction; none if it was not asked for."""
    if tolerance is None:
        return {}, []
    from icage.formats.friction_json import friction_document, friction_summary
    from icage.friction.levels import friction_levels

    found = friction_levels(cage, args.friction, tolerance)
    return friction_document(found, tolerance), list(friction_summary(cage, found, tolerance))


def _check_figures(args: argparse.Namespace, case: Case) -> None:
    """Pictures have names of their own, of a kind that is drawn."""
    from pathlib import Path

    from icage.errors import InputError

    named = [("--figure", args.figure), ("--friction-figure", args.friction_figure)]
    given = [(option, name) for option, name in named if name is not None]
    for option, name in given:
        check_output(option, name, *case.sources)
        if Path(name).suffix.lower() not in (".svg", ".png"):
            raise InputError(f"{option} {name!r}: a name ending in .svg or .png is needed")
    if args.json not in (None, "-"):
        given.insert(0, ("--json", args.json))
    for k, (option, name) in enumerate(given):
        for other, again in given[k + 1 :]:
            if same(name, again):
                raise InputError(f"{option} and {other} both name {name!r}")


def _draw_friction(
    cage: Cage, args: argparse.Namespace, tolerance: JamTolerance | None, case: Case
) -> None:
    from pathlib import Path

    from experiments.figures.friction import draw_friction
    from icage.friction.curve import friction_curve
    from icage.friction.levels import friction_levels

    curve = friction_curve(cage, max(1.0, *args.friction), tolerance)
    levels = friction_levels(cage, args.friction, tolerance)
    path = Path(args.friction_figure)
    draw_friction(cage, levels, curve, case.name, case.unit, path)


def run(args: argparse.Namespace) -> int:
    """Plan, then write what was asked for."""
    from pathlib import Path

    from icage.bracket import bracket
    from icage.errors import InputError
    from icage.formats.bracket_json import bracket_document, bracket_summary
    from icage.formats.json_out import json_text, write_json
    from icage.formats.plan_json import plan_document, plan_summary

    case = case_of(args)
    check_output("--json", args.json, *case.sources)
    _check_figures(args, case)
    if args.no_tunnels and args.method != "contact-space":
        raise InputError("--no-tunnels goes with --method contact-space only")
    if args.bracket and case.reading is None:
        raise InputError(f"--bracket is for drawings; the outline of {case.name} is exact")
    tolerance = _tolerance(args)
    from experiments.cases.by_methods import planned
    from experiments.cases.chosen import chosen, say_how_to_keep

    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases

    answer = planned(case, args.method, tunnels=not args.no_tunnels)
    for line in answer.disagreements:
        print(f"icage: the methods disagree: {line}", file=sys.stderr)
    if args.friction_figure is not None and answer.cells.status == "not_a_cage":
        raise InputError(f"--friction-figure: {case.name} is not a cage ({answer.cells.why})")
    bounds = bracket(case) if args.bracket else None
    friction, friction_lines = _friction(answer.cells, args, tolerance)
    document: dict[str, Any] = {}
    if args.json is not None:
        document = plan_document(
            answer.cage, answer.regions(), case.name, case.unit, exact_fit=args.exact_fit
        )
        if bounds is not None:
            document["bracket"] = bracket_document(bounds)
        document.update(friction)
        json_text(document)  # a number that cannot be written fails before any file appears
    if args.figure is not None:
        from experiments.figures.plan import draw_plan, figure_regions

        regions = figure_regions(answer.cells)
        draw_plan(answer.cells, regions, case.name, case.unit, Path(args.figure))
    if args.friction_figure is not None:
        _draw_friction(answer.cells, args, tolerance, case)
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        print("\n".join(plan_summary(answer.cage, case.name, case.unit, exact_fit=args.exact_fit)))
        if bounds is not None:
            print("\n".join(bracket_summary(bounds, case.unit)))
        for line in friction_lines:
            print(line)
        if args.method == "both" and not answer.disagreements:
            print("methods      cells and contact space agree to 1e-7")
    return 1 if answer.disagreements else 0
