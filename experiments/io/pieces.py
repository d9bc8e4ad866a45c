"""Work in pieces on a pool of threads, as the pieces come."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
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
    """Every piece with what came of it, in any order; pieces are taken one ahead of the threads.

    Closed early or interrupted, it begins no other piece, calls ``break_off`` and waits for those
    that run.
    """
    waiting = iter(pieces)
    running: dict[Future[Done], Piece] = {}
    pool = ThreadPoolExecutor(threads)
    whole = False
    try:
        while True:
            for piece in waiting:
                running[pool.submit(work, piece)] = piece
                if len(running) >= threads + 1:
                    break
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


def cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS, Windows
        return os.cpu_count() or 1
