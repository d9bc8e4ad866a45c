"""``icage report DIR``: what a run found, as one page."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.io.options import check_output, file_name

SUFFIXES = (".html", ".htm")


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "report",
        help="one page of what a run found: answer, rates with intervals, failures, pictures",
        description="Write one HTML file that any browser opens without a network: the answer in a "
        "sentence, tables to sort and filter, pictures, the video, and every failure with its seed "
        "and the command that plays it again. Of the output folder of replay, study or regress "
        "--out, or of the JSON of escape, shake, regress or experiments.jams.",
    )
    parser.add_argument(
        "source", metavar="DIR", type=file_name, help="output folder, or the JSON file of a command"
    )
    parser.add_argument(
        "--out", metavar="FILE.html", type=file_name,
        help="the page to write (DIR/report.html, or the JSON file's name with .html)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Read, check, write one file."""
    from pathlib import Path

    from experiments.report.run import find, usual_place, write_report
    from icage.errors import InputError

    path = Path(args.source)
    if args.out is not None and Path(args.out).suffix.lower() not in SUFFIXES:
        raise InputError(f"--out {args.out!r}: a name ending in .html is needed")
    source = find(path)
    out = Path(args.out) if args.out is not None else usual_place(path)
    check_output("--out", str(out), source.file)
    done = write_report(source, out)
    print(f"{done.report.answer}\n{out}: {done.size / 1000:.0f} kB")
    return 0
