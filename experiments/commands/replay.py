"""``icage replay NAME-OR-CASE --out DIR``: plan, sample, close, check."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from experiments.io.options import count, file_name, seed

if TYPE_CHECKING:
    from pathlib import Path

    from experiments.replay.run import Replay


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "replay",
        help="close a simulated hand from placements in the cage and check where it ends",
        description="Plan each grasp, draw placements from its guaranteed set (and from the rest "
        "of its cage, where there is any), close the hand from each on the free object in MuJoCo "
        "and judge where it ended. Exit code 0 only if every guaranteed trial ended in the target "
        "and nothing escaped.",
    )
    parser.add_argument(
        "case", metavar="NAME-OR-CASE", type=file_name, help="a shipped object, or a case file"
    )
    parser.add_argument(
        "--out", metavar="DIR", type=file_name, required=True,
        help="folder for replay.json, trials.parquet, regions.svg and replay.mp4",
    )  # fmt: skip
    parser.add_argument(
        "--trials", metavar="N", type=count, default=1000, help="closings a run (default 1000)"
    )
    parser.add_argument(
        "--seed", metavar="S", type=seed, default=0, help="seed of all random numbers (0)"
    )
    parser.add_argument(
        "--video", action=argparse.BooleanOptionalAction, default=True, help="write replay.mp4"
    )
    parser.add_argument(
        "--threads", metavar="T", type=count, default=None, help="threads to run on (one per core)"
    )


def run(args: argparse.Namespace) -> int:
    """Replay, write, print the table; 1 if anything did not hold."""
    import sys
    from pathlib import Path

    from experiments.cases.named import named
    from experiments.io.options import check_folder
    from icage.formats.case_json import read_case

    given = named(args.case)
    folder = Path(args.out)
    cases = [read_case(path) for path in given.cases]

    from experiments.io.progress import stage_bar
    from experiments.replay.files import ALL, VIDEO, regions_by_grasp, whole_folder, write_results
    from experiments.replay.run import replay  # only now: engine and planner take a second to load
    from icage.sampling import SamplingError

    check_folder("--out", folder, ALL, [file for case in cases for file in case.sources])
    if args.video:
        from sim.camera.renderer import check_graphics

        check_graphics()
    name = given.shipped or cases[0].name
    try:
        with whole_folder(folder) as staging, stage_bar() as report:
            done = replay(cases, args.trials, args.seed, args.threads or 0, report)
            regions = regions_by_grasp(done, report)
            write_results(done, name, regions, staging)
            if args.video:
                from experiments.replay.video import film

                film(done, name, regions, staging / VIDEO, report)
    except SamplingError as error:
        print(f"icage: replay failed: {error}", file=sys.stderr)
        return 1
    print("\n".join(summary(done, name, folder)))
    for sentence in done.failures:
        print(f"icage: replay failed: {sentence}", file=sys.stderr)
    return 1 if done.failures else 0


_HEAD = (
    "grasp", "set", "sigma_first", "sigma_max", "trials", "target", "other", "escaped", "lost",
    "worst position", "worst angle", "deepest",
)  # fmt: skip


def summary(done: Replay, name: str, folder: Path) -> list[str]:
    """A table to read: levels over sigma_0, counts, errors over the diameter."""
    first = done.runs[0]
    rows = [_HEAD, *(_row(run) for run in done.runs)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(_HEAD))]
    table = [
        "  ".join(
            text.ljust(width) if k < 2 else text.rjust(width)
            for k, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    return [
        f"{name}: {len(first.case.outline)} vertices, diameter "
        f"{first.case.outline.diameter:.6g} {first.case.unit}, fingers of radius "
        f"{first.case.finger_radius:g} {first.case.unit}, seed {done.seed}",
        *table,
        "sigma over sigma_0; position and depth over the diameter, angle in rad; lost = jammed, "
        "diverged, timed out or unmatched",
        *_searches(done),
        *(f"not replayed: {text}" for text in done.skipped),
        f"{'FAILED' if done.failures else 'held'}: {_verdict(done)}; files in {folder}",
    ]


def _row(run: Any) -> tuple[str, ...]:
    counts, cage = run.counts, run.cage
    lost = sum(counts[name] for name in ("jammed", "diverged", "timed_out", "unmatched"))
    reached = run.verdicts.outcome == 0
    worst = [
        f"{values[reached].max():.1e}" if reached.any() else "-"
        for values in (run.verdicts.position_error, run.verdicts.angle_error)
    ]
    levels = [
        "never" if level is None else f"{level / cage.sigma_0:.5f}"
        for level in (cage.sigma_first, cage.sigma_max)
    ]
    return (
        run.case.name, run.which, *levels, str(len(run.closings)), str(counts["target"]),
        str(counts["other_grasp"]), str(counts["escaped"]), str(lost), *worst,
        f"{run.closings.penetration_max.max():.1e}",
    )  # fmt: skip


def _searches(done: Replay) -> Iterator[str]:
    """One line a grasp, as the paper reports its own search. [Bunis2018, Sec. VII-B]"""
    from experiments.replay.run import escape_puncture
    from icage.agreement import disagreements

    for run in done.runs:
        if run.which != "guaranteed":
            continue
        log, escape = run.second.search, escape_puncture(run.second)
        way = "no escape puncture"
        if escape is not None:
            touching = [str(k) for k in (1, 2, 3) if k not in escape.free_fingers]
            way = f"a {len(touching)}-finger escape puncture (fingers {', '.join(touching)})"
        tunnels = 0 if log is None else log.tunnel_edges_used
        yield (
            f"{run.case.name}: contact space agrees to 1e-7; {way}, "
            f"{tunnels} tunnel edge{'' if tunnels == 1 else 's'} in its graph"
            if not disagreements(run.cage, run.second)
            else f"{run.case.name}: contact space DISAGREES"
        )


def _verdict(done: Replay) -> str:
    sure = [run for run in done.runs if run.which == "guaranteed"]
    trials = sum(len(run.closings) for run in sure)
    reached = sum(run.counts["target"] for run in sure)
    escaped = sum(run.counts["escaped"] for run in done.runs)
    return (
        f"{reached} of {trials} closings from guaranteed sets ended in the target grasp, "
        f"{escaped} of {sum(len(run.closings) for run in done.runs)} escaped"
    )
