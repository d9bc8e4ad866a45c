"""The same shards on a dask.distributed cluster; files are written here, not on the workers.

A worker gets the study's document and the numbers of its trials, plans the cage once and sends
tables back. A shard is pure: one that died with its worker is simply run again elsewhere.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, Final

import pyarrow as pa

from experiments.study.document import study_of
from experiments.study.run import Backend, Span, shard_table
from experiments.study.shard import Study
from experiments.versions import versions
from icage.errors import InputError

RETRIES: Final = 5
"""A shard that raised is run again this often; dask counts a lost worker apart."""

AHEAD: Final = 4
"""[shard] Handed out per thread of the cluster before any is back."""

_WAIT: Final = "30s"
"""For the scheduler, and for its first worker."""


class ClusterError(InputError):
    """There is no such cluster, or its workers would give other numbers."""


def on_cluster(address: str, document: Mapping[str, Any]) -> Backend:
    """Shards on the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        dask.distributed is not installed, nobody answers, or a worker has other versions of what
        computes: its rows would not be those of one machine.
    """
    try:
        import distributed
    except ImportError as error:
        raise ClusterError("--scheduler needs dask.distributed; install icage[cluster]") from error
    text = json.dumps(document, sort_keys=True)

    def backend(study: Study, spans: list[Span]) -> Iterator[tuple[Span, pa.Table]]:
        if not spans:
            return
        try:
            client = distributed.Client(address, timeout=_WAIT, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise ClusterError(f"--scheduler {address!r} does not answer: {error}") from error
        with client:
            _check_workers(client, address)
            yield from _results(client, distributed, text, spans)

    return backend


def _results(
    client: Any, distributed: Any, text: str, spans: list[Span]
) -> Iterator[tuple[Span, pa.Table]]:
    """Tables as they come, a few shards ahead of the cluster's threads."""
    waiting = iter(spans)
    threads = sum(client.nthreads().values())
    pool = distributed.as_completed()
    named: dict[Any, Span] = {}
    for span in waiting:
        _hand_out(client, pool, named, text, span)
        if len(named) >= AHEAD * threads:
            break
    try:
        for future in pool:
            span = named.pop(future)
            table = future.result()
            future.release()
            yield span, table
            for more in waiting:
                _hand_out(client, pool, named, text, more)
                break
    finally:
        client.cancel(list(named))


def _hand_out(client: Any, pool: Any, named: dict[Any, Span], text: str, span: Span) -> None:
    future = client.submit(run_remote, text, span, pure=False, retries=RETRIES)
    named[future] = span
    pool.add(future)


def run_remote(text: str, span: Span) -> pa.Table:
    """On a worker: the table of a shard of the study with this document."""
    return shard_table(_study(text), span)


@lru_cache(maxsize=4)
def _study(text: str) -> Study:
    return study_of(json.loads(text))


def _check_workers(client: Any, address: str) -> None:
    """Every worker must compute what this machine would."""
    try:
        client.wait_for_workers(1, timeout=_WAIT)
    except TimeoutError as error:
        raise ClusterError(f"--scheduler {address!r} has no workers") from error
    here = versions()
    for worker, there in client.run(versions).items():
        other = [f"{n} {there.get(n)} instead of {v}" for n, v in here.items() if there.get(n) != v]
        if other:
            raise ClusterError(f"worker {worker} has {', '.join(other)}")
