"""``icage shake CASE-or-DRAWING``: after closing, is the object held?"""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of, given_of
from experiments.io.options import add_json, check_output, seed


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "shake",
        help="whether the closed hand holds the object: pushes, form closure, play",
        description="Close the simulated hand into the target grasp, lock the fingers, push the "
        "object in 8 directions and turn it both ways, shake it, test the contacts for form "
        "closure, and measure the play of a grasp on three edges. Point fingers become discs of "
        "radius 2 % of the diameter. Exit code 1 if the object is not held or a check failed.",
    )
    add_case(parser)
    add_json(parser)
    parser.add_argument(
        "--seed", metavar="S", type=seed, default=0, help="seed of all random numbers (0)"
    )


def run(args: argparse.Namespace) -> int:
    """Close, lock, push, measure; 1 if anything did not hold."""
    import sys

    from icage.formats.json_out import write_json

    case = case_of(args)
    check_output("--json", args.json, *case.sources)

    from experiments.cases.chosen import chosen, say_how_to_keep
    from experiments.cases.with_discs import (
        physical_case,  # only now: the planner takes time to load
    )
    from experiments.shake.document import shake_document, shake_summary
    from experiments.shake.run import ShakeError, shake_case
    from icage.kernels.compiled import long_job

    long_job()
    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    try:
        done = shake_case(physical_case(case), args.seed)
    except ShakeError as error:
        print(f"icage: shake failed: {error}", file=sys.stderr)
        return 1
    if args.json is not None:
        write_json({**shake_document(done), "given": given_of(args)}, args.json)
    if args.json != "-":
        print("\n".join(shake_summary(done)))
    for sentence in done.failures:
        print(f"icage: shake failed: {sentence}", file=sys.stderr)
    return 1 if done.failures else 0
