"""A folder that one process at a time works in."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from icage.errors import InputError, OutputError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None


@contextmanager
def held_folder(path: Path, who: str) -> Generator[None]:
    """Make the folder and hold it; the hold ends with the process, however that ends.

    ``who`` names what would be in the way: "study".

    Raises
    ------
    InputError:
        Another process holds it.
    OutputError:
        It cannot be made.
    """
    with writable(path):
        path.mkdir(parents=True, exist_ok=True)
    if fcntl is None:
        yield
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        os.close(handle)
        raise InputError(f"another icage {who} is running in {str(path)!r}") from error
    except OSError:  # a file system without locks
        pass
    try:
        yield
    finally:
        os.close(handle)


@contextmanager
def writable(path: Path) -> Generator[None]:
    """What the disk refuses in the block is an error about the folder ``path``."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{str(path)!r} cannot be written to: {error.strerror or error}"
        ) from error
