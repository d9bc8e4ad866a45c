"""``icage explore CASE-or-DRAWING --out cage.html``: a page to play with the hand."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of
from experiments.io.options import check_output, file_name, not_negative_list

SUFFIXES = (".html", ".htm")


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "explore",
        help="a page to play with the hand: drag it, turn it, open it, see what it holds",
        description="Write one HTML file that any browser opens, without a network or a server: "
        "the object, the hand and its caging regions. Drag, turn and open the hand with mouse, "
        "touch or keys; the page answers as `icage query` does, at once.",
    )
    add_case(parser)
    parser.add_argument(
        "--out", metavar="FILE.html", type=file_name, help="write the page into this file"
    )
    parser.add_argument(
        "--friction",
        type=not_negative_list,
        metavar="MU[,MU...]",
        help="coefficients of friction for the page's slider: the level below which closing ends "
        "near the target (point fingers)",
    )


def run(args: argparse.Namespace) -> int:
    """Plan, gather what the page needs, write it."""
    from pathlib import Path

    from icage.errors import InputError

    case = case_of(args)
    if args.out is None:
        raise InputError(
            "explore needs --out FILE.html, the page that it writes; there is no live page yet"
        )
    if Path(args.out).suffix.lower() not in SUFFIXES:
        raise InputError(f"--out {args.out!r}: a name ending in .html is needed")
    check_output("--out", args.out, *case.sources)

    from experiments.cases.chosen import chosen, say_how_to_keep
    from experiments.explore.run import write_page

    found = chosen(case, args)
    say_how_to_keep(found)
    (case,) = found.cases
    page = write_page(case, Path(args.out), args.friction or ())
    print(f"{args.out}: {page.size / 1000:.0f} kB, {page.outside} cells hold the object elsewhere")
    return 0
