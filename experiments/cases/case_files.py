"""Cases that were found by a search, as files in a folder: all of them or none, and nobody else's.

A file that icage wrote says so (``made_by``), and the next run may replace or remove it. Any other
file of the same name is somebody's own and stays.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from experiments.cases.chosen import Chosen
from experiments.io.options import check_folder
from icage.errors import InputError
from icage.formats.case_json import FORMAT, MAX_BYTES, case_document
from icage.formats.json_out import write_json

ONE: Final = "case.json"
"""Where a command works on one case."""

NUMBERED: Final = "case-{}.json"
"""Where it works on several, from 1."""

LISTED: Final = "{}.json"
"""In a folder that holds nothing else."""


def check_case_files(
    option: str, folder: Path, names: Sequence[str], inputs: Sequence[Path] = ()
) -> None:
    """Refuse a folder in which a case that was found would take the place of another file.

    Raises
    ------
    InputError:
        As ``check_folder``; or one of the files is there and icage has not written it.
    """
    check_folder(option, folder, names, inputs)
    for name in names:
        path = folder / name
        if path.exists() and not _is_ours(path):
            raise InputError(
                f"{option} {str(folder)!r} holds {name}, which no search of icage has written; "
                "name another folder, or move it away"
            )


def write_case_files(found: Chosen, folder: Path, pattern: str) -> tuple[str, ...]:
    """Each case that was found as a file; none where the case came with its grasp."""
    if found.made_by is None:
        return ()
    names = tuple(pattern.format(k) for k in range(1, len(found.cases) + 1))
    for name, case in zip(names, found.cases, strict=True):
        write_json(case_document(case, found.made_by), str(folder / name))
    return names


def earlier_case_files(folder: Path, pattern: str, inputs: Sequence[Path] = ()) -> tuple[str, ...]:
    """Names of such files that an earlier run has left, without those that this one has read."""
    shape = re.compile(re.escape(pattern).replace(r"\{\}", "[1-9][0-9]*"))
    taken = {path.resolve() for path in inputs}
    return tuple(
        path.name
        for path in (sorted(folder.iterdir()) if folder.is_dir() else ())
        if shape.fullmatch(path.name) and path.resolve() not in taken and _is_ours(path)
    )


def _is_ours(path: Path) -> bool:
    try:
        if not path.is_file() or path.stat().st_size > MAX_BYTES:
            return False
        document: Any = json.loads(path.read_bytes())
        return document["format"] == FORMAT and document["made_by"].startswith("icage grasps ")
    except (OSError, ValueError, RecursionError, KeyError, TypeError, AttributeError):
        return False
