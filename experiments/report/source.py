"""Which run a folder or a file holds the output of."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from experiments.io.own_files import DamagedError, UnreadableError, open_own, own_json
from icage.errors import InputError
from icage.staging import sweep

LARGEST: Final = 1_000_000_000
"""[byte] Of a document."""

MOST_FILES: Final = 200
"""JSON files of a folder that are looked into."""

KINDS: Final = {
    "icage-replay/1": "replay",
    "icage-study/1": "study",
    "icage-regress/1": "regress",
    "icage-escape/1": "escape",
    "icage-shake/1": "shake",
    "icage-jams/1": "jams",
}
"""Formats that a report can be made of."""

_HEAD: Final = 200
"""[byte] Of a file, in which our documents name their format."""

_FIRST: Final = ("study.json", "replay.json")
"""Documents whose tables lie beside them."""


@dataclass(frozen=True, slots=True)
class Source:
    """A document and where it lies.

    Attributes
    ----------
    folder:
        Its folder, in which tables, figures and videos may be.
    named:
        The folder as it was named, for commands.
    """

    file: Path
    document: dict[str, Any]
    folder: Path
    named: str

    @property
    def kind(self) -> str:
        """One of ``KINDS``."""
        return KINDS[self.document["format"]]


def find(path: Path) -> Source:
    """The document of a folder, or of a file.

    Raises
    ------
    InputError:
        It is not there, of no kind that has a report, more than one, or damaged.
    """
    if not path.is_dir():
        if not os.path.lexists(path):
            raise InputError(f"{str(path)!r} is not there")
        return _source(path, own_json(path, LARGEST))
    sweep(path)  # a replay that died while its files took their places
    for name in _FIRST:
        if os.path.lexists(path / name):
            return _source(path / name, own_json(path / name, LARGEST))
    found = [one for file in _json_files(path) if (one := _known(file)) is not None]
    if len(found) > 1:
        names = ", ".join(one.file.name for one in found[:5])
        raise InputError(f"{str(path)!r} holds several documents ({names}); name one of them")
    if not found:
        raise InputError(
            f"{str(path)!r} holds no output of replay, study, regress, escape, shake or "
            "experiments.jams"
        )
    return found[0]


def _source(file: Path, document: dict[str, Any]) -> Source:
    kind = document.get("format")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(
            f"{str(file)!r} has format {kind!r}; a report is made of {', '.join(KINDS)}"
        )
    return Source(file, document, file.parent, str(file.parent))


def _json_files(folder: Path) -> list[Path]:
    try:
        names = sorted(file.name for file in folder.iterdir() if file.suffix.lower() == ".json")
    except OSError as error:
        raise UnreadableError(f"{str(folder)!r} cannot be read: {error.strerror}") from error
    if len(names) > MOST_FILES:
        raise InputError(f"{str(folder)!r} has {len(names)} JSON files; name one of them")
    return [folder / name for name in names]


def _known(file: Path) -> Source | None:
    """A document with a report; None for other files of the folder, which are nobody's business."""
    try:
        with open_own(file) as stream:
            if b'"icage-' not in stream.read(_HEAD):
                return None
        document = own_json(file, LARGEST)
    except (OSError, UnreadableError, DamagedError):
        return None
    return _source(file, document) if str(document.get("format")) in KINDS else None
