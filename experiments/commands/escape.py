"""``icage escape CASE-or-DRAWING``: attack the cage in physics, and measure sigma_max."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from experiments.cases.asked import add_case, case_of, given_of
from experiments.io.options import add_json, check_output, count, seed


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "escape",
        help="attack the cage in physics: does the object get out below sigma_max, or above?",
        description="Hold the simulated hand at an opening just below and just above the planned "
        "sigma_max, pull the object about at random and along the plan's own way out, and measure "
        "at which opening it gets out. Point fingers become small discs, planned afresh. Exit code "
        "1 if anything escapes below, or the plan's way out does not work above.",
    )
    add_case(parser)
    parser.add_argument(
        "--attacks", metavar="N", type=count, default=24, help="attacks a level (default 24)"
    )
    parser.add_argument(
        "--seed", metavar="S", type=seed, default=0, help="seed of all random numbers (0)"
    )
    add_json(parser)
    parser.add_argument(
        "--threads", metavar="T", type=count, default=None, help="threads to run on (one per core)"
    )


def run(args: argparse.Namespace) -> int:
    """Attack, write, print the table; 1 if anything did not hold."""
    case = case_of(args)
    check_output("--json", args.json, *case.sources)
    from experiments.cases.chosen import chosen, say_how_to_keep
    from experiments.escape.document import escape_document, escape_table
    from experiments.escape.run import escape  # only now: engine and planner take a second to load
    from experiments.io.progress import stage_bar
    from icage.formats.json_out import write_json
    from icage.kernels.compiled import long_job

    long_job()
    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    with stage_bar() as report:
        result = escape(case, args.attacks, args.seed, args.threads or 0, report)
    if args.json is not None:
        write_json({**escape_document(result), "given": given_of(args)}, args.json)
    if args.json != "-":
        print("\n".join(escape_table(result)))
    for sentence in result.failures:
        print(f"icage: escape failed: {sentence}", file=sys.stderr)
    return 1 if result.verdict == "failed" else 0
