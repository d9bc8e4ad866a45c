"""Who searches the objects: threads of this process, or a cluster. The rows are the same."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Mapping
from functools import lru_cache
from threading import Event
from typing import Any, TypeAlias

from experiments.collection.objects import Readable
from experiments.collection.options import SearchOptions, options_of
from experiments.collection.rows import Row, searched_rows
from experiments.io.cluster import Cluster, check_here
from experiments.io.pieces import in_threads
from icage.kernels.compiled import long_job

Backend: TypeAlias = Callable[[Iterable[Readable]], Generator[tuple[Readable, list[Row]]]]
"""Searches objects and yields their rows, in any order. Closed early, it stops."""


class _BrokenOffError(BaseException):
    """Nobody waits for this search any more; no error of the object."""


def on_threads(options: SearchOptions, threads: int) -> Backend:
    """An object a thread: most of a search is in kernels, which share the cores."""

    def backend(objects: Iterable[Readable]) -> Generator[tuple[Readable, list[Row]]]:
        given_up = Event()
        long_job()

        def progress(_stage: str, _done: int, _total: int, _best: float | None) -> None:
            if given_up.is_set():
                raise _BrokenOffError

        def search(one: Readable) -> list[Row]:
            return searched_rows(one, options, progress)

        yield from in_threads(search, objects, threads, given_up.set)

    return backend


def on_cluster(address: str, document: Mapping[str, Any]) -> Backend:
    """An object a thread of the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        As ``experiments.io.cluster.Cluster``.
    """
    cluster = Cluster(address, document["versions"])
    text = json.dumps(document, sort_keys=True)

    def backend(objects: Iterable[Readable]) -> Generator[tuple[Readable, list[Row]]]:
        yield from cluster.run(run_remote, text, objects, _name)

    return backend


def _name(one: Readable) -> str:
    return f"the search of {one.file}"


def run_remote(text: str, one: Readable) -> list[Row]:
    """On a worker: the rows of an object, for the options of this document."""
    return searched_rows(one, _options(text))


@lru_cache(maxsize=4)
def _options(text: str) -> SearchOptions:
    document = json.loads(text)
    check_here(document["versions"])
    long_job()
    return options_of(document)
