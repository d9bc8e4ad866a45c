"""``icage study --scheduler``: the rows of one machine, whoever dies meanwhile."""

from __future__ import annotations

import json
import os
import pickle
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, ExitStack, closing, suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pyarrow as pa
import pytest

from experiments.environment import ROOT
from experiments.io import cluster as clusters
from experiments.io.arrow_bytes import bytes_of
from experiments.io.cluster import ClusterError
from experiments.study.run import cluster
from experiments.study.run.cluster import on_cluster, run_remote, shard_in
from experiments.study.run.document import study_of
from experiments.study.run.folder import StudyFolder
from experiments.study.run.shards import shard_table
from tests.experiments.study.run.certificates import authority_and_member
from tests.experiments.study.studies import TRIALS, Studied, left_alone

distributed = pytest.importorskip("distributed")


@dataclass(frozen=True)
class Cluster:
    """Processes of a dask cluster on this machine."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]]


@pytest.fixture
def started(tmp_path: Path) -> Generator[Callable[..., Cluster]]:
    """Starts a scheduler and workers of one thread each, without nannies to revive them."""
    with ExitStack() as stack:

        def start(module: str, *options: str, **environment: str) -> subprocess.Popen[bytes]:
            quiet = ("--no-dashboard", "--dashboard-address", "127.0.0.1:0")
            child = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{module}", *options, *quiet],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=ROOT,
                env={**os.environ, **environment},
            )
            stack.callback(child.wait, 60)
            stack.callback(child.kill)
            return child

        def of(workers: int, protocol: str = "tcp", **environment: str) -> Cluster:
            address = f"{protocol}://127.0.0.1:{free_port()}"
            listen = ("--host", "127.0.0.1", "--port", address.rpartition(":")[2])
            said = ("--protocol", protocol)
            scheduler = start("dask_scheduler", *listen, *said, **environment)
            alone = ("--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path / "dask"))
            crew = [
                start("dask_worker", address, *alone, *said, **environment) for _ in range(workers)
            ]
            with distributed.Client(address, timeout=60, set_as_default=False) as client:
                client.wait_for_workers(workers, timeout=60)
            return Cluster(address, scheduler, crew)

        yield of


def free_port() -> int:
    with closing(socket.socket()) as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@pytest.fixture
def after(monkeypatch: pytest.MonkeyPatch) -> Callable[[int, Callable[[], Any]], None]:
    """Has something happen when so many shards are kept."""
    keep = StudyFolder.keep

    def after(shards: int, happen: Callable[[], Any]) -> None:
        count = iter(range(1, 1000))

        def kept(self: StudyFolder, *given: Any) -> None:
            keep(self, *given)
            if next(count) == shards:
                happen()

        monkeypatch.setattr(StudyFolder, "keep", kept)

    return after


# ---------------------------------------------------------------------------- a real cluster


@pytest.mark.slow
def test_a_worker_is_killed(folder: Path, study: Studied, started: Any, after: Any):
    """Its shards are run by the other one."""
    alone = left_alone(folder)  # first: it leaves compiled kernels for the workers
    there = started(2)
    killed: list[float] = []

    def kill() -> None:
        there.workers[0].kill()
        killed.append(time.monotonic())

    after(4, kill)
    result = study.run("--scheduler", there.address, "--shard", "3")
    assert time.monotonic() - killed[0] < 60.0
    assert (result.code, result.err) == (0, "")
    assert there.workers[0].wait(60) != 0
    assert there.workers[1].poll() is None
    study.check_same(alone)


@pytest.mark.slow
def test_over_tls_and_not_without_a_certificate_of_the_authority(
    folder: Path, study: Studied, started: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    alone = left_alone(folder)
    ours, others = (authority_and_member(tmp_path / name) for name in ("ours", "others"))
    with configured(ours):
        there = started(1, "tls", **ours)
        result = study.run("--scheduler", there.address)
    assert (result.code, result.err) == (0, "")
    study.check_same(alone)
    before = study.files
    monkeypatch.setattr(clusters, "_SCHEDULER_WAIT", 2)
    plain = there.address.replace("tls:", "tcp:")
    for given, address in (({}, there.address), (others, there.address), (ours, plain)):
        with configured(given):
            refused = study.run("--scheduler", address, "--resume", "--trials", str(TRIALS + 1))
        assert refused.code == 2
        (line,) = refused.err.splitlines()
        assert line.startswith(f"icage: error: --scheduler '{address}' does not answer: ")
        assert study.files == before


def configured(environment: dict[str, str]) -> AbstractContextManager[Any]:
    """dask in this process, as it would be with such an environment."""
    import dask.config

    keys = {name: name.removeprefix("DASK_").lower().replace("__", ".") for name in environment}
    return dask.config.set({keys[name]: value for name, value in environment.items()})


@pytest.mark.slow
def test_begun_on_a_cluster_and_finished_here(
    folder: Path, study: Studied, started: Any, after: Any
):
    there = started(1)

    def interrupt() -> None:
        raise KeyboardInterrupt

    after(4, interrupt)
    result = study.run("--scheduler", there.address, "--shard", "9")
    assert (result.code, result.err) == (130, "icage: error: interrupted\n")
    assert len(study.shards) == 4
    assert study.resume("--shard", "20").code == 0
    study.check_same(left_alone(folder))


@pytest.mark.slow
def test_a_lost_scheduler_keeps_what_is_done(
    folder: Path, study: Studied, started: Any, after: Any
):
    there = started(1)
    after(2, there.scheduler.kill)
    result = study.run("--scheduler", there.address, "--shard", "5")
    assert result.code == 2
    assert result.err.startswith("icage: error: the scheduler was lost; what is done is kept: ")
    assert result.err.count("\n") == 1
    assert study.shards
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


@pytest.mark.slow
def test_a_shard_that_kills_every_worker(
    study: Studied, started: Any, monkeypatch: pytest.MonkeyPatch
):
    there = started(1, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    monkeypatch.setattr(cluster, "run_remote", lambda text, asked: os._exit(1))
    result = study.run("--scheduler", there.address, "--shard", "1000")
    assert result.code == 2
    line = "icage: error: workers died while they ran trials 0 to 119, 1 of them; what is done"
    assert result.err.startswith(line)
    assert result.err.count("\n") == 1


@pytest.mark.slow
def test_workers_with_other_versions_are_refused(folder: Path, study: Studied, started: Any):
    there, document = started(1), left_alone(folder).document
    mine = document["versions"]["mujoco"]
    on_cluster(there.address, document)
    document["versions"]["mujoco"] = "4.0.7"
    with pytest.raises(ClusterError, match=rf"worker tcp.* has mujoco {mine} instead of 4\.0\.7"):
        on_cluster(there.address, document)


# ---------------------------------------------------------------------------- none


def test_a_worker_that_came_late_is_refused_too(folder: Path):
    document = left_alone(folder).document
    document["versions"]["numba"] = "0.1"
    with pytest.raises(ClusterError, match=r"a worker has numba .* instead of 0\.1"):
        run_remote(json.dumps(document), "[0, 3]")


def test_a_remote_shard_is_the_same(folder: Path):
    done = left_alone(folder)
    table = answered(run_remote(json.dumps(done.document), "[7, 11]"), done, (7, 11))
    assert table.equals(done.table.slice(7, 5))


def answered(data: Any, done: Studied, span: tuple[int, int]) -> Any:
    """What the client makes of the bytes of a shard of 7 to 11."""
    study = study_of(done.document)
    return shard_in(data, shard_table(study, (0, -1)).schema, study, span)


class _Trap:
    """What an evil worker would send: opened by pickle, it would run."""

    def __reduce__(self) -> tuple[Any, ...]:
        return pytest.fail, ("it was unpickled",)


def changed(table: Any, name: str, value: Any) -> Any:
    at = table.column_names.index(name)
    column = table[name].to_pylist()
    column[2] = value
    field = table.schema.field(at)
    return table.set_column(at, field, pa.array(column, field.type))


@pytest.mark.parametrize(
    ("send", "words"),
    [
        (lambda table: table, "Table instead of bytes"),
        (lambda _: pickle.dumps(_Trap()), "no Arrow table"),
        (lambda _: b"", "no Arrow table"),
        (lambda table: bytes_of(table)[:-700], "no Arrow table"),
        (lambda _: bytes(2 << 20), "2097152 bytes for 5 rows"),
        (lambda table: bytes_of(table.drop_columns(["steps"])), "columns are others"),
        (lambda table: bytes_of(table.slice(1)), "4 rows instead of 5"),
        (lambda table: bytes_of(changed(table, "trial", 8)), "trials are others"),
        (lambda table: bytes_of(changed(table, "outcome", "\x1b[2J")), "outcomes are none"),
        (lambda table: bytes_of(changed(table, "outline_scale", 1.0)), "not what the study draws"),
    ],
)
def test_what_a_worker_sends_is_not_believed(folder: Path, send: Any, words: str):
    done = left_alone(folder)
    shard = done.table.slice(7, 5)
    assert answered(bytes_of(shard), done, (7, 11)).equals(shard)
    with pytest.raises(ValueError, match=words):
        answered(send(shard), done, (7, 11))


def test_a_worker_with_other_code_is_refused_unless_any_will_do(folder: Path):
    document = left_alone(folder).document
    document["versions"]["code"] = "icage-0 sim-0 experiments-0"
    with pytest.raises(
        ClusterError, match=r"a worker has code icage-\w+ .* instead of icage-0 sim"
    ):
        run_remote(json.dumps(document), "[0, 3]")
    assert run_remote(json.dumps({**document, "any_code": True}), "[0, 3]")


def test_nothing_is_waited_for_without_end(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(clusters, "_REMOTE_WAIT", 0.05)
    with pytest.raises(TimeoutError, match=r"an answer took longer than 0\.05 s"):
        clusters._in_time("an answer", Event().wait)
    assert clusters._in_time("an answer", lambda: 3) == 3
    with pytest.raises(KeyError):
        clusters._in_time("an answer", lambda: {}["none"])


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tls://127.0.0.1:{free}", "does not answer: "),
        ("tcp://127.0.0.1:{free}", "does not answer: "),
        ("tcp://no-such-host.invalid:8786", "does not answer: "),
        ("somewhere", "tcp://HOST:PORT is needed"),
        ("tcp://[::1", "tcp://HOST:PORT is needed"),
        ("tcp://127.0.0.1:99999", "tcp://HOST:PORT is needed"),
    ],
)
def test_no_scheduler(study: Studied, address: str, words: str):
    """One line, soon, before anything is written."""
    begun = time.monotonic()
    result = study.run("--scheduler", address.format(free=free_port()))
    assert words in result.error_line()
    assert time.monotonic() - begun < 15.0
    assert not study.path.exists()


def test_somebody_else_listens_there(study: Studied, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(clusters, "_SCHEDULER_WAIT", 1)
    with closing(socket.create_server(("127.0.0.1", 0))) as mute:
        address = f"tcp://127.0.0.1:{mute.getsockname()[1]}"
        begun = time.monotonic()
        assert "does not answer: " in study.run("--scheduler", address).error_line()
        assert time.monotonic() - begun < 15.0


@pytest.mark.parametrize("rubbish", [b"HTTP/1.1 400 Bad\r\n\r\n", b"\xff" * 4096, b"\0" * 64])
def test_what_listens_there_answers_rubbish(
    study: Studied, monkeypatch: pytest.MonkeyPatch, rubbish: bytes
):
    monkeypatch.setattr(clusters, "_SCHEDULER_WAIT", 2)
    with closing(socket.create_server(("127.0.0.1", 0))) as server:

        def serve() -> None:
            with suppress(OSError):
                while True:
                    one, _ = server.accept()
                    one.sendall(rubbish)
                    one.close()

        Thread(target=serve, daemon=True).start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        begun = time.monotonic()
        assert "does not answer: " in study.run("--scheduler", address).error_line()
        assert time.monotonic() - begun < 30.0
        assert not study.path.exists()


def test_without_dask(study: Studied, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    line = study.run("--scheduler", "tcp://127.0.0.1:1").error_line()
    assert line == "--scheduler needs dask.distributed; install icage[cluster]"
