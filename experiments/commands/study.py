"""``icage study CASE-or-DRAWING --vary ... --out DIR``: how wrong may everything be?"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from experiments.cases.asked import add_case_options
from experiments.io.options import add_any_code, count, file_name, number, positive, seed
from experiments.study.inputs.fields import HELP

if TYPE_CHECKING:
    from experiments.study.run.session import Session

_WORDS = ("starts", "place", "sampling", "uncaged")
_POSITIVE = ("until_half_width", "position_tolerance", "angle_tolerance", "max_time", "time_step")


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "study",
        help="Monte Carlo: how wrong may placement, friction, shape and hand be?",
        description="Close the hand many times with uncertain inputs and report how often it ends "
        "in the target grasp: a rate with an interval, a map, and the number of every trial that "
        "failed. Results appear shard by shard; --resume goes on after anything.",
        epilog="Exit code 0 if the study was run, whatever its rate. A study may also be a TOML "
        "file with the same fields: icage study study.toml --out DIR.",
    )
    parser.add_argument("case", metavar="CASE", type=file_name, nargs="?", help=HELP["case"])
    parser.add_argument(
        "--case", metavar="CASE", dest="instead", type=file_name,
        help="instead of the case that a TOML file names",
    )  # fmt: skip
    add_case_options(parser, grasp=False)
    parser.add_argument("--out", metavar="DIR", type=file_name, help="folder for all results")
    parser.add_argument(
        "--vary", metavar="NAME=DIST", action="append", default=[], help=HELP["vary"]
    )
    for name in ("grasp", "trials"):
        parser.add_argument(_option(name), metavar="N", type=count, help=HELP[name])
    parser.add_argument("--seed", metavar="S", type=seed, help=HELP["seed"])
    for name in _WORDS:
        parser.add_argument(_option(name), metavar="WORD", help=HELP[name])
    parser.add_argument("--nominal", metavar="X,Y,THETA,SIGMA", type=_four, help=HELP["nominal"])
    for name in _POSITIVE:
        parser.add_argument(_option(name), metavar="X", type=positive, help=HELP[name])
    parser.add_argument(
        "--resume", action="store_true",
        help="go on with the study in DIR; CASE and all the rest may be left out, and "
        "more --trials asked for",
    )  # fmt: skip
    add_any_code(parser)
    parser.add_argument(
        "--threads", metavar="T", type=count, default=None, help="threads to run on (one per core)"
    )
    parser.add_argument(
        "--shard", metavar="N", type=count, default=None,
        help="trials in a shard (250 to 1000, at least two shards a thread)",
    )  # fmt: skip
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", type=file_name,
        help="run the shards on the dask.distributed cluster at tcp://HOST:PORT",
    )  # fmt: skip
    parser.add_argument(
        "--figures", action=argparse.BooleanOptionalAction, default=True, help="draw figures"
    )
    parser.add_argument(
        "--variables", action="store_true", help="list the inputs that can vary, and stop"
    )


def _option(name: str) -> str:
    return "--" + name.replace("_", "-")


def _four(text: str) -> tuple[float, ...]:
    numbers = text.split(",")
    if len(numbers) != 4:
        raise argparse.ArgumentTypeError(f"{text!r}: X,Y,THETA,SIGMA is needed")
    return tuple(number(text) for text in numbers)


def run(args: argparse.Namespace) -> int:
    """Check everything, run what is missing, sum up."""
    if args.variables:
        from experiments.study.inputs.variable_list import listing

        print("\n".join(listing()))
        return 0

    from experiments.study.run.session import held, run_session, session_of
    from icage.kernels.compiled import long_job

    given = _given(args)
    with held(args.out):
        session: Session = session_of(given, args.out, args.resume, args.shard, args.any_code)
        long_job()
        lines = run_session(session, args.threads, args.scheduler, args.figures)
    print("\n".join(lines))
    return 0


def _given(args: argparse.Namespace) -> dict[str, Any]:
    """The fields that the command line names."""
    from experiments.study.inputs.config import ConfigError
    from experiments.study.inputs.fields import DRAWING

    given: dict[str, Any] = {}
    names = ("case", *DRAWING, "grasp", "trials", "seed", "nominal", *_WORDS, *_POSITIVE)
    for name in names:
        value = getattr(args, name)
        if value is not None:
            given[name] = value
    if args.instead is not None:
        given["instead"] = args.instead
    vary: dict[str, str] = {}
    for text in args.vary:
        name, equals, value = text.partition("=")
        name = name.strip()
        if not (equals and name and value.strip()):
            raise ConfigError(f"--vary {text!r}; NAME=DISTRIBUTION is needed")
        if name in vary:
            raise ConfigError(f"--vary {name} is given twice")
        vary[name] = value
    if vary:
        given["vary"] = vary
    return given
