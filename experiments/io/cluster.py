"""Work in pieces on a dask.distributed cluster; files are written here, not on the workers.

A piece is pure: one that died with its worker is simply run again elsewhere.
"""

from __future__ import annotations

import json
import logging
import re
import socket
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any, Final, TypeVar

from experiments.io.versions import versions
from icage.errors import InputError

RETRIES: Final = 5
"""A piece that raised is run again this often; dask counts a lost worker apart."""

AHEAD: Final = 4
"""[piece] Handed out per thread of the cluster before any is back."""

_SCHEDULER_WAIT: Final = 10
"""[s] For the scheduler to answer."""

_WORKER_WAIT: Final = 30
"""[s] For the first worker."""

_ADDRESS: Final = re.compile(r"(\w+://)?(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):(\d{1,5})")
_LOGS: Final = ("distributed", "distributed.client", "tornado.application")


class ClusterError(InputError):
    """There is no such cluster, or its workers would give other numbers."""


Piece = TypeVar("Piece")
Done = TypeVar("Done")


@dataclass(frozen=True, slots=True)
class Cluster:
    """The workers of the scheduler at ``tcp://HOST:PORT``, looked at before anything is written.

    Attributes
    ----------
    document:
        What decides the answers, JSON-ready. Its ``versions`` are of what computes, and every
        worker must have them: with others its answers would not be those of one machine.

    Raises
    ------
    ClusterError:
        dask.distributed is not installed, nobody answers, or a worker has other versions.
    """

    address: str
    document: Mapping[str, Any]

    def __post_init__(self) -> None:
        with self._connected():
            pass

    def _connected(self) -> AbstractContextManager[Any]:
        return _connected(self.address, self.document["versions"])

    def run(
        self,
        work: Callable[[str, Piece], Done],
        pieces: Iterable[Piece],
        names: Callable[[Piece], str],
    ) -> Generator[tuple[Piece, Done]]:
        """Every piece with what ``work(text, piece)`` made of it, in any order.

        ``text`` is the document's, for ``document_here``. ``names`` says what a piece is, for the
        error that tells which one killed its workers.

        Raises
        ------
        ClusterError:
            The scheduler is lost, or a piece killed every worker that it was given to.
        """
        text = json.dumps(self.document, sort_keys=True)
        with self._connected() as client:
            yield from _results(client, work, text, pieces, names)


@contextmanager
def _connected(address: str, wanted: Mapping[str, str]) -> Generator[Any]:
    """A client whose workers were checked. What dask would log reaches the user as our errors."""
    try:
        import distributed
    except ImportError as error:
        raise ClusterError("--scheduler needs dask.distributed; install icage[cluster]") from error
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
    client: Any,
    work: Callable[[str, Piece], Done],
    text: str,
    pieces: Iterable[Piece],
    names: Callable[[Piece], str],
) -> Iterator[tuple[Piece, Done]]:
    """Answers as they come, a few pieces ahead of the cluster's threads, which come and go."""
    import distributed

    waiting = iter(pieces)
    pool: Any = distributed.as_completed(loop=client.loop)
    named: dict[Any, Piece] = {}

    def hand_out() -> None:
        room = AHEAD * max(1, sum(client.nthreads().values())) - len(named)
        for piece in islice(waiting, max(room, 0)):
            future = client.submit(work, text, piece, pure=False, retries=RETRIES)
            named[future] = piece
            pool.add(future)

    try:
        hand_out()
        for future in pool:
            piece = named.pop(future)
            try:
                done: Done = future.result()
            except distributed.KilledWorker as error:
                raise ClusterError(
                    f"workers died while they ran {names(piece)}, "
                    f"{error.allowed_failures + 1} of them; what is done is kept"
                ) from error
            future.release()
            yield piece, done
            hand_out()
    except (CancelledError, OSError) as error:
        raise ClusterError(f"the scheduler was lost; what is done is kept: {error}") from error
    finally:
        with suppress(Exception):  # it may be gone
            client.cancel(list(named))


def document_here(text: str) -> dict[str, Any]:
    """On a worker: the document, whose versions it has.

    Raises
    ------
    ClusterError:
        It has others: it came after the check.
    """
    document: dict[str, Any] = json.loads(text)
    lines = _others(versions(), document["versions"])
    if lines:
        raise ClusterError(f"a worker has {', '.join(lines)}")
    return document


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
