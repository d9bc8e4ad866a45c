"""Who searches the objects: processes of this machine, or a cluster. The rows are the same."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Mapping
from functools import lru_cache, partial
from threading import Event
from typing import Any, TypeAlias

from experiments.collection.objects import Readable, readable_of
from experiments.collection.options import SearchOptions, options_of
from experiments.collection.rows import COLUMNS, Row, searched_rows, table_of
from experiments.io.arrow_bytes import bytes_of, table_in
from experiments.io.cluster import Cluster, Work, document_here
from experiments.io.pieces import in_threads
from experiments.io.workers import in_processes
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
        text = json.dumps(document, sort_keys=True)
        yield from in_processes(partial(_search, text), objects, workers)

    return backend


def _until(given_up: Event) -> Progress:
    """Progress that ends a search for which nobody waits any more."""

    def progress(_stage: str, _done: int, _total: int, _best: float | None) -> None:
        if given_up.is_set():
            raise _BrokenOffError

    return progress


def _search(text: str, one: Readable) -> list[Row]:
    """In a process of this machine: the rows of an object."""
    return searched_rows(one, _options(text))


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
