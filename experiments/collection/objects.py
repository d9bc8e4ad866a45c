"""Many objects: which files may hold one, and what each is as it is read."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, NoReturn

from experiments.cases.chosen import check_radius
from experiments.collection.options import SearchOptions
from experiments.io.one_line import one_line
from icage.case import Case
from icage.errors import InputError
from icage.formats.drawings.read import FORMATS, PICTURES, fitting, is_drawing
from icage.formats.load import load_object
from icage.outline import Outline

_SUFFIXES: Final = ", ".join(f"*{suffix}" for suffix in FORMATS)

CASES: Final = ".json"

_DIGITS: Final = 16
"""Hexadecimal digits of a digest that are kept."""


@dataclass(frozen=True, slots=True)
class Readable:
    """An object that can be searched.

    Attributes
    ----------
    file:
        Its name in the table, with slashes: where it is below the folder it was found in.
    digest:
        Of the object as it was read: with another one, rows of it are those of another object.
    seed:
        Of its own search; ``icage grasps FILE --seed`` takes it.
    """

    file: str
    digest: str
    seed: int
    case: Case

    def document(self) -> dict[str, Any]:
        """JSON-ready, for a worker that does not have the file."""
        case = self.case
        target = None if case.target is None else case.contacts.tolist()
        return {
            "file": self.file, "digest": self.digest, "seed": self.seed, "name": case.name,
            "unit": case.unit, "vertices": case.outline.vertices.tolist(),
            "finger_radius": case.finger_radius, "target": target,
        }  # fmt: skip


def readable_of(document: Mapping[str, Any]) -> Readable:
    """The object of a document, to the last bit."""
    case = Case(
        document["name"], document["unit"], Outline(document["vertices"]),
        document["finger_radius"], document["target"],
    )  # fmt: skip
    return Readable(document["file"], document["digest"], document["seed"], case)


@dataclass(frozen=True, slots=True)
class Unreadable:
    """A file that holds no object, and why."""

    file: str
    digest: str
    seed: int
    why: str


def object_files(given: Sequence[Path]) -> list[tuple[str, Path]]:
    """Drawings and case files, by name, in the order of the table: files that are given, and those
    of folders and of the folders in them.

    A file of a folder is named by where it is below that, any other by its name alone: so as if
    all lay in one folder. In folders hidden files and folders are left out, and links to folders
    not followed.

    Raises
    ------
    InputError:
        What is given is not there or no object can be in it, a folder cannot be looked into, or
        two files have one name.
    """
    found: dict[str, Path] = {}
    for place in given:
        for name, path in _files_of(place):
            if name in found:
                raise InputError(_twice(name, found[name], path))
            found[name] = path
    return sorted(found.items())


def _twice(name: str, one: Path, other: Path) -> str:
    if one.absolute() == other.absolute():
        return f"{str(one)!r} is given twice"
    return (
        f"{str(one)!r} and {str(other)!r} are both {name!r} in the table; two files of one name "
        "need a table each, or a folder that holds both of their folders"
    )


def _files_of(place: Path) -> list[tuple[str, Path]]:
    """Name in the table and path of a file, or of each in a folder."""
    try:
        if place.is_dir():
            return _in_folder(place)
        place.lstat()
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise InputError(
            f"{str(place)!r} is no file and no folder to look into: {why.lower()}"
        ) from error
    if not (is_drawing(place) or place.suffix.lower() == CASES):
        raise InputError(f"{str(place)!r} is no drawing ({_SUFFIXES}) and no case file (*.json)")
    return [(_in_table(place.name), place)]


def _in_folder(folder: Path) -> list[tuple[str, Path]]:
    found: list[tuple[str, Path]] = []
    for place, folders, names in os.walk(folder, onerror=_unseen):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in names:
            path = Path(place, name)
            if not name.startswith(".") and _may_hold_one(path):
                found.append((_in_table(path.relative_to(folder).as_posix()), path))
    if not found:
        raise InputError(
            f"{str(folder)!r} holds no drawing ({_SUFFIXES}) and no case file (*.json); images "
            "have to be named one by one"
        )
    return found


def _may_hold_one(path: Path) -> bool:
    """Pictures are often previews of drawings beside them: they count if they are named."""
    suffix = path.suffix.lower()
    return suffix == CASES or (suffix in FORMATS and suffix not in PICTURES)


def _in_table(name: str) -> str:
    """A file's name as the table can hold it, whatever bytes it is made of."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


def _unseen(error: OSError) -> NoReturn:
    raise InputError(f"{error.filename!r} cannot be looked into: {error.strerror}") from error


def read_one(file: str, path: Path, options: SearchOptions) -> Readable | Unreadable:
    """The object in a file; whatever is wrong with it is the object's own, not the folder's."""
    seed = _seed(options.seed, file)
    try:
        case = _read(path, options)
    except Exception as error:
        # a file's name in the table says enough, and it is the same wherever the file is
        folder = "" if path.parent == Path() else f"{path.parent}{os.sep}"
        why = reason(error).replace(folder, "").removeprefix(f"{path.name}: ")
        return Unreadable(file, _digest({"why": why}), seed, why)
    content = {
        "name": case.name, "unit": case.unit, "vertices": case.outline.vertices.tolist(),
        "finger_radius": case.finger_radius,
    }  # fmt: skip
    return Readable(file, _digest(content), seed, case)


def _read(path: Path, options: SearchOptions) -> Case:
    if path.exists() and not path.is_file():
        raise InputError("this is no regular file")
    if is_drawing(path):
        case = load_object(path, **fitting(path, options.reading).given())
    else:
        case = load_object(path)
    if options.finger_radius is not None:
        case = replace(case, finger_radius=options.finger_radius)
    check_radius(case)
    return replace(case, sources=(), size_from="", notes=(), reading=None)


def reason(error: Exception) -> str:
    """Why there is no grasp, in one line; faults of our own say so.

    Raises
    ------
    MemoryError:
        Nothing is wrong with the object.
    """
    if isinstance(error, MemoryError):
        raise error
    if isinstance(error, InputError):
        return one_line(str(error))
    return one_line(f"internal: {type(error).__name__}: {error} (our fault)")


def _seed(seed: int, file: str) -> int:
    """A seed of the file's own: no other file, no order and no number of workers can touch it."""
    return int.from_bytes(hashlib.sha256(f"{seed} {file}".encode()).digest()[:8], "big") >> 1


def _digest(content: dict[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]
