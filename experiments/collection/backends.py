"""Who searches the objects: processes of this machine, or a cluster. The rows are the same."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Generator, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import lru_cache, partial
from multiprocessing import connection, get_context, parent_process
from threading import Event, Thread
from typing import Any, Protocol, TypeAlias

from experiments.collection.objects import Readable, readable_of
from experiments.collection.options import SearchOptions, options_of
from experiments.collection.rows import COLUMNS, Row, searched_rows, table_of
from experiments.io.arrow_bytes import bytes_of, table_in
from experiments.io.cluster import Cluster, Work, document_here
from experiments.io.pieces import in_pool, in_threads
from experiments.io.warnings_kept import keep_warnings
from icage.errors import InputError
from icage.grasps.crew import Progress
from icage.kernels.compiled import long_job

Backend: TypeAlias = Callable[[Iterable[Readable]], Generator[tuple[Readable, list[Row]]]]
"""Searches objects and yields their rows, in any order. Closed early, it stops."""


class _BrokenOffError(BaseException):
    """Nobody waits for this search any more; no error of the object."""


def on_this_machine(options: SearchOptions, document: Mapping[str, Any], workers: int) -> Backend:
    """An object a process; of one worker it is this one.

    Threads would do, were it not for the part of a search that holds Python's lock.
    """

    def backend(objects: Iterable[Readable]) -> Generator[tuple[Readable, list[Row]]]:
        if workers == 1:
            given_up = Event()
            long_job()
            yield from in_threads(
                lambda one: searched_rows(one, options, _until(given_up)), objects, 1, given_up.set
            )
            return
        spawn = get_context("spawn")  # a fork would take locks along that nobody opens
        all_given_up = spawn.Event()
        pool = ProcessPoolExecutor(workers, spawn, _begin, (all_given_up,))
        text = json.dumps(document, sort_keys=True)
        try:
            yield from in_pool(pool, partial(_search, text), objects, workers + 1, all_given_up.set)
        except BrokenProcessPool as error:
            raise InputError(
                "a process that searched was killed, as where memory is short; what is done is "
                "kept, and fewer --workers need less"
            ) from error

    return backend


class _Flag(Protocol):
    """An event of threads or of processes."""

    def is_set(self) -> bool: ...


def _until(given_up: _Flag) -> Progress:
    """Progress that ends a search for which nobody waits any more."""

    def progress(_stage: str, _done: int, _total: int, _best: float | None) -> None:
        if given_up.is_set():
            raise _BrokenOffError

    return progress


_given_up: list[_Flag] = []
"""In a process that searches for another one: whether that has given up."""


def _begin(given_up: _Flag) -> None:
    """In a new process: it ends when the one that started it is gone, however that went."""
    keep_warnings()
    _given_up.append(given_up)
    parent = parent_process()
    if parent is not None:
        sentinel = parent.sentinel

        def follow() -> None:
            connection.wait([sentinel])
            os._exit(1)

        Thread(target=follow, daemon=True).start()


def _search(text: str, one: Readable) -> list[Row]:
    """In a process of this machine: the rows of an object."""
    return searched_rows(one, _options(text), _until(_given_up[0]))


def on_cluster(address: str, document: Mapping[str, Any], any_code: bool = False) -> Backend:
    """An object a thread of the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        As ``experiments.io.cluster.Cluster``.
    """
    cluster = Cluster(address, document, any_code)
    most = options_of(document).top
    work = Work(run_remote, Readable.document, lambda one, data: rows_in(data, one, most), _name)

    def backend(objects: Iterable[Readable]) -> Generator[tuple[Readable, list[Row]]]:
        yield from cluster.run(work, objects)

    return backend


def _name(one: Readable) -> str:
    return f"the search of {one.file}"


def run_remote(text: str, asked: str) -> bytes:
    """On a worker: the rows of an object, for the options of this document."""
    one = readable_of(json.loads(asked))
    return bytes_of(table_of(searched_rows(one, _options(text))))


def rows_in(data: Any, one: Readable, most: int) -> list[Row]:
    """The rows of an object that a worker has sent.

    Raises
    ------
    ValueError:
        They are none of a table of grasps, or another object's.
    """
    rows: list[Row] = table_in(data, COLUMNS, most=most).to_pylist()
    mine = {"file": one.file, "digest": one.digest, "seed": one.seed}
    for row in rows:
        if {name: row[name] for name in mine} != mine:
            raise ValueError("its rows are of another object")
    if rows[0]["rank"] is not None and [row["rank"] for row in rows] != [*range(1, len(rows) + 1)]:
        raise ValueError("its ranks are in no order")
    if any(row["why"] is not None and not row["why"].isprintable() for row in rows):
        raise ValueError("its reasons cannot be printed")
    return rows


@lru_cache(maxsize=4)
def _options(text: str) -> SearchOptions:
    document = document_here(text)
    long_job()
    return options_of(document)
