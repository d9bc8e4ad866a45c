"""The document of a finished study, read as anybody's and checked."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from experiments.study.run.document import parsed_document
from experiments.study.run.folder import JSON, read_document
from icage.errors import InputError


def read_finished(folder: Path) -> dict[str, Any]:
    """``study.json`` of a folder whose study is done: case and config checked field by field.

    Raises
    ------
    InputError:
        None is there, it is damaged or edited, or its study is not finished.
    """
    document = read_document(folder)
    if document is None:
        raise InputError(f"{str(folder)!r} holds no study")
    try:
        parsed_document(document)
    except InputError as error:
        raise InputError(f"{str(folder / JSON)!r}: {error}") from error
    if not is_finished(document):
        raise InputError(f"{str(folder / JSON)!r} is of a study that is not finished")
    return document


def is_finished(document: Mapping[str, Any]) -> bool:
    """Whether a study's document tells what was found."""
    return document.get("finished") is True and isinstance(document.get("found"), dict)
