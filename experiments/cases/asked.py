"""The case that a command is asked about, and the options with which a drawing may stand there."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from experiments.cases.reading import add_reading, reading_of, reading_words, say_notes
from experiments.io.options import count, file_name, not_negative

if TYPE_CHECKING:
    from icage.case import Case

CASE_HELP = (
    "case file, plan or list of grasps, or a shipped object's name; or a drawing, or an "
    "outline without a grasp, for which the best grasp is searched"
)


def add_case(parser: argparse.ArgumentParser) -> None:
    """``CASE-or-DRAWING`` and its options."""
    parser.add_argument("case", metavar="CASE-or-DRAWING", type=file_name, help=CASE_HELP)
    add_case_options(parser)


def add_case_options(parser: argparse.ArgumentParser, grasp: bool = True) -> None:
    """How a drawing is read, ``--finger-radius`` and ``--grasp`` unless the command has its own."""
    add_reading(parser)
    parser.add_argument(
        "--finger-radius", metavar="R", type=not_negative,
        help="radius of the disc fingers, for a drawing or an outline without a grasp, in its unit "
        "(0: point fingers)",
    )  # fmt: skip
    if grasp:
        parser.add_argument(
            "--grasp", metavar="K", type=count,
            help="which of a list of grasps or of a shipped object's grasps, from 1 (1)",
        )  # fmt: skip


def case_of(args: argparse.Namespace) -> Case:
    """What the command names, with its warnings said.

    It may have no grasp yet: ``chosen`` finds one, after all checks.

    Raises
    ------
    InputError:
        As ``icage.load``.
    """
    from icage.formats.load import load

    case = load(
        args.case, finger_radius=args.finger_radius, grasp=args.grasp, **reading_of(args).given()
    )
    say_notes(case)
    return case


def given_of(args: argparse.Namespace) -> dict[str, Any]:
    """How the command named its case, for a document: whoever has it can ask again."""
    words = reading_words(reading_of(args))
    if args.finger_radius is not None:
        words += ["--finger-radius", repr(args.finger_radius)]
    if args.grasp is not None:
        words += ["--grasp", str(args.grasp)]
    return {"case": args.case, "options": words}


def size_words(thing: Case) -> str:
    """``40 x 23.1 mm, from the file's mm``."""
    x, y = thing.outline.vertices.max(axis=0) - thing.outline.vertices.min(axis=0)
    return ", ".join(part for part in (f"{x:.6g} x {y:.6g} {thing.unit}", thing.size_from) if part)
