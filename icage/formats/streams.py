"""Bytes of whatever a path names: a file, a device, or a pipe that somebody may never write to."""

from __future__ import annotations

import errno
import os
import select
import stat
from pathlib import Path
from time import monotonic
from typing import Final

NOBODY: Final = 5.0
"""[s] That a pipe without a writer is waited for."""

SILENT: Final = 600.0
"""[s] That a writer may be silent: it computes what it writes."""

_LOOK: Final = 0.1
"""[s] Between two looks whether there is a writer."""


def up_to(path: Path, most: int) -> bytes:
    """The first ``most`` bytes, fewer if there are no more.

    A device has no size and no end, so nothing is read beyond. A pipe is opened without waiting
    (``open`` waits for a writer, for ever if none comes) and read for as long as somebody has it
    open for writing.

    Raises
    ------
    OSError:
        It cannot be opened or read; nobody writes to it, or nothing for a long time.
    """
    with open(path, "rb", opener=_without_waiting) as file:
        mode = os.fstat(file.fileno()).st_mode
        if hasattr(os, "O_NONBLOCK") and (stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)):
            return _as_it_comes(file.fileno(), most)
        return file.read(most)


def _without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _as_it_comes(handle: int, most: int) -> bytes:
    pieces: list[bytes] = []
    left, heard = most, monotonic()
    while left:
        came = select.select([handle], [], [], _LOOK)[0]
        try:
            piece = os.read(handle, min(left, 1 << 16))
        except BlockingIOError:  # somebody has it open, and is silent
            if monotonic() - heard > SILENT:
                raise OSError(
                    errno.ETIMEDOUT, f"nothing was written to it for {SILENT:g} s"
                ) from None
            continue
        if piece:
            pieces.append(piece)
            left, heard = left - len(piece), monotonic()
        elif came or pieces:  # the last writer has closed it
            break
        elif monotonic() - heard > NOBODY:
            raise OSError(errno.ETIMEDOUT, f"a pipe, and in {NOBODY:g} s nobody wrote to it")
    return b"".join(pieces)
