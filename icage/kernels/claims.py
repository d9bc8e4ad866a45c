"""Who compiles which kernel: each is one process's at a time, so that several share the work.

A kernel that another process has in hand is waited for and found on disk afterwards; every other
one is compiled by whoever needs it. A claim is a lock on a byte of one file and is gone with its
process. [docs/decisions/0009-cold-start.md]
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager, suppress
from functools import lru_cache
from time import monotonic, sleep
from typing import IO, Final

from icage.kernels import background
from icage.kernels.compiling import announce

try:
    import fcntl
except ImportError:  # not on Windows: there every process compiles for itself
    fcntl = None

HELD: Final = 60.0
"""[s] A kernel that another process has in hand for longer is not waited for: it may have been
stopped in the midst of it. Twenty times what most kernels take."""

_LOOK: Final = 0.1
"""[s] Between two tries."""

_PLACES: Final = 2**31 - 1
"""Bytes of which one stands for a kernel: a prime, so that the whole name counts."""


class Busy(BaseException):
    """Another process has this kernel in hand: there is something else to do meanwhile."""


@contextmanager
def alone_with(name: str, *, patient: bool = True) -> Generator[None]:
    """While a kernel is compiled, or looked for on disk.

    Who comes second waits, or raises ``Busy`` if not ``patient``.
    """
    claims = None if background.is_ready(name) else _claims()
    if claims is None:
        yield
        return
    place = int.from_bytes(name.encode(), "big") % _PLACES
    until = monotonic() + HELD
    while not _taken(claims, place) and monotonic() < until:
        if not patient:
            raise Busy(name)
        announce()
        sleep(_LOOK)
    try:
        yield
    finally:
        _give_back(claims, place)


def _taken(claims: IO[bytes], place: int) -> bool:
    """Whether this process has the byte now; where there are no locks it may go on without."""
    if fcntl is not None:
        try:
            fcntl.lockf(claims, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)
        except (BlockingIOError, PermissionError):
            return False
        except OSError:
            pass
    return True


def _give_back(claims: IO[bytes], place: int) -> None:
    if fcntl is not None:
        with suppress(OSError):
            fcntl.lockf(claims, fcntl.LOCK_UN, 1, place)


@lru_cache(maxsize=1)
def _claims() -> IO[bytes] | None:
    """The file of claims, open as long as the process lives.

    The locks are the process's: to close the file anywhere in it would end them all.
    """
    file = background.claims_file()
    if file is None or fcntl is None:
        return None
    try:
        return file.open("a+b")
    except OSError:
        return None
