"""``icage explore CASE-or-DRAWING``: a live page on this machine, or one in a file (``--out``)."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of
from experiments.io.options import check_output, file_name, not_negative_list, port_number, positive

SUFFIXES = (".html", ".htm")


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    parser = subparsers.add_parser(
        "explore",
        help="a page to choose contacts, play with the hand and close it in physics",
        description="Without --out: serve a page to this machine's browsers until Ctrl-C. Drag the "
        "contacts along the outline and see whether they hold and how far the hand may open, let "
        "it propose grasps, drag the hand, close it in MuJoCo, save the case. With --out: write "
        "one HTML file that any browser opens, without a network or a server, in which the hand is "
        "dragged, turned and opened. Both answer as `icage query` does, at once.",
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
        "near the target",
    )
    live = parser.add_argument_group("the live page")
    live.add_argument(
        "--port", type=port_number, metavar="N", help="listen there (any port that is free)"
    )
    live.add_argument(
        "--open",
        action=argparse.BooleanOptionalAction,
        help="open the page in the browser (where standard output is a terminal)",
    )
    live.add_argument(
        "--save",
        metavar="FILE",
        type=file_name,
        help="the page's button to save the case writes it there, too; nothing may be there yet",
    )
    live.add_argument(
        "--seconds",
        type=positive,
        metavar="S",
        help="how long grasps are searched before the best so far are proposed (20)",
    )


_LIVE = ("port", "open", "save", "seconds")


def run(args: argparse.Namespace) -> int:
    """A page in a file, or a server until it is ended."""
    from icage.errors import InputError

    case = case_of(args)
    if args.out is None:
        _serve(case, args)
        return 0
    for name in _LIVE:
        if getattr(args, name) is not None:
            raise InputError(f"--{name} is for the live page, and --out writes one into a file")
    _write(case, args)
    return 0


def _serve(case: Any, args: argparse.Namespace) -> None:
    import sys
    from pathlib import Path

    from experiments.cases.chosen import check_radius
    from experiments.explore.live.run import Asked, serve
    from icage.errors import InputError

    check_radius(case)
    given: dict[str, Any] = {} if args.seconds is None else {"seconds": args.seconds}
    if args.seconds is not None and args.seconds > 600.0:
        raise InputError(f"--seconds {args.seconds:g}: up to 600 are searched for a page")
    asked = Asked(
        port=args.port or 0,
        browser=sys.stdout.isatty() if args.open is None else args.open,
        save=None if args.save is None else Path(args.save),
        friction=args.friction or (),
        tolerance=args.tolerance or 0.0,
        **given,
    )
    serve(case, asked)


def _write(case: Any, args: argparse.Namespace) -> None:
    from pathlib import Path

    from icage.errors import InputError

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
