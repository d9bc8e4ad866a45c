"""Output files appear whole or not at all: written beside their place, then moved there.

Only regular files are replaced. A link is followed; a device or a pipe (``/dev/null``, a FIFO,
``>(...)``) is written into, once everything is there.
"""

from __future__ import annotations

import os
import re
import secrets
import stat
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path

from icage.errors import OutputError


@contextmanager
def whole_file(path: Path) -> Generator[Path]:
    """A path to write to; what was written takes the place of ``path`` when the block ends well.

    If the block raises, nothing is left and an older ``path`` stays as it was. The name keeps
    its suffix, because writers choose the format by it.

    Raises
    ------
    OutputError:
        The file cannot be written.
    """
    try:
        place = replaced(path)
        with _in_a_stream(path) if place is None else _beside(place) as part:
            yield part
    except OSError as error:
        raise OutputError(f"{str(path)!r} cannot be written: {error.strerror or error}") from error


def replaced(path: Path) -> Path | None:
    """The regular file, there or not yet, that ``path`` means; None for a device or a pipe.

    Raises
    ------
    OutputError:
        A folder or anything else that takes no file.
    OSError:
        A circle of links, a folder that may not be looked into.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return path.resolve()
    if stat.S_ISCHR(mode) or stat.S_ISFIFO(mode):
        return None
    if stat.S_ISREG(mode):
        return path.resolve()
    kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
    raise OutputError(f"{str(path)!r} is {kind}; a file name is needed")


def check_writable(path: Path) -> None:
    """Try, without leaving a trace, whether ``whole_file`` could write there.

    Raises
    ------
    OutputError, OSError:
        It could not.
    """
    place = replaced(path)
    if place is not None:
        check_folder_writable(place.parent)
    elif not os.access(path, os.W_OK):
        raise OutputError(f"{str(path)!r} may not be written to")


def check_folder_writable(folder: Path) -> None:
    """Try whether files can be made in a folder: some, as /proc, look as if and refuse.

    Raises
    ------
    OSError:
        They cannot.
    """
    tempfile.TemporaryFile(dir=folder).close()


def leftovers(path: Path) -> Iterator[Path]:
    """What processes that were killed while they wrote ``path`` have left beside it.

    So has one that is writing it now: ask where nobody can be.
    """
    name = re.compile(rf"\.{re.escape(path.stem[:40])}\.[0-9a-f]{{8}}{re.escape(path.suffix)}")
    return (part for part in path.parent.iterdir() if name.fullmatch(part.name))


@contextmanager
def _beside(path: Path) -> Generator[Path]:
    part = path.with_name(f".{path.stem[:40]}.{secrets.token_hex(4)}{path.suffix}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def _in_a_stream(path: Path) -> Generator[Path]:
    with tempfile.TemporaryDirectory(prefix="icage-") as folder:
        part = Path(folder) / path.name
        yield part
        content = part.read_bytes()
    with path.open("wb") as stream:
        stream.write(content)
