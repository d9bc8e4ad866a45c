"""Work in pieces on a dask.distributed cluster; files are written here, not on the workers.

A piece is pure: one that died with its worker is simply run again elsewhere. What is asked is JSON,
what comes back is bytes, looked at before they are believed; and nothing is waited for without end.
[docs/cluster.md, Security]
"""

from __future__ import annotations

import json
import logging
import re
import socket
import threading
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any, Final, Generic, TypeVar

from experiments.io.versions import ANY_CODE, CODE, versions
from icage.errors import InputError

RETRIES: Final = 5
"""A piece that raised is run again this often; dask counts a lost worker apart."""

AHEAD: Final = 4
"""[piece] Handed out per thread of the cluster before any is back."""

_SCHEDULER_WAIT: Final = 10
"""[s] For the scheduler to answer."""

_WORKER_WAIT: Final = 30
"""[s] For the first worker."""

_REMOTE_WAIT: Final = 60
"""[s] For anything but a piece; and so often a scheduler is asked whether it is still there."""

_ADDRESS: Final = re.compile(r"(\w+://)?(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):(\d{1,5})")
_LOGS: Final = ("distributed", "distributed.client", "tornado.application")


class ClusterError(InputError):
    """There is no such cluster, or its workers would give other numbers."""


Piece = TypeVar("Piece")
Done = TypeVar("Done")


@dataclass(frozen=True, slots=True)
class Work(Generic[Piece, Done]):
    """What is done with a piece.

    Attributes
    ----------
    remote:
        On a worker: bytes, of the document's text (for ``document_here``) and the piece's.
    asked:
        A piece as JSON.
    answer:
        What the bytes are, for a piece; ``ValueError`` if they cannot be that.
    name:
        What a piece is, for the error that tells which one killed its workers.
    """

    remote: Callable[[str, str], bytes]
    asked: Callable[[Piece], Any]
    answer: Callable[[Piece, Any], Done]
    name: Callable[[Piece], str]


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
    any_code: bool = False
    """Workers with other code of the same version are taken."""

    def __post_init__(self) -> None:
        with self._connected():
            pass

    def _connected(self) -> AbstractContextManager[Any]:
        return _connected(self.address, _wanted(self._sent))

    @property
    def _sent(self) -> dict[str, Any]:
        """The document, with what is allowed now in the place of what was allowed before."""
        return {**self.document, ANY_CODE: self.any_code}

    def run(
        self, work: Work[Piece, Done], pieces: Iterable[Piece]
    ) -> Generator[tuple[Piece, Done]]:
        """Every piece with what came of it, in any order.

        Raises
        ------
        ClusterError:
            The scheduler is lost, a piece killed every worker that it was given to, or what came
            back is no answer.
        """
        text = json.dumps(self._sent, sort_keys=True)
        with self._connected() as client:
            yield from _results(client, work, text, pieces)


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
            client = _in_time("a connection", lambda: _client(distributed, address))
        except Exception as error:  # whatever the other side says if it is no scheduler
            raise ClusterError(f"--scheduler {address!r} does not answer: {error}") from error
        try:
            _check_workers(client, address, wanted)
            yield client
        finally:
            with suppress(Exception):  # it may be gone, or not answer any more
                _in_time("the end", client.close)


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


def _in_time(what: str, call: Callable[[], Done]) -> Done:
    """What a call to the other side gives; some of dask's have no limit of their own.

    Raises
    ------
    TimeoutError:
        Nothing came.
    """
    came: list[Done] = []
    failed: list[BaseException] = []

    def run() -> None:
        try:
            came.append(call())
        except BaseException as error:  # it is raised where it was asked for
            failed.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(_REMOTE_WAIT)
    if failed:
        raise failed[0]
    if not came:
        raise TimeoutError(f"{what} took longer than {_REMOTE_WAIT} s")
    return came[0]


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
    work: Work[Piece, Done],
    text: str,
    pieces: Iterable[Piece],
) -> Iterator[tuple[Piece, Done]]:
    """Answers as they come, a few pieces ahead of the cluster's threads, which come and go."""
    import distributed

    waiting = iter(pieces)
    named: dict[Any, Piece] = {}

    def hand_out() -> None:
        room = AHEAD * max(1, sum(client.nthreads().values())) - len(named)
        for piece in islice(waiting, max(room, 0)):
            asked = json.dumps(work.asked(piece), sort_keys=True)
            future = client.submit(work.remote, text, asked, pure=False, retries=RETRIES)
            named[future] = piece

    try:
        hand_out()
        while named:
            for future in _ended(client, list(named)):
                piece = named.pop(future)
                try:
                    data = _in_time(work.name(piece), partial(future.result, _REMOTE_WAIT))
                except distributed.KilledWorker as error:
                    raise ClusterError(
                        f"workers died while they ran {work.name(piece)}, "
                        f"{error.allowed_failures + 1} of them; what is done is kept"
                    ) from error
                future.release()
                try:
                    done = work.answer(piece, data)
                except ValueError as error:
                    raise ClusterError(
                        f"the cluster's answer to {work.name(piece)} is none: {error}; what is "
                        "done is kept"
                    ) from error
                yield piece, done
            hand_out()
    except (CancelledError, OSError) as error:
        raise ClusterError(f"the scheduler was lost; what is done is kept: {error}") from error
    finally:
        with suppress(Exception):  # it may be gone
            _in_time("the end", lambda: client.cancel(list(named)))


def _ended(client: Any, futures: list[Any]) -> list[Any]:
    """The futures that have ended, as soon as there are any; meanwhile the scheduler is there.

    A piece may take long, and all workers may be away: only silence of the scheduler is an end.
    """
    import distributed

    while True:
        try:
            with client.as_current():
                first: Any = distributed.wait(
                    futures, timeout=_REMOTE_WAIT, return_when="FIRST_COMPLETED"
                )
            return list(first.done)
        except TimeoutError:
            _in_time("the scheduler's answer", lambda: client.sync(client.scheduler.identity))


def document_here(text: str) -> dict[str, Any]:
    """On a worker: the document, whose versions it has.

    Raises
    ------
    ClusterError:
        It has others: it came after the check.
    """
    document: dict[str, Any] = json.loads(text)
    lines = _others(versions(), _wanted(document))
    if lines:
        raise ClusterError(f"a worker has {', '.join(lines)}")
    return document


def _check_workers(client: Any, address: str, wanted: Mapping[str, str]) -> None:
    """Every worker must compute what this machine would."""
    try:
        client.wait_for_workers(1, timeout=_WORKER_WAIT)
    except TimeoutError as error:
        raise ClusterError(f"--scheduler {address!r} has no workers") from error
    except (OSError, CancelledError) as error:
        raise ClusterError(f"--scheduler {address!r} does not answer: {error}") from error
    try:
        answers = _in_time(
            "the versions of the workers",
            lambda: client.run(versions_here, on_error="return"),
        )
    except (OSError, CancelledError, ValueError) as error:
        raise ClusterError(f"workers of {address!r} do not answer: {error}") from error
    for worker, answer in answers.items():
        if not isinstance(answer, bytes):
            raise ClusterError(f"worker {worker} cannot run icage: {answer!r}")
        lines = _others(_versions_in(worker, answer), wanted)
        if lines:
            raise ClusterError(f"worker {worker} has {', '.join(lines)}")


def versions_here() -> bytes:
    """On a worker: its versions, JSON."""
    return json.dumps(versions()).encode()


def _versions_in(worker: str, answer: bytes) -> dict[str, Any]:
    try:
        there = json.loads(answer)
    except (ValueError, RecursionError):
        there = None
    if not isinstance(there, dict):
        raise ClusterError(f"worker {worker} does not say its versions")
    return there


def _wanted(document: Mapping[str, Any]) -> dict[str, str]:
    """What a worker must have: the code too, unless the document takes any."""
    free = (CODE,) if document.get(ANY_CODE) else ()
    return {name: one for name, one in document["versions"].items() if name not in free}


def _others(there: Mapping[str, str], wanted: Mapping[str, str]) -> list[str]:
    return [
        f"{name} {there.get(name)} instead of {value}"
        for name, value in wanted.items()
        if there.get(name) != value
    ]
