"""Processes that work for this one, and end with it however it ends.

Each holds the reading end of a pipe whose other end this process alone has. Cut, by us or because
we are gone, it ends them at once, whatever they do: they write no files. Where the system offers it
(Linux) it kills them, too, should they be deep in machine code. None holds our standard output, so
whoever reads that sees its end. Nothing large is imported here: a worker knows whom to follow
before it loads what it works with.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import connection, get_context
from multiprocessing.connection import Connection
from typing import Final, TypeVar

from experiments.io.pieces import in_pool
from experiments.io.warnings_kept import keep_warnings
from icage.errors import InputError

Piece = TypeVar("Piece")
Done = TypeVar("Done")

_SAME_MOMENT: Final = 0.5
"""[s] Who ends all processes at once, as a batch system does, has ended this one too by then."""

_SET_DEATH_SIGNAL: Final = 1
"""PR_SET_PDEATHSIG of Linux."""


def in_processes(
    work: Callable[[Piece], Done], pieces: Iterable[Piece], workers: int
) -> Generator[tuple[Piece, Done]]:
    """Every piece with what ``work`` made of it, in any order, on so many new processes.

    Closed early or interrupted, it ends them at once.

    Raises
    ------
    InputError:
        A process was killed by others.
    """
    spawn = get_context("spawn")  # a fork would take locks along that nobody opens
    watched, held = spawn.Pipe(duplex=False)
    pool = ProcessPoolExecutor(workers, spawn, begin_worker, (watched, os.getpid()))
    try:
        yield from in_pool(pool, work, pieces, workers + 1, held.close)
    except BrokenProcessPool as error:
        time.sleep(_SAME_MOMENT)
        raise InputError(
            "a process that worked for this one was killed, as where memory is short; what is done "
            "is kept, and fewer --workers need less"
        ) from error
    finally:
        held.close()
        watched.close()


def begin_worker(watched: Connection, parent: int) -> None:
    """In a new process: its output leads nowhere, and it ends with the one that started it.

    The thread that started it must live as long (Linux kills it with that thread).
    """
    keep_warnings()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)

    def follow() -> None:
        with suppress(OSError, EOFError):
            connection.wait([watched])
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, int(signal.SIGKILL), 0, 0, 0)
    if hasattr(os, "getppid") and os.name != "nt" and os.getppid() != parent:
        os._exit(1)  # it died before we could follow
