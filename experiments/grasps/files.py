"""The grasps that are listed, kept in files: each as a case, all of them as a picture."""

from __future__ import annotations

import shlex
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from experiments.cases.case_files import LISTED, earlier_case_files, write_case_files
from experiments.cases.chosen import Chosen, cases_from, search_command
from experiments.io.whole_folder import whole_folder
from icage.cage import Cage
from icage.case import Case
from icage.formats.contact_sheet import contact_sheet
from icage.formats.whole_files import whole_file

_WRITTEN = (
    ("within", None), ("aim", "first"), ("mu", None), ("corners", 0), ("seed", 0),
    ("least-angle", None), ("least-gap", None), ("sigma-min-of-hand", None),
    ("sigma-max-of-hand", None), ("tolerance", None),
)  # fmt: skip
"""Options and their defaults that say again which grasps were found."""


def write_cases(case: Case, cages: tuple[Cage, ...], args: Namespace) -> None:
    """Each of them as a case file in ``--cases``: all, or none."""
    command = search_command(case, args, args.object)
    if args.phi is not None:
        command += f" --phi {args.phi[0]!r} {args.phi[1]!r}"
    for option, default in _WRITTEN:
        if (value := getattr(args, option.replace("-", "_"))) != default:
            command += f" --{option} {shlex.quote(str(value))}"
    for ends in args.avoid:
        command += " --avoid {!r}:{!r}".format(*ends)
    folder = Path(args.cases)
    found = Chosen(cases_from(case, cages), command)
    names = {LISTED.format(k) for k in range(1, len(cages) + 1)}
    earlier = earlier_case_files(folder, LISTED, case.sources)
    with whole_folder(folder, sorted({*names, *earlier})) as staging:
        write_case_files(found, staging, LISTED)


def draw(cages: Sequence[Cage], scores: Sequence[float], args: Namespace) -> None:
    """All of them on one sheet, ``--figure``."""
    captions = [
        f"{k}: score {score:.4f}, phi {cage.hand.phi_deg[0]:.1f}, {cage.hand.phi_deg[1]:.1f}"
        for k, (cage, score) in enumerate(zip(cages, scores, strict=False), 1)
    ]
    with whole_file(Path(args.figure)) as part:
        part.write_text(contact_sheet(cages, captions), encoding="utf-8")
