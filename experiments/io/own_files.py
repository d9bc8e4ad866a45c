"""Files that icage wrote itself, read as anybody's: they may be damaged, edited or replaced."""

from __future__ import annotations

import os
import stat
import sys
from io import BufferedReader
from pathlib import Path
from typing import Any

from experiments.io.one_line import one_line
from icage.errors import InputError
from icage.formats.json_text import parse_json


class UnreadableError(InputError):
    """A file could not be read for a reason that is not in it: it may be whole, and stays."""


class DamagedError(InputError):
    """What is in a file is not what icage wrote there."""


def open_own(path: Path) -> BufferedReader:
    """A regular file, opened for reading; nothing is waited for.

    Raises
    ------
    UnreadableError:
        It cannot be opened, or is a pipe, a device, a folder.
    """
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
        if stat.S_ISREG(os.fstat(handle).st_mode):
            return os.fdopen(handle, "rb")
        os.close(handle)
    except OSError as error:
        raise unreadable(path, error) from error
    raise UnreadableError(f"{str(path)!r} is no regular file")


def read_own(path: Path, largest: int) -> bytes:
    """What is in a file of at most ``largest`` bytes.

    Raises
    ------
    UnreadableError:
        As ``open_own``, or it cannot be read to its end.
    DamagedError:
        It is larger.
    """
    with open_own(path) as stream:
        try:
            content = stream.read(largest + 1)
        except OSError as error:
            raise unreadable(path, error) from error
    if len(content) > largest:
        raise DamagedError(f"{str(path)!r} is larger than {largest} bytes")
    return content


def own_json(path: Path, largest: int) -> dict[str, Any]:
    """The JSON object in a file: strict, each key once.

    Raises
    ------
    UnreadableError, DamagedError:
        As ``read_own``; or it holds no JSON object.
    """
    try:
        document = parse_json(read_own(path, largest), repr(str(path)))
    except (UnreadableError, DamagedError):
        raise
    except InputError as error:
        raise DamagedError(str(error)) from error
    if not isinstance(document, dict):
        raise DamagedError(f"{str(path)!r} holds no JSON object")
    return document  # pyright: ignore[reportUnknownVariableType]


def unreadable(path: Path, error: OSError) -> UnreadableError:
    """The system refused to read a file."""
    return UnreadableError(f"{str(path)!r} cannot be read: {error.strerror or error}")


def set_aside(path: Path, folder: Path, why: str) -> Path:
    """Move what is no use, and may be somebody's, into ``folder``, and say so; nothing is deleted.

    Raises
    ------
    OSError:
        It cannot be moved.
    """
    folder.mkdir(exist_ok=True)
    place, number = folder / path.name, 1
    while os.path.lexists(place):
        number += 1
        place = folder / f"{path.stem}-{number}{path.suffix}"
    path.rename(place)
    words = one_line(f"{str(path)!r} was set aside as {str(place)!r}: {why}")
    print(f"icage: warning: {words}", file=sys.stderr, flush=True)
    return place
