"""``icage regress``: the planner against itself, against physics and against a baseline."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from experiments.io.options import add_json, check_folder, check_output, count, file_name


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "regress",
        help="planner against physics on many cases, compared with a committed baseline",
        description="For every case: plan with both methods; close the simulated hand from the "
        "guaranteed set, from the rest of the cage and from outside; attack the cage below and "
        "above sigma_max; shake the closed hand. Exit code 1 if anything does not hold or is not "
        "as in the baseline.",
    )
    level = parser.add_mutually_exclusive_group()
    level.add_argument("--fast", action="store_true", help="five cases, 8 attacks each")
    level.add_argument("--full", action="store_true", help="200 attacks a case, all attackers")
    parser.add_argument(
        "--cases", metavar="DIR", type=file_name, help="folder of case files (the shipped ones)"
    )
    parser.add_argument(
        "--baseline",
        metavar="FILE",
        type=file_name,
        help="compare with FILE (the committed baseline)",
    )
    parser.add_argument(
        "--update-baseline",
        action="store_true",
        help="write what was measured as the baseline; prints what changes",
    )
    add_json(parser)
    parser.add_argument(
        "--out", metavar="DIR", type=file_name, help="keep all closings there, for replay-trial"
    )
    parser.add_argument("--markdown", metavar="FILE", type=file_name, help="the table as a page")
    parser.add_argument("--junit", metavar="FILE", type=file_name, help="JUnit XML")
    parser.add_argument(
        "--workers",
        metavar="N",
        type=count,
        default=None,
        help="processes to run on (one per core)",
    )


def run(args: argparse.Namespace) -> int:
    """Run, write, print; 1 if anything did not hold."""
    from contextlib import ExitStack

    from experiments.io.held_folder import held_folder

    for option in ("json", "markdown", "junit"):
        check_output(f"--{option}", getattr(args, option))
    if args.out is not None:
        check_folder("--out", Path(args.out), ("replay.json", "trials.parquet"))
    with ExitStack() as holds:
        if args.out is not None:
            from experiments.replay.files import ALL
            from experiments.replay.recorded_trial import check_kind

            holds.enter_context(held_folder(Path(args.out), "regress"))
            check_kind("--out", Path(args.out), ALL)
        return _run(args)


def _run(args: argparse.Namespace) -> int:
    """With all places checked."""
    from experiments.io.progress import stage_bar
    from experiments.regress.baseline import baseline_path
    from experiments.regress.junit import junit
    from experiments.regress.measure import SEED
    from experiments.regress.record import write_records
    from experiments.regress.run import new_baseline, regress
    from experiments.regress.table import markdown, terminal
    from icage.formats.json_out import write_json  # only now: engine and planner take time to load
    from icage.formats.whole_files import whole_file
    from icage.kernels.compiled import long_job

    level = "fast" if args.fast else "full" if args.full else "default"
    folder = None if args.cases is None else Path(args.cases)
    baseline = None if args.baseline is None else Path(args.baseline)
    place = baseline or baseline_path(level)
    if args.update_baseline:
        check_output("--baseline", str(place))
    long_job()
    with stage_bar() as report:
        done = regress(level, folder, baseline, args.workers or 0, report)
    document = {"format": "icage-regress/1", "level": level, "cases": list(done.rows)}
    if args.json is not None:
        write_json(document, args.json)
    option = "" if level == "default" else f" --{level}"
    if args.markdown is not None:
        page = markdown(done.rows, f"Planner against physics ({level})", f"icage regress{option}")
        with whole_file(Path(args.markdown)) as part:
            part.write_text("\n".join(page) + "\n", encoding="utf-8")
    if args.junit is not None:
        with whole_file(Path(args.junit)) as part:
            part.write_text(junit(done.rows, done.seconds), encoding="utf-8")
    if args.out is not None:
        write_records(list(done.records), SEED, Path(args.out))
    if args.json != "-":
        print("\n".join(terminal(done.rows)))
    for name in done.missing:
        print(f"icage: regress: {name} is not in the baseline", file=sys.stderr)
    if args.update_baseline:
        for line in done.changes or ("nothing beyond the tolerances",):
            print(f"icage: regress: baseline changes: {line}", file=sys.stderr)
        write_json(new_baseline(done), str(place))
        held = [f for row in done.rows for f in row["failures"] if not f.startswith("baseline: ")]
        return 1 if held else 0
    return 1 if done.failed else 0
