"""A folder that one process at a time works in."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from icage.errors import InputError, OutputError
from icage.staging import sweep

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None


_TRIES: Final = 10


@contextmanager
def held_folder(path: Path, who: str) -> Generator[None]:
    """Make the folder and hold it; the hold ends with the process, however that ends.

    ``who`` names what would be in the way: "study". What killed processes left there is swept; a
    folder that was made and is empty in the end is removed again.

    Raises
    ------
    InputError:
        Another process holds it.
    OutputError:
        It cannot be made.
    """
    with folder_for_a_while(path):
        handle = _held(path, who)
        try:
            sweep(path)
            yield
        finally:
            if handle is not None:
                os.close(handle)


@contextmanager
def folder_for_a_while(path: Path) -> Generator[None]:
    """Make the folder and those above it; what is made and stays empty goes with the block."""
    with writable(path):
        made = [part for part in (path, *path.absolute().parents) if not part.exists()]
        path.mkdir(parents=True, exist_ok=True)
    try:
        yield
    finally:
        for part in made:  # deepest first; only while empty
            with suppress(OSError):
                part.rmdir()


def _held(path: Path, who: str) -> int | None:
    """A handle of the folder, with a hold on it where the system has such.

    Whoever held it before may remove it between our steps: then we hold what has no name.
    """
    for _ in range(_TRIES):
        with writable(path):
            path.mkdir(parents=True, exist_ok=True)
            if fcntl is None:
                return None
            try:
                handle = os.open(path, os.O_RDONLY)
            except FileNotFoundError:
                continue
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(handle)
            raise InputError(f"another icage {who} is running in {str(path)!r}") from error
        except OSError:  # a file system without locks
            return handle
        try:
            if os.path.samestat(os.fstat(handle), path.stat()):
                return handle
        except FileNotFoundError:
            pass
        except OSError as error:
            os.close(handle)
            raise OutputError(f"{str(path)!r} cannot be used: {error.strerror}") from error
        os.close(handle)
    raise InputError(f"{str(path)!r} is made and removed by others all the time")


@contextmanager
def writable(path: Path) -> Generator[None]:
    """What the disk refuses in the block is an error about the folder ``path``."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{str(path)!r} cannot be written to: {error.strerror or error}"
        ) from error
