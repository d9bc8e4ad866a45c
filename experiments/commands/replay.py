"""``icage replay CASE-or-DRAWING --out DIR``: plan, sample, close, check."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

from experiments.cases.asked import add_case, case_of
from experiments.io.options import count, file_name, seed

if TYPE_CHECKING:
    from pathlib import Path

    from experiments.replay.run import Replay
    from icage.case import Case


GRASPS: Final = 3
"""Best grasps of a drawing that are replayed."""


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
    add_case(parser)
    parser.add_argument(
        "--grasps", metavar="K", type=count,
        help=f"of a drawing or an outline without a grasp: replay its K best grasps ({GRASPS})",
    )  # fmt: skip
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
    from pathlib import Path

    from icage.kernels import background

    folder = Path(args.out)
    cases, name = _cases(args)
    background.start(awaited=True)  # while this process loads the engine

    from experiments.io.held_folder import held_folder
    from experiments.io.options import check_folder
    from experiments.replay.files import ALL

    check_folder("--out", folder, ALL, [file for case in cases for file in case.sources])
    with held_folder(folder, "replay"):
        return _run(args, folder, cases, name)


def _run(args: argparse.Namespace, folder: Path, cases: tuple[Case, ...], name: str) -> int:
    """With the folder to itself."""
    import sys

    from icage.errors import InputError

    searching = cases[0].target is None
    if args.grasps is not None and not searching:
        raise InputError(f"--grasps {args.grasps}: {args.case} comes with its grasp; leave it out")
    count = args.grasps or GRASPS

    from experiments.cases.case_files import (
        NUMBERED,
        check_case_files,
        earlier_case_files,
        write_case_files,
    )
    from experiments.cases.chosen import Chosen, chosen
    from experiments.io.progress import stage_bar
    from experiments.io.whole_folder import whole_folder
    from experiments.replay.files import ALL, VIDEO, regions_by_grasp, write_results
    from experiments.replay.recorded_trial import check_kind
    from experiments.replay.run import (  # only now: engine and planner take a second to load
        check_discs,
        replay,
    )
    from icage.kernels import background
    from icage.sampling import SamplingError

    sources = [file for case in cases for file in case.sources]
    check_kind("--out", folder, ALL)
    check_discs(cases)
    if searching:
        names = [NUMBERED.format(k) for k in range(1, count + 1)]
        check_case_files("--out", folder, names, sources)
    if args.video:
        from sim.camera.renderer import check_graphics

        check_graphics()
    found = chosen(cases[0], args, count) if searching else Chosen(cases)
    earlier = earlier_case_files(folder, NUMBERED, sources)
    own = [NUMBERED.format(k) for k in range(1, len(found.cases) + 1)] if searching else []
    try:
        with (
            whole_folder(folder, (*ALL, *{*own, *earlier})) as staging,
            stage_bar() as report,
        ):
            write_case_files(found, staging, NUMBERED)
            done = replay(found.cases, args.trials, args.seed, args.threads or 0, report)
            regions = regions_by_grasp(done, report)
            write_results(done, name, regions, staging)
            if args.video:
                from experiments.replay.video import film

                background.no_longer_awaited()  # a film asks for no kernel that is not there
                film(done, name, regions, staging / VIDEO, report)
    except SamplingError as error:
        print(f"icage: replay failed: {error}", file=sys.stderr)
        return 1
    print("\n".join(summary(done, name, folder)))
    for sentence in done.failures:
        print(f"icage: replay failed: {sentence}", file=sys.stderr)
    return 1 if done.failures else 0


def _cases(args: argparse.Namespace) -> tuple[tuple[Case, ...], str]:
    """The cases that are named, and the object's name: all grasps of a shipped object."""
    from icage.formats.case_json import read_case
    from icage.formats.load import named

    given = named(args.case)
    case = case_of(args)  # checks the options that go with it
    if given.shipped is not None and args.grasp is None:
        return tuple(read_case(path) for path in given.cases), given.shipped
    return (case,), given.shipped or case.name


_HEAD = (
    "grasp", "set", "sigma_first", "sigma_max", "trials", "target", "other", "escaped",
    "not settled", "worst position", "worst angle", "deepest",
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
        "sigma over sigma_0; position and depth over the diameter, angle in rad; not settled = "
        "jammed, diverged, timed out or unmatched",
        *_searches(done),
        *(f"not replayed: {text}" for text in done.skipped),
        f"{'FAILED' if done.failures else 'held'}: {_verdict(done)}; files in {folder}",
    ]


def _row(run: Any) -> tuple[str, ...]:
    counts, cage = run.counts, run.cage
    not_settled = sum(counts[name] for name in ("jammed", "diverged", "timed_out", "unmatched"))
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
        str(counts["other_grasp"]), str(counts["escaped"]), str(not_settled), *worst,
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
