"""A study finds rubbish in its folder, or another's results: nothing lost, nothing twice."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.experiments.commands.runner import here
from tests.experiments.study.studies import Studied, left_alone
from tests.faults import unreadable
from tests.killed import killed

posix = pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals and limits")


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
