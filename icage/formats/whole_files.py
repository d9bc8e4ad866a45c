"""Output files appear whole or not at all: written in a staging folder, then moved to their place.

Only regular files are replaced. A link is followed; a device or a pipe (``/dev/null``, a FIFO,
``>(...)``) is written into, once everything is there.
"""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from icage.errors import OutputError
from icage.staging import staging

_PROBE: Final = 1 << 16
"""[byte] Written for a moment where output is to be: a full disk still takes empty files."""


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
    """Try whether files can be made in a folder, and filled.

    Some, as /proc, look as if and refuse; a full disk takes empty ones.

    Raises
    ------
    OSError:
        They cannot.
    """
    with tempfile.TemporaryFile(dir=folder) as probe:
        probe.write(bytes(_PROBE))
        probe.flush()
        os.fsync(probe.fileno())


@contextmanager
def _beside(path: Path) -> Generator[Path]:
    with staging(path.parent) as place:
        part = place.new / path.name
        yield part
        part.replace(path)


@contextmanager
def _in_a_stream(path: Path) -> Generator[Path]:
    with staging(Path(tempfile.gettempdir())) as place:
        part = place.new / path.name
        yield part
        content = part.read_bytes()
    with path.open("wb") as stream:
        stream.write(content)
