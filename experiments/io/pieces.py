"""Work in pieces on a pool of threads or processes, as the pieces come."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import TypeVar

Piece = TypeVar("Piece")
Done = TypeVar("Done")


def _nothing() -> None:
    """Running pieces are left to end by themselves."""


def in_threads(
    work: Callable[[Piece], Done],
    pieces: Iterable[Piece],
    threads: int,
    break_off: Callable[[], None] = _nothing,
) -> Generator[tuple[Piece, Done]]:
    """``in_pool`` on threads of this process."""
    yield from in_pool(ThreadPoolExecutor(threads), work, pieces, threads + 1, break_off)


def in_pool(
    pool: Executor,
    work: Callable[[Piece], Done],
    pieces: Iterable[Piece],
    ahead: int,
    break_off: Callable[[], None] = _nothing,
) -> Generator[tuple[Piece, Done]]:
    """Every piece with what came of it, in any order; ``ahead`` of them are under way at a time.

    The pool ends with it. Closed early or interrupted, it begins no other piece, calls
    ``break_off`` and waits for those that run.
    """
    waiting = iter(pieces)
    running: dict[Future[Done], Piece] = {}
    whole = False
    try:
        while True:
            for piece in islice(waiting, ahead - len(running)):
                with _interrupts_wait():
                    running[pool.submit(work, piece)] = piece
            if not running:
                whole = True
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
    finally:
        if not whole:
            break_off()
        pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _interrupts_wait() -> Generator[None]:
    """Ctrl-C comes after the block; a process that is started in it never sees any."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS, Windows
        return os.cpu_count() or 1
