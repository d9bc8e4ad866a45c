"""The case that a command is asked about, and the options with which a drawing may stand there."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from experiments.io.options import UNITS, count, file_name, not_negative, positive

if TYPE_CHECKING:
    from icage.case import Case

CASE_HELP = (
    "case file, plan or list of grasps, or a shipped object's name; or a drawing (*.svg) or an "
    "outline without a grasp, for which the best grasp is searched"
)


def add_case(parser: argparse.ArgumentParser) -> None:
    """``CASE-or-DRAWING`` and its options."""
    parser.add_argument("case", metavar="CASE-or-DRAWING", type=file_name, help=CASE_HELP)
    add_case_options(parser)


def add_case_options(parser: argparse.ArgumentParser, grasp: bool = True) -> None:
    """``--width --unit --finger-radius``, and ``--grasp`` unless the command has its own."""
    add_size(parser)
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


def add_size(parser: argparse.ArgumentParser) -> None:
    """``--width W --unit U`` of a drawing."""
    parser.add_argument(
        "--width", type=positive, metavar="W",
        help="longer side of a drawing, in UNIT (the size the drawing states, if any)",
    )  # fmt: skip
    parser.add_argument(
        "--unit", choices=UNITS,
        help="unit of a drawing's width and of the answer (the one in which the drawing states "
        "its size; m if it states none)",
    )  # fmt: skip


def case_of(args: argparse.Namespace) -> Case:
    """What the command names. It may have no grasp yet: ``chosen`` finds one, after all checks.

    Raises
    ------
    InputError:
        As ``icage.load``.
    """
    from icage.formats.load import load

    return load(
        args.case, width=args.width, unit=args.unit, finger_radius=args.finger_radius,
        grasp=args.grasp,
    )  # fmt: skip


def size_words(thing: Case) -> str:
    """``40 x 23.1 mm, from the file's own size, in mm``."""
    x, y = thing.outline.vertices.max(axis=0) - thing.outline.vertices.min(axis=0)
    return ", ".join(part for part in (f"{x:.6g} x {y:.6g} {thing.unit}", thing.size_from) if part)
