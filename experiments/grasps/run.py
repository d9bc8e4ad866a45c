"""One call of ``icage grasps`` for one object: checked, searched, written, listed."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import replace
from pathlib import Path

from experiments.cases.case_files import LISTED, check_case_files
from experiments.cases.chosen import SEARCHED, check_radius
from experiments.cases.reading import reading_of, say_notes
from experiments.io.options import check_output
from icage.case import Case
from icage.errors import InputError
from icage.formats.drawings.read import is_drawing
from icage.formats.json_out import write_json
from icage.formats.load import load_object, named


def list_grasps(args: Namespace) -> None:
    """Search, plan the winners, list them.

    Raises
    ------
    InputError:
        The object or an option is no use, or a file cannot be written.
    """
    args.top = args.top or SEARCHED
    case = _checked(args)
    from experiments.grasps.document import grasps_document  # only now: they load the planner
    from experiments.grasps.files import draw, write_cases
    from experiments.grasps.listing import print_list, tell
    from experiments.grasps.search import planned_grasps

    planned = planned_grasps(case, args)
    cages = planned.cages[: args.top]
    tell(planned, args)
    document = grasps_document(case, planned, args)
    if args.figure is not None:
        draw(cages, planned.scores, args)
    if args.cases is not None:
        write_cases(case, cages, args)
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        print_list(case, planned, args)
        if args.figure is not None:
            print(f"drawn in {args.figure}")
        if args.cases is not None and cages:
            print(f"cases in {args.cases}: 1.json to {len(cages)}.json")


def _checked(args: Namespace) -> Case:
    """The object, once everything that can be checked before the search was."""
    of_drawing = is_drawing(named(args.object).outline) and args.tolerance != 0.0
    case = load_object(args.object, **reading_of(args, tolerance=of_drawing).given())
    say_notes(case)
    check_output("--json", args.json, *case.sources)
    if args.finger_radius is not None:
        case = replace(case, finger_radius=args.finger_radius)
    check_radius(case)
    if args.cases is not None:
        names = [LISTED.format(k) for k in range(1, args.top + 1)]
        check_case_files("--cases", Path(args.cases), names, case.sources)
        if args.json not in (None, "-") and Path(args.json).resolve() in {
            (Path(args.cases) / name).resolve() for name in names
        }:
            raise InputError(f"--json {args.json!r} is the name of a case in --cases {args.cases}")
    if args.within is not None and args.phi is None:
        raise InputError("--within needs --phi")
    check_output("--figure", args.figure, *case.sources)
    if args.figure is not None and Path(args.figure).suffix.lower() != ".svg":
        raise InputError(f"--figure {args.figure!r}: a name ending in .svg is needed")
    return case
