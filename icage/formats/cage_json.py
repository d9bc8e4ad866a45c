"""A cage in a file: ``icage-plan/1`` with its object, so that it can be asked again later."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from icage.agreement import difference
from icage.cage import Cage
from icage.case import Case
from icage.cells.regions import caging_regions
from icage.checks import a_path
from icage.errors import CaseError
from icage.formats.case_json import read_case, read_json
from icage.formats.json_out import write_json
from icage.formats.plan_json import plan_document
from icage.planner import plan

UNNAMED: Final = "object"
"""Name in the file of a cage that was planned without one."""

CHANGED: Final = {"points": 1e-7, "discs": 1e-3}
"""[1] A level that planning afresh misses by more (relative) is not the one in the file. With discs
the levels lie in brackets that later versions may narrow."""


def save_cage(cage: Cage, file: Path) -> None:
    """Write the cage, its object and its regions (where its method draws them)."""
    regions = caging_regions(cage) if cage.work is not None else ()
    document = plan_document(cage, regions, cage.name or UNNAMED, cage.unit or "m")
    write_json({**document, "unnamed": not cage.name}, str(file))


def read_cage(file: str | Path) -> Cage:
    """The cage in a file that ``Cage.save`` or ``icage plan --json`` has written.

    The object and the grasp are read and planned again, which takes milliseconds; the levels in
    the file must come out, so that a file edited by hand or of another version is not believed.

    Raises
    ------
    CaseError:
        Not such a file, or its levels are not those of its object and grasp.

    Examples
    --------
    >>> import tempfile, icage
    >>> cage = icage.plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]], [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]]
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cage.save(f"{folder}/cage.json")
    ...     abs(icage.read_cage(f"{folder}/cage.json").sigma_max - cage.sigma_max) < 1e-12
    True
    """
    path = a_path(file, "file")
    case = read_case(path)
    cage = plan(case)
    document: Any = read_json(path)
    _compare(path, document, cage, case)
    return replace(cage, name="", unit="") if document.get("unnamed") is True else cage


def _compare(path: Path, document: Any, cage: Cage, case: Case) -> None:
    allowed = CHANGED["discs" if case.finger_radius > 0.0 else "points"]
    for name in ("sigma_0", "sigma_first", "sigma_max"):
        if name not in document:
            raise CaseError(f"{path} holds no {name}: it is a case and not a cage; plan it")
        written = document[name]
        number = isinstance(written, int | float) and not isinstance(written, bool)
        if written is not None and not number:
            raise CaseError(f"{path}: {name} is no number")
        found = getattr(cage, name)
        if difference(written, found) > allowed:
            raise CaseError(
                f"{path}: {name} is {written}, but its object and grasp give {found}; the file "
                "was edited or made by another version: plan it again"
            )
