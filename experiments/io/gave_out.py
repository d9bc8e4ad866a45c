"""What gave out beneath a command: memory, a disk, a file, a library. None of it is our fault."""

from __future__ import annotations

import errno
from typing import Final

_NO_ROOM: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO)
"""What a full, locked or broken disk answers."""

_OF_LIBRARIES: Final = ("GEOSException", "LinAlgError")
"""Errors of shapely and numpy, by name: a command that needs neither does not load them."""


def what_gave_out(error: Exception) -> str:
    """What an error says of machine, disk or library, in words; empty if it says nothing of them.

    >>> what_gave_out(MemoryError())
    'there is not enough memory for this'
    >>> what_gave_out(PermissionError(13, "Permission denied", "a.json"))
    "'a.json': Permission denied"
    >>> what_gave_out(KeyError("a"))
    ''
    """
    if isinstance(error, MemoryError):
        return "there is not enough memory for this"
    if isinstance(error, OSError):
        return _of_system(error)
    names = {kind.__name__ for kind in type(error).__mro__}
    if names.intersection(_OF_LIBRARIES):
        return f"a library that computes geometry gave up on this object: {error}"
    return ""


def _of_system(error: OSError) -> str:
    if error.errno in _NO_ROOM:
        return f"{error.filename or 'the answer'} cannot be written: {error.strerror}"
    if error.errno == errno.ENOMEM:
        return "there is not enough memory for this"
    if error.errno in (errno.EMFILE, errno.ENFILE):
        return f"too many files are open: {error.strerror}"
    return f"{str(error.filename)!r}: {error.strerror}" if error.filename else ""
