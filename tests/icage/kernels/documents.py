"""Every case that the repository ships as plan documents: ``python -m ... FOLDER point|disc``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import icage
from experiments.environment import ROOT
from icage.cells.regions import caging_regions
from icage.errors import IcageError
from icage.formats.json_out import json_text
from icage.formats.plan_json import plan_document
from icage.kernels import compiled

FEASIBLE = ("disc_Y", "disc_hammer")
"""Disc cases that are planned in seconds when interpreted; their regions take minutes."""

ONE_OF_MANY = ("ngon9_best",)
"""Point cases whose regions are drawn of one grasp's component, below sigma_first: below sigma_max
they are of nine, and take as long as those of all other cases together when interpreted."""


def cases(kind: str) -> Iterator[tuple[str, icage.Case]]:
    """Name and case of every file with a target, of point or disc fingers."""
    for folder in ("models", "tests/inputs", "tests/icage/contact_space"):
        for file in sorted((ROOT / folder).rglob("*.json")):
            try:
                case = icage.load(file)
            except IcageError:  # inputs that are refused
                continue
            disc = case.finger_radius > 0.0
            wanted = disc and case.name in FEASIBLE if kind == "disc" else not disc
            if wanted and case.target is not None:
                yield file.relative_to(ROOT).as_posix().replace("/", "_"), case


def main(folder: Path, kind: str) -> None:
    """Write the document of every case, regions and all for point fingers."""
    if not compiled._process.never:
        compiled.machine_code_at_once()
    for name, case in cases(kind):
        cage = icage.plan(case)
        drawn = kind == "point" and cage.status != "not_a_cage"
        level = cage.sigma_first if case.name in ONE_OF_MANY else None
        regions = caging_regions(cage, level) if drawn else ()
        document = plan_document(cage, regions, case.name, case.unit)
        (folder / name).write_text(json_text(document))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
