"""A study dies, is interrupted, finds rubbish or a full disk: nothing lost, nothing twice."""

from __future__ import annotations

import itertools
import os
import re
import shutil
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
from tests.faults import unreadable
from tests.killed import killed
from tests.oracles.against_itself.kills import survive

posix = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals and limits")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("studies")


@pytest.fixture
def study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Studied:
    return Studied(tmp_path / "out", capsys)


# ---------------------------------------------------------------------------- rubbish in the folder


def _half(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _with_a_hole(path: Path) -> None:
    """Right length, right end, some of it never reached the disk."""
    whole = bytearray(path.read_bytes())
    middle = len(whole) // 2
    whole[middle - 2000 : middle] = bytes(2000)
    path.write_bytes(whole)


def _empty(path: Path) -> None:
    path.write_bytes(b"")


def _foreign(path: Path) -> None:
    """Of another study: other words about it."""
    table = pq.read_table(path)
    pq.write_table(table.replace_schema_metadata({"icage-study": "another"}), path)


def _nameless(path: Path) -> None:
    pq.write_table(pq.read_table(path).replace_schema_metadata(None), path)


def _of_other_trials(path: Path) -> None:
    """Its name says that it holds the 17 trials after its own."""
    path.rename(path.with_name("trials-000000018-000000034.parquet"))


def _absurd(path: Path) -> None:
    path.rename(path.with_name("trials-000000001-999999999.parquet"))


def _flipped(path: Path) -> None:
    """One bit, in the words at the end of which no page's sum knows."""
    whole = bytearray(path.read_bytes())
    at = whole.rindex(b"icage-digest") + 20
    whole[at] ^= 1
    path.write_bytes(whole)


def _written(path: Path, table: pa.Table) -> None:
    """By another tool that keeps the words of a table."""
    pq.write_table(table.replace_schema_metadata(pq.read_table(path).schema.metadata), path)


def _twice(path: Path) -> None:
    table = pq.read_table(path)
    last = len(table) - 1
    _written(path, pa.concat_tables([table.slice(0, last), table.slice(last - 1, 1)]))


def _backwards(path: Path) -> None:
    table = pq.read_table(path)
    _written(path, table.take(list(range(len(table)))[::-1]))


def _retyped(path: Path) -> None:
    table = pq.read_table(path)
    _written(path, table.set_column(0, "trial", table["trial"].cast(pa.int32())))


def _twice_in_all(path: Path) -> None:
    table = pq.read_table(path)
    _written(path, pa.concat_tables([table.slice(0, 60), table.slice(59, 60)]))


def _shorter(path: Path) -> None:
    _written(path, pq.read_table(path).drop_columns(["margin"]))


@pytest.mark.parametrize(
    "spoil",
    [_half, _with_a_hole, _empty, _foreign, _nameless, _of_other_trials, _absurd, _flipped, _twice,
     _backwards, _retyped, _shorter],
)  # fmt: skip
def test_a_bad_shard_is_set_aside_and_its_trials_are_run_again(
    folder: Path, study: Studied, spoil: Callable[[Path], None], monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 3, "--shard", "17", "--threads", "1")
    others = set(study.shards) - {study.shards[1]}
    spoil(study.shards[1])
    (spoilt,) = set(study.shards) - others
    content = spoilt.read_bytes()
    result = study.resume("--shard", "40")
    assert result.code == 0
    assert result.err.count("was set aside as") == 1
    aside = study.path / "set-aside" / spoilt.name
    assert aside.read_bytes() == content
    aside.unlink()
    aside.parent.rmdir()
    study.check_same(left_alone(folder))


def test_a_file_of_another_name_is_left_alone(
    folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--shard", "17", "--threads", "1")
    mine = study.shards[0].with_name("trials-mine.parquet")
    shutil.copy(study.shards[0], mine)
    content = mine.read_bytes()
    assert study.resume().code == 0
    assert mine.read_bytes() == content
    mine.unlink()
    mine.parent.rmdir()
    study.check_same(left_alone(folder))


@posix
@pytest.mark.parametrize("kind", ["fifo", "endless", "folder"])
def test_what_is_no_file_is_refused_and_nothing_is_touched(
    study: Studied, kind: str, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--shard", "17", "--threads", "1")
    for name in ("study.json", f"shards/{study.shards[1].name}"):
        path = study.path / name
        content = path.read_bytes()
        path.unlink()
        if kind == "fifo":
            os.mkfifo(path)
        elif kind == "endless":
            path.symlink_to("/dev/zero")
        else:
            path.mkdir()
        before = sorted(study.path.rglob("*"))
        result = study.resume()
        assert result.code == 2
        assert re.search("is no regular file|is a folder there", result.err.splitlines()[-1])
        assert sorted(study.path.rglob("*")) == before
        path.rmdir() if kind == "folder" else path.unlink()
        path.write_bytes(content)


@pytest.mark.parametrize("what", ["study.json", "shards", "trials.parquet"])
def test_what_the_disk_does_not_read_is_not_removed(
    folder: Path, study: Studied, what: str, monkeypatch: pytest.MonkeyPatch
):
    """An input error of the disk is none of the file: 37 good shards went by one."""
    if what == "trials.parquet":
        assert study.run().code == 0
    else:
        study.broken_off(monkeypatch, 3, "--shard", "17", "--threads", "1")
    before = study.files
    with monkeypatch.context() as patch:
        unreadable(patch, what)
        result = study.resume()
    assert result.code == 2
    assert "cannot be read: Input/output error" in result.err.splitlines()[-1]
    assert {**before, "study.json": b""} == {**study.files, "study.json": b""}
    assert study.resume().code == 0
    study.check_same(left_alone(folder))


def test_overlapping_shards_count_once(
    folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--shard", "20", "--threads", "1")
    other = Studied(study.path.with_name("other"), study.capsys)
    other.broken_off(monkeypatch, 3, "--shard", "15", "--threads", "1")
    for path in other.shards:
        shutil.copy(path, study.shards[0].parent)
    assert len(study.shards) == 5
    assert study.resume("--shard", "1000").code == 0
    study.check_same(left_alone(folder))


@posix
def test_leftovers_of_a_killed_process_are_swept_and_nothing_else(
    folder: Path, study: Studied, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 2, "--shard", "20")
    killed(study.path)
    killed(study.path / "shards")
    mine = [study.path / ".study.0123abcd.json", study.path / "shards" / ".trials-1.parquet"]
    for path in mine:
        path.write_text("not a leftover")
    assert study.resume().code == 0
    for path in mine:
        assert path.read_text() == "not a leftover"
        path.unlink()
    (study.path / "shards").rmdir()
    study.check_same(left_alone(folder))


# ---------------------------------------------------------------------------- another's folder


def test_a_replay_is_not_replaced(study: Studied):
    for name in ("replay.json", "trials.parquet", "results.md"):
        study.path.mkdir()
        (study.path / name).write_text("of something else")
        for options in ((), ("--resume",)):
            line = study.run(*options).error_line()
            assert f"holds {name}, but no study.json" in line
        assert study.files == {name: b"of something else"}
        shutil.rmtree(study.path)


def test_an_edited_document_replaces_no_table(study: Studied):
    assert study.run().code == 0
    document = study.path / "study.json"
    document.write_text(document.read_text().replace('"seed": 0', '"seed": 1'))
    before = study.files
    for result in (study.resume(), study.run("--resume", "--seed", "1")):
        assert "trials.parquet' is no table of this study" in result.error_line()
    assert study.files == before


@pytest.mark.parametrize("spoil", [_half, _empty, _flipped, _twice_in_all, _shorter, _retyped])
def test_a_damaged_table_is_one_line_and_stays(study: Studied, spoil: Callable[[Path], None]):
    assert study.run().code == 0
    spoil(study.path / "trials.parquet")
    before = study.files
    assert "trials.parquet' " in study.resume().error_line()
    assert "trials.parquet' " in here(
        study.capsys, "replay-trial", str(study.path), "0"
    ).error_line()  # fmt: skip
    assert study.files == before


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"seed": 0', '"seed": "0"', "whole number"),
        ('"seed": 0', '"seed": 0, "seed": 1', "twice"),
        ('"seed": 0', '"seed": 0, "sead": 1', "unknown field 'sead'"),
        ('"trials": 120', '"trials": 1e999', "trials"),
        ('"trials": 120', '"trials": 99999999999', "10000000"),
        ('"kind": "normal"', '"kind": "lognormal"', "no distribution 'lognormal'"),
        ('"kind": "normal"', '"kind": "uniform"', "trials of another study"),
        ('"max_time": 5.0', '"max_time": NaN', "NaN"),
        ('"name": "T"', '"name": "T\\u001b[31m"', "printable"),
        ('"finger_radius": ', '"finger_radius": -', "radius"),
        ('"outline_scale"', '"outline_skale"', "no variable 'outline_skale'"),
    ],
)
def test_a_document_is_checked_like_what_a_user_writes(
    study: Studied, old: str, new: str, words: str, monkeypatch: pytest.MonkeyPatch
):
    study.broken_off(monkeypatch, 1, "--shard", "40")
    document = study.path / "study.json"
    text = document.read_text()
    assert old in text
    document.write_text(text.replace(old, new))
    before = study.files
    assert words in study.resume().error_line()
    assert study.files == before


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
