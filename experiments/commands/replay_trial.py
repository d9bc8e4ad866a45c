"""``icage replay-trial DIR INDEX``: close one recorded trial again, exactly."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from experiments.io.options import add_json, check_output, file_name, row_index

if TYPE_CHECKING:
    from experiments.replay.recorded_trial import Rerun


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "replay-trial",
        help="close one recorded trial again, compare it bit for bit, and film it",
        description="Close one trial of a replay again, from its recorded start, and compare "
        "outcome, steps, end pose, errors and depths with the record. Exit code 1 if anything "
        "differs although all versions are the same.",
    )
    parser.add_argument(
        "folder",
        metavar="DIR",
        type=file_name,
        help="folder of `icage replay`, `icage regress --out` or `icage study`",
    )
    parser.add_argument(
        "index", metavar="INDEX", type=row_index,
        help="row in the whole of trials.parquet, from 0",
    )  # fmt: skip
    parser.add_argument("--video", metavar="FILE", type=file_name, help="film it into FILE (.mp4)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Close again, compare, film; 1 if it differs on the same versions."""
    from pathlib import Path

    from experiments.io.options import same
    from icage.errors import InputError

    folder = Path(args.folder)
    inputs = tuple(folder / name for name in ("replay.json", "study.json", "trials.parquet"))
    check_output("--json", args.json, *inputs)
    check_output("--video", args.video, *inputs)
    if args.video is not None and Path(args.video).suffix.lower() != ".mp4":
        raise InputError(f"--video {args.video!r}: a name ending in .mp4 is needed")
    if args.video is not None and args.json not in (None, "-") and same(args.json, args.video):
        raise InputError(f"--json and --video both name {args.json!r}")
    if args.video is not None:
        from sim.camera.renderer import check_graphics

        check_graphics()

    if (folder / "study.json").is_file():
        from experiments.study.report import replayed_trial as replayed_words
        from experiments.study.run import one_trial_again as replayed

        again = replayed.rerun_trial(folder, args.index)
        if args.video is not None:
            replayed.film_rerun(again, Path(args.video))
        return _told(args, again, replayed_words.document(again), replayed_words.summary(again))

    from experiments.replay.recorded_trial import (  # only now: they take a second to load
        read_trial,
        rerun,
    )

    done = rerun(read_trial(folder, args.index))
    if args.video is not None:
        from experiments.replay.trial_film import film_trial

        film_trial(done, Path(args.video))
    return _told(args, done, document(done), summary(done))


def _told(args: argparse.Namespace, done: Any, whole: dict[str, Any], lines: Iterator[str]) -> int:
    """Write the document, print the lines; 1 if anything differs on the same versions."""
    import sys

    from icage.formats.json_out import write_json

    if args.json is not None:
        write_json(whole, args.json)
    if args.json != "-":
        print("\n".join(lines))
    failed = bool(done.differences) and not done.other_versions
    if failed:
        names = ", ".join(name for name, _, _ in done.differences)
        print(f"icage: replay-trial failed: same versions, but {names} differ", file=sys.stderr)
    return 1 if failed else 0


def document(done: Rerun) -> dict[str, Any]:
    """The document ``icage-replay-trial/1``; lengths in ``unit``, angles in [rad]."""
    trial, closing = done.trial, done.closings[0]
    return {
        "format": "icage-replay-trial/1",
        "index": trial.index,
        "grasp": trial.row["grasp"],
        "set": trial.row["set"],
        "trial": trial.row["trial"],
        "seed": trial.row["seed"],
        "unit": trial.unit,
        "start": closing.start.as_array(),
        "verdict": trial.row["verdict"],
        "recorded": {
            key: value for key, value in trial.row.items() if not key.startswith("start_")
        },
        **_now(done),
        "identical": done.identical,
        "differences": [
            {"what": what, "recorded": was, "now": now} for what, was, now in done.differences
        ],
        "versions_differ": {
            name: {"recorded": was, "here": here}
            for name, (was, here) in trial.other_versions.items()
        },
    }


def _now(done: Rerun) -> dict[str, Any]:
    from sim.closing.judge import OUTCOMES

    closing, verdicts, size = done.closings[0], done.verdicts, done.trial.outline.diameter
    diverged = OUTCOMES[int(verdicts.outcome[0])] == "diverged"
    return {
        "outcome": OUTCOMES[int(verdicts.outcome[0])],
        "grasp_id": int(verdicts.grasp_id[0]),
        "steps": closing.steps,
        "end": None if diverged else closing.end.as_array(),
        "position_error": None if diverged else float(verdicts.position_error[0]) * size,
        "angle_error": None if diverged else float(verdicts.angle_error[0]),
        "penetration_max": None if diverged else closing.penetration_max * size,
        "penetration_rest": None if diverged else closing.penetration_rest * size,
    }


def summary(done: Rerun) -> Iterator[str]:
    """Lines for a reader."""
    trial, now = done.trial, _now(done)
    unit = trial.unit
    yield (
        f"{trial.row['grasp']}, {trial.row['set']} set, trial {trial.row['trial']} "
        f"(row {trial.index}), seed {trial.row['seed']}"
    )
    yield f"start        {_pose(done.closings[0].start.as_array(), unit)}"
    yield f"verdict      {trial.row['verdict']}"
    yield f"outcome      {now['outcome'].replace('_', ' ')} after {now['steps']} steps"
    if now["end"] is not None:
        yield f"end          {_pose(now['end'], unit)}"
        yield (
            f"error        {now['position_error']:.3g} {unit}, {now['angle_error']:.3g} rad "
            f"from the target; deepest {now['penetration_max']:.3g} {unit}, "
            f"at rest {now['penetration_rest']:.3g} {unit}"
        )
    for name, (was, here) in trial.other_versions.items():
        yield f"version      {name} was {was}, is {here}"
    for what, was, value in done.differences:
        yield f"differs      {what} was {was!r}, is {value!r}"
    if done.identical:
        yield "record       the same to the last bit"


def _pose(row: Any, unit: str) -> str:
    x, y, theta, sigma = (float(value) for value in row)
    return f"x {x:.9g}, y {y:.9g}, theta {theta:.9g} rad, sigma {sigma:.9g} {unit}"
