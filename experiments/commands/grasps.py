"""``icage grasps OUTLINE-OR-CASE``: good target grasps of an object, or all of one hand; or those
of every object of a folder, as a table.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from experiments.cases.asked import add_size
from experiments.io.options import (
    add_json,
    check_output,
    count,
    file_name,
    not_negative,
    number,
    positive,
)
from experiments.io.options import seed as seed_option

if TYPE_CHECKING:
    from icage.cage import Cage
    from icage.case import Case
    from icage.grasps.planned import PlannedGrasps
    from icage.grasps.wanted import Aim, Wanted

PHI_SKETCH = """\
the hand's angles, P1 = phi_1 and P2 = phi_2, in degrees:

               3
              / \\
             /   \\
            /     \\
           / phi_1 \\ phi_2
          1---------2 - - - ->

phi_1 is the direction from finger 1 to finger 3, phi_2 the direction from
finger 2 to finger 3, both against the direction from finger 1 to finger 2.
So phi_2 is measured outside the triangle: an equilateral hand is (60, 120),
not (60, 60). Allowed is 0 < phi_1 < phi_2 < 180."""


def stretch_ends(text: str) -> tuple[float, float]:
    """``FROM:TO``, two arclengths."""
    start, colon, end = text.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError(f"{text!r} is not FROM:TO, two arclengths")
    return not_negative(start), not_negative(end)


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "grasps",
        help="the best target grasps of an object, or of every object of a folder",
        description="Search the three-finger immobilizing grasps of an object for those with the "
        "largest\ncages, or list all immobilizing grasps of one given hand (--phi). Of a folder: "
        "the best grasps\nof every drawing (*.svg) and case file (*.json) in it, as a table.",
        epilog=PHI_SKETCH,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "object",
        metavar="OUTLINE-OR-CASE",
        type=file_name,
        help="drawing, case file, or a shipped object's name; or a folder of them, with --out",
    )
    parser.add_argument(
        "--finger-radius",
        type=not_negative,
        metavar="R",
        help="radius of the disc "
        "fingers, in the object's unit (the case's own, else 0: point fingers)",
    )
    add_size(parser)
    parser.add_argument(
        "--phi",
        type=number,
        nargs=2,
        metavar=("P1", "P2"),
        help="list the grasps of one given hand: "
        "phi_1 and phi_2 in degrees, as in the sketch below",
    )
    parser.add_argument(
        "--top", type=count, metavar="K", help="how many to list (10; of each object of a folder 1)"
    )
    parser.add_argument(
        "--aim",
        choices=("first", "cage"),
        default="first",
        help="rank by sigma_first / sigma_0 (first) or by sigma_max / sigma_0 (cage)",
    )
    parser.add_argument(
        "--within",
        type=positive,
        metavar="DEG",
        help="with --phi: search the hands whose two angles are within DEG of those given, "
        "whichever finger is called the first",
    )
    parser.add_argument(
        "--corners",
        type=int,
        choices=range(4),
        default=0,
        help="least number of fingers in concave corners (0)",
    )
    hand = parser.add_argument_group(
        "limits of the hand",
        "Sigma is measured between the two fingers that are furthest apart; with --phi, between "
        "fingers 1 and 2.",
    )
    hand.add_argument(
        "--least-angle",
        type=not_negative,
        metavar="DEG",
        help="least angle of the hand's triangle, in degrees (15; with --phi 0)",
    )
    hand.add_argument(
        "--least-gap",
        type=not_negative,
        metavar="G",
        help="least free gap between two fingers on the object, in its unit (2 %% of its diameter)",
    )
    hand.add_argument(
        "--sigma-min-of-hand",
        type=not_negative,
        metavar="S",
        help="how far the hand can close, in the object's unit (0)",
    )
    hand.add_argument(
        "--sigma-max-of-hand",
        type=positive,
        metavar="S",
        help="how far it can open: the grasp needs less, and cages count up to there (no limit)",
    )
    hand.add_argument(
        "--avoid",
        type=stretch_ends,
        action="append",
        default=[],
        metavar="FROM:TO",
        help="a stretch of the outline that no finger of the grasp may touch, by arclength in its "
        "unit, counterclockwise from the first vertex that `icage outline` lists; may be given "
        "several times",
    )
    hand.add_argument(
        "--tolerance",
        type=not_negative,
        metavar="T",
        help="how wrong the drawing may be, in its unit: smaller or shallower grasps are left out "
        "(0)",
    )
    parser.add_argument(
        "--seconds",
        type=positive,
        metavar="S",
        help="stop the search (of a folder: each) after S seconds with what there is (Ctrl-C does "
        "so too); what it has by then is not the same every time",
    )
    parser.add_argument(
        "--figure", metavar="FILE", type=file_name, help="draw all grasps listed into FILE (.svg)"
    )
    parser.add_argument(
        "--seed",
        type=seed_option,
        default=0,
        metavar="S",
        help="seed of the search's random moves (0)",
    )
    parser.add_argument(
        "--cases",
        metavar="DIR",
        type=file_name,
        help="write each grasp listed as a case file: DIR/1.json, DIR/2.json, ...",
    )
    add_json(parser)
    many = parser.add_argument_group(
        "many objects",
        "The same command goes on after anything, kill -9 too: what is done is kept in a hidden "
        "folder beside FILE. Lengths are in each object's own unit, --width and --unit for its "
        "drawings only. Each object has a seed of its own, from --seed and its name.",
    )
    many.add_argument(
        "--out", metavar="FILE", type=file_name,
        help="the table of a folder (.parquet): a row a grasp, or one that says why there is none",
    )  # fmt: skip
    many.add_argument(
        "--workers", metavar="N", type=count,
        help="processes for a folder (one per core), threads for one object (2); no "
        "number changes the result",
    )  # fmt: skip
    many.add_argument(
        "--scheduler", metavar="ADDRESS", type=file_name,
        help="search the folder on the dask.distributed cluster at tcp://HOST:PORT",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Search, plan the winners, list them."""
    from dataclasses import replace
    from pathlib import Path

    from experiments.cases.case_files import LISTED, check_case_files
    from experiments.cases.chosen import check_radius
    from icage.errors import InputError
    from icage.formats.json_out import write_json
    from icage.formats.load import load_object

    if _is_folder(args):
        return _of_folder(args)
    args.top = args.top or _LISTED
    case = load_object(args.object, width=args.width, unit=args.unit)
    check_output("--json", args.json, *case.sources)
    if args.finger_radius is not None:
        case = replace(case, finger_radius=args.finger_radius)
    radius = case.finger_radius
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
    from icage.kernels.compiled import long_job

    long_job()
    if args.phi is not None and args.within is None:
        _refuse_limits(args)
        planned = _of_one_hand(case, radius, args.phi, args.aim)
    else:
        planned = _best(case, args)
    cages = planned.cages[: args.top]
    _tell(planned, args)
    document = {
        "format": "icage-grasps/1",
        "name": case.name,
        "unit": case.unit,
        "outline": {"vertices": case.outline.vertices},
        "finger_radius": radius,
        "aim": args.aim,
        "grasps": [
            {**_entry(cage, args.aim), "alike": alike}
            for cage, alike in zip(cages, planned.alike, strict=False)
        ],
        "failed": [{"contacts": f.contacts, "why": f.why} for f in planned.failures],
        "triples_left_out": planned.triples_left_out,
        "searches_broken_off": planned.searches_broken_off,
        "ended": planned.ended,
    }
    if args.figure is not None:
        _draw(cages, args)
    if args.cases is not None:
        _write_cases(case, cages, args)
    if args.json is not None:
        write_json(document, args.json)
    if args.json != "-":
        _print(case, planned, args)
        if args.figure is not None:
            print(f"drawn in {args.figure}")
        if args.cases is not None and cages:
            print(f"cases in {args.cases}: 1.json to {len(cages)}.json")
    return 0


_WRITTEN = (
    ("within", None), ("aim", "first"), ("corners", 0), ("seed", 0), ("least-angle", None),
    ("least-gap", None), ("sigma-min-of-hand", None), ("sigma-max-of-hand", None),
    ("tolerance", None),
)  # fmt: skip
"""Options and their defaults that say again which grasps were found."""

_LIMITS = (
    "least_angle", "least_gap", "sigma_min_of_hand", "sigma_max_of_hand", "tolerance", "seconds",
)  # fmt: skip


_LISTED = 10

_OF_ONE = ("figure", "cases", "json")
_OF_MANY = ("out", "scheduler")


def _is_folder(args: argparse.Namespace) -> bool:
    """Whether a folder of objects is meant, with the options for one; a shipped name is no folder.

    Raises
    ------
    InputError:
        An option is for the other.
    """
    from pathlib import Path

    from icage.errors import InputError
    from icage.formats.load import is_shipped

    shipped = is_shipped(args.object)
    try:
        folder = Path(args.object).is_dir() and not shipped
    except OSError:  # a name that no file can have: the error comes from whoever reads it
        folder = False
    if folder:
        for name in _OF_ONE:
            if getattr(args, name) is not None:
                raise InputError(f"--{name} is for one object; {args.object!r} is a folder")
        if args.phi is not None and args.within is None:
            raise InputError("--phi without --within lists the grasps of one object, not a folder")
        if args.out is None:
            raise InputError(f"{args.object!r} is a folder: --out FILE.parquet is needed")
        return True
    for name in _OF_MANY:
        if getattr(args, name) is not None:
            what = f"the shipped object, ./{args.object} a folder" if shipped else "no folder"
            hint = " (--json FILE writes the grasps of one object)" if name == "out" else ""
            raise InputError(f"--{name} is for a folder; {args.object!r} is {what}{hint}")
    return False


def _of_folder(args: argparse.Namespace) -> int:
    from pathlib import Path

    from experiments.collection.options import SearchOptions
    from experiments.collection.run import search_folder

    options = SearchOptions(
        wanted_of(args), args.top or 1, args.seed, args.finger_radius, args.width, args.unit,
        args.seconds,
    )  # fmt: skip
    lines = search_folder(Path(args.object), args.out, options, args.workers, args.scheduler)
    print("\n".join(lines))
    return 0


def _refuse_limits(args: argparse.Namespace) -> None:
    """All grasps of one hand are listed: limits would be asked of nothing."""
    from icage.errors import InputError

    given = [name for name in _LIMITS if getattr(args, name) is not None]
    if args.avoid:
        given.append("avoid")
    if given:
        option = given[0].replace("_", "-")
        raise InputError(
            f"--{option} limits a search, and --phi without --within lists all grasps of one hand; "
            "leave one of them out"
        )


def _draw(cages: Sequence[Cage], args: argparse.Namespace) -> None:
    from pathlib import Path

    from icage.formats.contact_sheet import contact_sheet
    from icage.formats.whole_files import whole_file
    from icage.grasps.planned import score

    captions = [
        f"{k}: score {score(cage, args.aim):.4f}, phi {cage.hand.phi_deg[0]:.1f}, "
        f"{cage.hand.phi_deg[1]:.1f}"
        for k, cage in enumerate(cages, 1)
    ]
    with whole_file(Path(args.figure)) as part:
        part.write_text(contact_sheet(cages, captions), encoding="utf-8")


def _write_cases(case: Case, cages: tuple[Cage, ...], args: argparse.Namespace) -> None:
    """All of them, or none."""
    import shlex
    from pathlib import Path

    from experiments.cases.case_files import LISTED, earlier_case_files, write_case_files
    from experiments.cases.chosen import Chosen, cases_from, search_command
    from experiments.io.whole_folder import whole_folder

    command = search_command(case, args, args.object)
    if args.phi is not None:
        command += f" --phi {args.phi[0]!r} {args.phi[1]!r}"
    for option, default in _WRITTEN:
        if (value := getattr(args, option.replace("-", "_"))) != default:
            command += f" --{option} {shlex.quote(str(value))}"
    for ends in args.avoid:
        command += " --avoid {!r}:{!r}".format(*ends)
    folder = Path(args.cases)
    found = Chosen(cases_from(case, cages), command)
    names = {LISTED.format(k) for k in range(1, len(cages) + 1)}
    earlier = earlier_case_files(folder, LISTED, case.sources)
    with whole_folder(folder, sorted({*names, *earlier})) as staging:
        write_case_files(found, staging, LISTED)


def _best(case: Case, args: argparse.Namespace) -> PlannedGrasps:
    """The best grasps of any hand."""
    import os

    import numpy as np

    from experiments.cases.chosen import WORKERS
    from experiments.io.progress import search_bar
    from icage.grasps.of_case import best_of_case

    wanted, rng = wanted_of(args), np.random.default_rng(args.seed)
    workers = args.workers or min(WORKERS, os.cpu_count() or 1)
    with search_bar() as progress:
        return best_of_case(case, args.top, wanted, rng, workers, progress, args.seconds)


def wanted_of(args: argparse.Namespace) -> Wanted:
    """What the options ask for."""
    from math import inf, radians

    from icage.grasps.wanted import LEAST_ANGLE, HandLimits, Wanted, as_stretches
    from icage.hand import HandShape

    near = None
    if args.phi is not None:
        HandShape.from_angles_deg(*args.phi)  # says what is wrong with the angles
        near = (radians(args.phi[0]), radians(args.phi[1]), radians(args.within))
    limits = HandLimits(
        least_angle=LEAST_ANGLE if args.least_angle is None else radians(args.least_angle),
        least_gap=args.least_gap,
        sigma_least=args.sigma_min_of_hand or 0.0,
        sigma_most=inf if args.sigma_max_of_hand is None else args.sigma_max_of_hand,
    )
    return Wanted(
        args.aim, args.corners, near, limits, as_stretches(args.avoid), args.tolerance or 0.0
    )


def _of_one_hand(case: Case, radius: float, phi: list[float], aim: Aim) -> PlannedGrasps:
    from icage.discs.offsets import offsets
    from icage.grasps.of_one_hand import grasps_of_hand
    from icage.grasps.planned import planned_grasps_of_hand
    from icage.hand import HandShape

    hand = HandShape.from_angles_deg(phi[0], phi[1])
    grown = offsets(case.outline, radius, 8).inner if radius > 0.0 else case.outline
    found = grasps_of_hand(grown, hand)
    return planned_grasps_of_hand(case.outline, radius, hand, found, aim)


def _tell(planned: PlannedGrasps, args: argparse.Namespace) -> None:
    """What was not looked at or came to nothing, on standard error."""
    import sys

    lines: list[str] = []
    if planned.ended is not None:
        after = f" after {args.seconds:g} s" if planned.ended == "out of time" else ""
        lines.append(f"the search was {planned.ended}{after}: the best of what it had")
    if planned.triples_left_out:
        lines.append(f"{planned.triples_left_out} triples of contacts were not drawn, at random")
    if planned.searches_broken_off:
        lines.append(f"{planned.searches_broken_off} searches were too large and broken off")
    if planned.failures:
        reasons = "; ".join(f"{count} {why}" for why, count in planned.reasons())
        lines.append(
            f"candidates that are no grasps of these fingers: {len(planned.failures)} ({reasons})"
        )
    for line in lines:
        print(f"icage: {line}", file=sys.stderr)


def _entry(cage: Cage, aim: Aim) -> dict[str, Any]:
    from experiments.cases.free_gap import free_gap
    from icage.grasps.planned import score

    return {
        "contacts": cage.contacts,
        "phi_deg": cage.hand.phi_deg,
        "sigma_0": cage.sigma_0,
        "sigma_first": cage.sigma_first,
        "sigma_max": cage.sigma_max,
        "score": score(cage, aim),
        "free_gap": free_gap(cage),
        "verdict": cage.status,
        "free_fingers": cage.grasps[0].free_fingers,
        "escape_free_fingers": cage.punctures[-1].free_fingers if cage.sigma_max else None,
    }


def _print(case: Case, planned: PlannedGrasps, args: argparse.Namespace) -> None:
    from experiments.cases.asked import size_words
    from experiments.cases.free_gap import free_gap
    from icage.grasps.planned import score

    aim, radius = args.aim, case.finger_radius
    cages = planned.cages[: args.top]
    print(
        f"{case.name}: {len(case.outline)} vertices, {_fingers(radius, case.unit)}, "
        f"{len(cages)} grasps, ranked by sigma_{'max' if aim == 'cage' else 'first'} / sigma_0"
    )
    print(f"size {size_words(case)}")
    if args.phi is None or args.within is not None:
        print(f"hands {_limit_words(case, args)}")
    print(
        f"{'score':>8} {'first/0':>8} {'max/0':>8} {'sigma_0':>10} {'free gap':>9} {'alike':>5}  "
        f"{'phi [deg]':<17} contacts"
    )
    for cage, alike in zip(cages, planned.alike, strict=False):
        first = _ratio(cage.sigma_first, cage.sigma_0)
        top = _ratio(cage.sigma_max, cage.sigma_0)
        phi = "({:.2f}, {:.2f})".format(*cage.hand.phi_deg)
        points = "  ".join(f"({x:.6g}, {y:.6g})" for x, y in cage.contacts)
        print(
            f"{score(cage, aim):8.4f} {first:>8} {top:>8} {cage.sigma_0:10.6g} "
            f"{free_gap(cage):9.4g} {alike:5d}  {phi:<17} {points}"
        )


def _limit_words(case: Case, args: argparse.Namespace) -> str:
    """Which hands were looked at, and how to ask for others."""
    from math import degrees

    from icage.grasps.wanted import LEAST_ANGLE, LEAST_GAP

    unit = f" {case.unit}"
    gap = LEAST_GAP * case.outline.diameter if args.least_gap is None else args.least_gap
    words = [f"with a free gap of {gap:.4g}{unit} and more between fingers (--least-gap)"]
    if args.phi is None:
        angle = degrees(LEAST_ANGLE) if args.least_angle is None else args.least_angle
        words.insert(0, f"with angles of {angle:g} degrees and more (--least-angle)")
    if args.sigma_min_of_hand is not None:
        words.append(f"that close to {args.sigma_min_of_hand:g}{unit}")
    if args.sigma_max_of_hand is not None:
        words.append(f"that open to {args.sigma_max_of_hand:g}{unit}")
    if args.avoid:
        plural = "es" if len(args.avoid) > 1 else ""
        words.append(f"that touch nothing on {len(args.avoid)} stretch{plural} of the outline")
    return ", ".join(words)


def _fingers(radius: float, unit: str) -> str:
    return f"disc fingers of radius {radius:g} {unit}" if radius > 0.0 else "point fingers"


def _ratio(level: float | None, sigma_0: float) -> str:
    return "never" if level is None else f"{level / sigma_0:.4f}"
