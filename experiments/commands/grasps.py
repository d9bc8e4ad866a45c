"""``icage grasps OUTLINE-OR-CASE``: good target grasps of an object, or all of one hand; or those
of many objects, files and folders, as a table.
"""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.reading import add_reading
from experiments.io.options import (
    add_any_code,
    add_json,
    count,
    file_name,
    not_negative,
    number,
    positive,
)
from experiments.io.options import seed as seed_option

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
        help="the best target grasps of an object, or of many: files and folders",
        description="Search the three-finger immobilizing grasps of an object for those with the "
        "largest\ncages, or list all immobilizing grasps of one given hand (--phi). With --out: "
        "the best grasps\nof many drawings and case files (*.json), given one by one or by "
        "their folders, as a table.",
        epilog=PHI_SKETCH,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "object",
        metavar="OUTLINE-OR-CASE",
        type=file_name,
        nargs="+",
        help="drawing, case file, or a shipped object's name; with --out any number of drawings, "
        "case files and folders of them, one after another",
    )
    parser.add_argument(
        "--finger-radius",
        type=not_negative,
        metavar="R",
        help="radius of the disc "
        "fingers, in the object's unit (the case's own, else 0: point fingers)",
    )
    add_reading(parser, tolerance=False)
    parser.add_argument(
        "--phi",
        type=number,
        nargs=2,
        metavar=("P1", "P2"),
        help="list the grasps of one given hand: "
        "phi_1 and phi_2 in degrees, as in the sketch below",
    )
    parser.add_argument(
        "--top", type=count, metavar="K", help="how many to list (10; with --out 1 of each object)"
    )
    parser.add_argument(
        "--aim",
        choices=("first", "cage", "friction", "place"),
        default="first",
        help="rank by sigma_first / sigma_0 (first), by sigma_max / sigma_0 (cage), or by what "
        "friction at the fingers leaves of the first (friction, with --mu), or by how far the "
        "fingers may be off where the open hand stands best, over sigma_0 (place)",
    )
    parser.add_argument(
        "--mu",
        type=positive,
        metavar="M",
        help="with --aim friction: coefficient of friction at the fingers",
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
        help="how wrong the drawing may be, in its unit: it is read within T (0.1 %% of the "
        "width), and smaller or shallower grasps are left out (0)",
    )
    parser.add_argument(
        "--seconds",
        type=positive,
        metavar="S",
        help="stop the search (with --out: each) after S seconds with what there is (Ctrl-C does "
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
        "drawings only. Each object has a seed of its own, from --seed and its name: below its "
        "folder, or the bare name of a file that is given itself, so two of one name are refused.",
    )
    many.add_argument(
        "--out", metavar="FILE", type=file_name,
        help="the table (.parquet): a row a grasp, or one that says why there is none",
    )  # fmt: skip
    many.add_argument(
        "--workers", metavar="N", type=count,
        help="processes for a table (one per core), threads for one object (2); no "
        "number changes the result",
    )  # fmt: skip
    many.add_argument(
        "--scheduler", metavar="ADDRESS", type=file_name,
        help="search for the table on the dask.distributed cluster at tcp://HOST:PORT",
    )  # fmt: skip
    add_any_code(many)


def run(args: argparse.Namespace) -> int:
    """The best grasps of many objects, or the list of one object."""
    from icage.errors import InputError

    if args.aim == "friction" and args.mu is None:
        raise InputError("--aim friction needs --mu M, the coefficient of friction at the fingers")
    if args.mu is not None and args.aim != "friction":
        raise InputError("--mu goes with --aim friction only")
    if _are_many(args):
        _of_many(args)
    else:
        from experiments.grasps.run import list_grasps

        (args.object,) = args.object
        list_grasps(args)
    return 0


_OF_ONE = ("figure", "cases", "json")


def _are_many(args: argparse.Namespace) -> bool:
    """Whether a table is meant, with the options for one: by ``--out``, a folder or several names.

    A shipped name is no folder, and in no table.

    Raises
    ------
    InputError:
        An option is for the other.
    """
    from icage.errors import InputError

    given = args.object
    if len(given) > 1:
        what = f"{len(given)} are given"
    elif _is_folder(given[0]):
        what = f"{given[0]!r} is a folder"
    elif args.out is not None or args.scheduler is not None:
        what = f"{'--out' if args.out is not None else '--scheduler'} is for a table"
    else:
        return False
    _check_not_shipped(given)
    for name in _OF_ONE:
        if getattr(args, name) is not None:
            raise InputError(f"--{name} is for one object; {what}")
    if args.phi is not None and args.within is None:
        raise InputError(f"--phi without --within lists the grasps of one object; {what}")
    if args.out is None:
        raise InputError(f"{what}: --out FILE.parquet is needed")
    return True


def _is_folder(name: str) -> bool:
    from pathlib import Path

    from icage.formats.load import is_shipped

    try:
        return Path(name).is_dir() and not is_shipped(name)
    except OSError:  # a name that no file can have: the error comes from whoever reads it
        return False


def _check_not_shipped(given: list[str]) -> None:
    from pathlib import Path

    from icage.errors import InputError
    from icage.formats.load import is_shipped

    for name in given:
        if is_shipped(name):
            there = (
                f"./{name} is the one that is here"
                if Path(name).exists()
                else "--json FILE is for it alone"
            )
            raise InputError(
                f"{name!r} is the shipped object, and a table is of files and folders; {there}"
            )


def _of_many(args: argparse.Namespace) -> None:
    from experiments.cases.reading import reading_of
    from experiments.collection.options import SearchOptions
    from experiments.collection.run import search_objects
    from experiments.grasps.wanted_by_options import wanted_of

    options = SearchOptions(
        wanted_of(args), args.top or 1, args.seed, args.finger_radius,
        reading_of(args, tolerance=args.tolerance != 0.0),
        args.seconds,
    )  # fmt: skip
    lines = search_objects(
        args.object, args.out, options, args.workers, args.scheduler, args.any_code
    )
    print("\n".join(lines))
