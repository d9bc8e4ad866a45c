"""A study dies at any step, meets a full disk, is interrupted or killed: nothing lost or twice."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from experiments.io import parquet_files
from experiments.study.run.folder import StudyFolder
from experiments.study.run.session import held, session_of
from experiments.study.run.shard import Study
from experiments.study.run.shards import Span, run_study
from icage.staging import sweep
from tests.experiments.commands.runner import here
from tests.experiments.study.studies import TRIALS, VARIED, Studied, failing, left_alone, t_file
from tests.oracles.against_itself.kills import survive

posix = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals and limits")


# ---------------------------------------------------------------------------- death at every step


class Died(BaseException):
    """The process is gone: nothing that would clean up after it gets anywhere either."""


class Disk:
    """A disk on which a process dies before its step number ``steps``."""

    def __init__(self, patch: pytest.MonkeyPatch, steps: int) -> None:
        self.left, self.dead = steps, False
        for owner, name in (
            (Path, "mkdir"), (Path, "unlink"), (Path, "rmdir"), (Path, "replace"), (os, "fsync"),
        ):  # fmt: skip
            patch.setattr(owner, name, self._step(getattr(owner, name)))
        patch.setattr(parquet_files.pq, "write_table", self._written(pq.write_table))

    def _alive(self) -> bool:
        self.dead = self.dead or self.left == 0
        self.left -= 1
        return not self.dead

    def _step(self, real: Callable[..., Any]) -> Callable[..., Any]:
        def step(*given: Any, **named: Any) -> Any:
            if not self._alive():
                raise Died
            return real(*given, **named)

        return step

    def _written(self, real: Callable[..., Any]) -> Callable[..., None]:
        def write(table: pa.Table, stream: Any, **named: Any) -> None:
            alive = self._alive()
            real(table, stream, **named)
            if not alive:
                stream.truncate(stream.tell() // 2)
                raise Died

        return write


class Known:
    """Runs nothing: hands out rows of a table that is known, and remembers which."""

    def __init__(self, table: pa.Table) -> None:
        self.table, self.given = table, np.zeros(len(table), dtype=np.int64)

    def __call__(
        self, study: Study, spans: list[Span]
    ) -> Generator[tuple[Span, pa.Table], None, None]:
        for first, last in reversed(spans):
            self.given[first : last + 1] += 1
            yield (first, last), self.table.slice(first, last - first + 1)


@pytest.fixture(scope="module")
def longer_and_shorter(folder: Path) -> tuple[Study, Study, pa.Table]:
    """Studies of 24 and 10 trials, and the table of the longer, in part."""
    table = left_alone(folder).table.slice(0, 24).select(["trial", "outcome", "start_x"])
    vary = dict(text.split("=") for text in VARIED[1::2])
    given = {"case": str(t_file(folder)), "vary": vary}
    long, short = (
        session_of({**given, "trials": n}, str(folder / "none"), False, 500).study for n in (24, 10)
    )
    return long, short, table


@pytest.mark.parametrize("start", ["empty", "half", "shorter"])
def test_death_at_every_step(
    tmp_path: Path, longer_and_shorter: tuple[Study, Study, pa.Table], start: str
):
    """Whatever the last thing on the disk was, the table is whole in the end, and only what had
    not got there is run again.
    """
    study, short, table = longer_and_shorter

    def run(place: StudyFolder, of: Study, size: int) -> Known:
        known = Known(table)
        done, length = run_study(of, place, known, size, lambda done, total: None)
        assert done.equals(table.slice(0, length.at))
        assert length.at == of.design.total
        return known

    for steps in itertools.count():
        place = StudyFolder(tmp_path / str(steps), "print")
        place.path.mkdir()
        if start == "half":
            place.keep(table.slice(4, 4), 4)
        if start == "shorter":
            run(place, short, 4)
        with pytest.MonkeyPatch.context() as patch:
            disk = Disk(patch, steps)
            try:
                run(place, study, 8)
            except Died:
                assert disk.dead
        kept = np.zeros(24, dtype=bool)
        finished = place.finished()
        kept[: 0 if finished is None else len(finished)] = True
        for (first, last), _ in place.shards():
            kept[first : last + 1] = True
        again = run(place, study, 5)
        np.testing.assert_array_equal(again.given, ~kept)
        sweep(place.path)
        sweep(place.path / "shards")
        assert [path.name for path in place.path.iterdir()] == ["trials.parquet"]
        if not disk.dead:
            break
    assert steps > 15


# ---------------------------------------------------------------------------- full disk, no place


def test_a_full_disk(folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch):
    with monkeypatch.context() as patch:
        full = failing(parquet_files.pq.write_table, 3, OSError, 28, "No space left on device")
        patch.setattr(parquet_files.pq, "write_table", full)
        result = study.run("--shard", "20", "--threads", "2")
    assert result.code == 2
    assert result.err.count("\n") == 1
    assert result.err.startswith("icage: error: ")
    assert "cannot be written: No space left on device" in result.err
    assert len(study.shards) == 3
    assert not [path for path in study.path.rglob(".*") if path.is_file()]
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


@posix
@pytest.mark.slow
def test_a_real_limit_of_the_system(folder: Path, study: Studied):
    """A system that takes no file of the table's size says so before anything is run."""
    import resource

    most = (left_alone(folder).path / "trials.parquet").stat().st_size - 1000
    done = subprocess.run(
        _command(study, "--shard", "20"),
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)),
    )
    assert done.returncode == 2, done
    assert "cannot be written to: File too large" in done.stderr
    assert done.stderr.count("\n") == 1
    assert study.shards == []
    done = subprocess.run(_command(study, "--shard", "20"), capture_output=True, timeout=120)
    assert done.returncode == 0, done
    study.check_same(left_alone(folder))


def test_a_place_that_takes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Said before anything is run or printed."""
    file = tmp_path / "file"
    file.write_text("mine")
    shards = tmp_path / "taken"
    shards.mkdir()
    (shards / "shards").write_text("mine")
    for path, words in (
        (file, "is a file; a folder is needed"),
        (file / "below", "is a file; a folder is needed"),
        (shards, "is a file; a folder is needed"),
        (Path("/proc/none"), "cannot be written to"),
    ):
        if path.parts[1] == "proc" and not Path("/proc/self").exists():
            continue
        assert words in Studied(path, capsys).command(str(t_file(tmp_path))).error_line()
    assert "--out DIR is needed" in here(capsys, "study", str(t_file(tmp_path))).error_line()
    assert file.read_text() == "mine"


@posix
def test_one_at_a_time(folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch):
    study.broken_off(monkeypatch, 2, "--shard", "20")
    before = study.files
    with held(str(study.path)):
        assert "another icage study is running in" in study.resume().error_line()
    assert study.files == before
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


# ---------------------------------------------------------------------------- signals


def _command(study: Studied, *options: str) -> list[str]:
    given = (*VARIED, "--trials", str(TRIALS), "--out", str(study.path), "--no-figures", *options)
    case = str(t_file(study.path.parent))
    return [sys.executable, "-m", "experiments.cli", "study", case, *given]


@posix
def test_an_interrupt_keeps_finished_shards(folder: Path, study: Studied):
    command = subprocess.Popen(
        _command(study, "--shard", "1"),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    end = time.monotonic() + 60
    while len(study.shards) < 5 and command.poll() is None and time.monotonic() < end:
        time.sleep(0.01)
    command.send_signal(signal.SIGINT)
    _, err = command.communicate(timeout=60)
    assert (command.returncode, err) == (130, "icage: error: interrupted\n")
    kept = len(study.shards)
    assert 5 <= kept < TRIALS
    assert not [path for path in study.path.rglob(".*") if path.is_file()]
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


@posix
@pytest.mark.slow
@pytest.mark.parametrize("kills", [2])
def test_killed_at_random(tmp_path: Path, kills: int):
    """``python -m benchmarks.kills`` does it 20 times."""
    told = survive(tmp_path, kills, seed=1, trials=100, shard=3)
    assert len(told["kills"]) == kills
    assert told["same"]
    assert (told["lost"], told["twice"], told["left_over"]) == (0, 0, 0)


def test_a_backend_is_closed_as_soon_as_it_is_no_longer_needed(
    tmp_path: Path, longer_and_shorter: tuple[Study, Study, pa.Table]
):
    study, _, table = longer_and_shorter
    open_now = [0]

    def backend(study: Study, spans: list[Span]) -> Generator[tuple[Span, pa.Table], None, None]:
        open_now[0] += 1
        with closing(Known(table)(study, spans)) as pieces:
            try:
                yield from pieces
            finally:
                open_now[0] -= 1

    (tmp_path / "shards").write_text("in the way")
    with pytest.raises(Exception, match="cannot be written to") as caught:
        run_study(study, StudyFolder(tmp_path, "print"), backend, 4, lambda done, total: None)
    assert open_now == [0], caught
