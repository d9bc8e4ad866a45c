"""Who searches the objects: processes of this machine, or a cluster. The rows are the same."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Mapping
from functools import lru_cache, partial
from threading import Event
from typing import Any, TypeAlias

from experiments.collection.objects import Readable
from experiments.collection.options import SearchOptions, options_of
from experiments.collection.rows import Row, searched_rows
from experiments.io.cluster import Cluster, document_here
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


def on_cluster(address: str, document: Mapping[str, Any]) -> Backend:
    """An object a thread of the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        As ``experiments.io.cluster.Cluster``.
    """
    cluster = Cluster(address, document)

    def backend(objects: Iterable[Readable]) -> Generator[tuple[Readable, list[Row]]]:
        yield from cluster.run(run_remote, objects, _name)

    return backend


def _name(one: Readable) -> str:
    return f"the search of {one.file}"


def run_remote(text: str, one: Readable) -> list[Row]:
    """On a worker: the rows of an object, for the options of this document."""
    return searched_rows(one, _options(text))


@lru_cache(maxsize=4)
def _options(text: str) -> SearchOptions:
    document = document_here(text)
    long_job()
    return options_of(document)
