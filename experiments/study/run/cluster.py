"""The same shards on a dask.distributed cluster; files are written here, not on the workers.

A worker gets the study's document and the numbers of its trials, plans the cage once and sends
tables back. A shard is pure: one that died with its worker is simply run again elsewhere.
"""

from __future__ import annotations

import json
import logging
import re
import socket
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from functools import lru_cache
from itertools import islice
from typing import Any, Final

from experiments.io.arrow_table import Table
from experiments.io.versions import versions
from experiments.study.run.document import study_of
from experiments.study.run.shard import Study
from experiments.study.run.shards import Backend, Span, shard_table
from icage.errors import InputError

RETRIES: Final = 5
"""A shard that raised is run again this often; dask counts a lost worker apart."""

AHEAD: Final = 4
"""[shard] Handed out per thread of the cluster before any is back."""

_SCHEDULER_WAIT: Final = 10
"""[s] For the scheduler to answer."""

_WORKER_WAIT: Final = 30
"""[s] For the first worker."""

_ADDRESS: Final = re.compile(r"(\w+://)?(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):(\d{1,5})")
_LOGS: Final = ("distributed", "distributed.client", "tornado.application")


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
    wanted = document["versions"]
    with _connected(distributed, address, wanted):  # before anything is written
        pass

    def backend(study: Study, spans: list[Span]) -> Generator[tuple[Span, Table]]:
        if not spans:
            return
        with _connected(distributed, address, wanted) as client:
            yield from _results(client, distributed, text, spans)

    return backend


@contextmanager
def _connected(distributed: Any, address: str, wanted: Mapping[str, str]) -> Generator[Any]:
    """A client whose workers were checked. What dask would log reaches the user as our errors."""
    _check_address(address)
    with _quiet():
        try:
            client = _client(distributed, address)
        except Exception as error:  # whatever the other side says if it is no scheduler
            raise ClusterError(f"--scheduler {address!r} does not answer: {error}") from error
        with client:
            _check_workers(client, address, wanted)
            yield client


def _check_address(address: str) -> None:
    """A scheduler listens there: dask would try a dead address for long, a mute one for ever."""
    parts = _ADDRESS.fullmatch(address)
    if parts is None or int(parts[3]) > 65535:
        raise ClusterError(f"--scheduler {address!r}; tcp://HOST:PORT is needed")
    try:
        place = (parts[2].strip("[]"), int(parts[3]))
        with socket.create_connection(place, _SCHEDULER_WAIT) as connection:
            if parts[1] in (None, "tcp://"):  # the others let the client speak first
                connection.recv(1)
    except (OSError, UnicodeError) as error:
        raise ClusterError(f"--scheduler {address!r} does not answer: {error}") from error


def _client(distributed: Any, address: str) -> Any:
    """A client that, where it could not connect, is gone without a wait and without a word."""

    class Client(distributed.Client):
        def __del__(self) -> None:
            with suppress(Exception):
                self.close(timeout=1)

    return Client(address, timeout=_SCHEDULER_WAIT, set_as_default=False)


@contextmanager
def _quiet() -> Generator[None]:
    logs = [logging.getLogger(name) for name in _LOGS]
    before = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for log, level in zip(logs, before, strict=True):
            log.setLevel(level)


def _results(
    client: Any, distributed: Any, text: str, spans: list[Span]
) -> Iterator[tuple[Span, Table]]:
    """Tables as they come, a few shards ahead of the cluster's threads, which come and go.

    Raises
    ------
    ClusterError:
        The scheduler is lost, or a shard killed every worker that it was given to.
    """
    waiting = iter(spans)
    pool = distributed.as_completed(loop=client.loop)
    named: dict[Any, Span] = {}

    def hand_out() -> None:
        room = AHEAD * max(1, sum(client.nthreads().values())) - len(named)
        for span in islice(waiting, max(room, 0)):
            future = client.submit(run_remote, text, span, pure=False, retries=RETRIES)
            named[future] = span
            pool.add(future)

    try:
        hand_out()
        for future in pool:
            span = named.pop(future)
            try:
                table = future.result()
            except distributed.KilledWorker as error:
                raise ClusterError(
                    f"workers died while they ran trials {span[0]} to {span[1]}, "
                    f"{error.allowed_failures + 1} of them; what is done is kept"
                ) from error
            future.release()
            yield span, table
            hand_out()
    except (CancelledError, OSError) as error:
        raise ClusterError(f"the scheduler was lost; what is done is kept: {error}") from error
    finally:
        with suppress(Exception):  # it may be gone
            client.cancel(list(named))


def run_remote(text: str, span: Span) -> Table:
    """On a worker: the table of a shard of the study with this document."""
    return shard_table(_study(text), span)


@lru_cache(maxsize=4)
def _study(text: str) -> Study:
    """The study, on a worker with the versions that it is recorded with.

    Raises
    ------
    ClusterError:
        It has others: it came after the check.
    """
    document = json.loads(text)
    lines = _others(versions(), document["versions"])
    if lines:
        raise ClusterError(f"a worker has {', '.join(lines)}")
    return study_of(document)


def _check_workers(client: Any, address: str, wanted: Mapping[str, str]) -> None:
    """Every worker must compute what this machine would."""
    try:
        client.wait_for_workers(1, timeout=_WORKER_WAIT)
    except TimeoutError as error:
        raise ClusterError(f"--scheduler {address!r} has no workers") from error
    for worker, there in client.run(versions, on_error="return").items():
        if not isinstance(there, dict):
            raise ClusterError(f"worker {worker} cannot run icage: {there!r}")
        lines = _others(there, wanted)
        if lines:
            raise ClusterError(f"worker {worker} has {', '.join(lines)}")


def _others(there: Mapping[str, str], wanted: Mapping[str, str]) -> list[str]:
    return [
        f"{name} {there.get(name)} instead of {value}"
        for name, value in wanted.items()
        if there.get(name) != value
    ]
