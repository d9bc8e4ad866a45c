"""``icage figures CASE-or-DRAWING --out DIR``: the paper's figures, drawn from a case."""

from __future__ import annotations

import argparse
from typing import Any

from experiments.cases.asked import add_case, case_of
from experiments.io.options import file_name


def add_parser(subparsers: Any) -> None:
    """Options of the command."""
    from experiments.figures.paper import FIGURES

    parser = subparsers.add_parser(
        "figures",
        help="the paper's figures, drawn from a case",
        description="Draw the figures of Bunis et al. 2018 from a case by the paper's own method: "
        + "; ".join(f"{name}: {words}" for name, words in FIGURES.items())
        + ". Levels, punctures, caging regions and the way out are those of `icage plan`; with "
        "discs everything else is of point fingers on one polygon, and each line printed says so.",
    )
    add_case(parser)
    parser.add_argument(
        "--out", metavar="DIR", type=file_name, required=True, help="folder, made if it is missing"
    )
    parser.add_argument(
        "--format", choices=("svg", "pdf", "png"), default="svg", help="format of the files (svg)"
    )
    parser.add_argument(
        "--only",
        metavar="NAME",
        nargs="+",
        choices=tuple(FIGURES),
        help="names of the figures to draw (all)",
    )


def run(args: argparse.Namespace) -> int:
    """Search once, then draw what was asked for."""
    from pathlib import Path

    from experiments.figures.paper import FIGURES
    from experiments.io.options import check_folder

    out = Path(args.out)
    case = case_of(args)
    names = [name for name in FIGURES if args.only is None or name in args.only]
    check_folder("--out", out, [f"{name}.{args.format}" for name in names], case.sources)

    from experiments.cases.case_files import ONE, check_case_files, write_case_files
    from experiments.cases.chosen import chosen
    from experiments.figures.paper.figures import write_figures
    from experiments.io.held_folder import held_folder
    from icage.kernels.compiled import long_job

    long_job()
    with held_folder(out, "figures"):
        if case.target is None:
            check_case_files("--out", out, [ONE], case.sources)
        found = chosen(case, args)
        for path, words in write_figures(found.cases[0], names, out, args.format):
            print(f"{path}: {words}", flush=True)
        for name in write_case_files(found, out, ONE):
            print(f"{out / name}: the case that was drawn", flush=True)
    return 0
