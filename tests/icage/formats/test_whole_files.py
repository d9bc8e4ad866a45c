"""Output files appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import stat
from pathlib import Path

import pytest

from experiments.io.whole_folder import whole_folder
from experiments.replay.files import ALL, JSON, VIDEO
from icage.errors import OutputError
from icage.formats.whole_files import check_writable, whole_file


def test_a_file_takes_its_place_when_it_is_whole(tmp_path: Path):
    path = tmp_path / "answer.json"
    path.write_text("old")
    with whole_file(path) as part:
        part.write_text("new")
        assert path.read_text() == "old"
        assert part.suffix == path.suffix
    assert path.read_text() == "new"
    assert [p.name for p in tmp_path.iterdir()] == ["answer.json"]


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path):
    path = tmp_path / "answer.json"
    path.write_text("old")
    with contextlib.suppress(KeyboardInterrupt), whole_file(path) as part:
        part.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["answer.json"]


def test_files_of_a_replay_appear_together(tmp_path: Path):
    folder = tmp_path / "a" / "b"
    with whole_folder(folder, ALL) as staging:
        for name in ALL:
            (staging / name).write_text("new")
            assert not (folder / name).exists()
    assert sorted(p.name for p in folder.iterdir()) == sorted(ALL)


def test_a_failed_replay_leaves_no_folder_it_made(tmp_path: Path):
    folder = tmp_path / "a" / "b"
    with contextlib.suppress(RuntimeError), whole_folder(folder, ALL) as staging:
        (staging / JSON).write_text("half")
        raise RuntimeError
    assert not (tmp_path / "a").exists()


def test_a_failed_replay_leaves_an_older_one_as_it_was(tmp_path: Path):
    (tmp_path / JSON).write_text("old")
    (tmp_path / "notes.txt").write_text("mine")
    with contextlib.suppress(RuntimeError), whole_folder(tmp_path, ALL) as staging:
        (staging / JSON).write_text("half")
        raise RuntimeError
    found = {p.name: p.read_text() for p in tmp_path.iterdir()}
    assert found == {JSON: "old", "notes.txt": "mine"}


def test_a_film_of_another_run_does_not_stay(tmp_path: Path):
    (tmp_path / VIDEO).write_text("old")
    (tmp_path / "notes.txt").write_text("mine")
    with whole_folder(tmp_path, ALL) as staging:
        (staging / JSON).write_text("new")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["notes.txt", JSON]


posix = pytest.mark.skipif(os.name == "nt", reason="needs POSIX files")


@posix
def test_a_link_is_followed(tmp_path: Path):
    (tmp_path / "data").mkdir()
    for there in (True, False):
        target = tmp_path / "data" / f"{there}.json"
        if there:
            target.write_text("old")
        link = tmp_path / f"link_{there}.json"
        link.symlink_to(target)
        with whole_file(link) as part:
            assert target.parent in part.parents
            part.write_text("new")
        assert link.is_symlink()
        assert target.read_text() == "new"
    assert len(list((tmp_path / "data").iterdir())) == 2


@posix
def test_a_pipe_is_written_into_once_all_is_there(tmp_path: Path):
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        check_writable(pipe)
        with contextlib.suppress(RuntimeError), whole_file(pipe) as part:
            part.write_text("half")
            raise RuntimeError
        with whole_file(pipe) as part:
            assert part.suffix == ".json"
            part.write_text("new")
        assert os.read(reader, 100) == b"new"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert list(tmp_path.iterdir()) == [pipe]


@posix
def test_a_device_stays_a_device():
    """A terminal of our own: nobody can make a file beside it, not even root."""
    ours, theirs = os.openpty()
    try:
        path = Path(os.ttyname(theirs))
        with whole_file(path) as part:
            part.write_text("new")
        assert os.read(ours, 100) == b"new"
        assert path.is_char_device()
    finally:
        os.close(ours)
        os.close(theirs)


@posix
def test_what_cannot_be_written_is_said(tmp_path: Path):
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    for path, words in (
        (tmp_path, "is a folder"),
        (tmp_path / "circle", "cannot be written: Too many levels"),
        (tmp_path / "none" / "a.json", "cannot be written: No such file"),
    ):
        with pytest.raises(OutputError, match=words), whole_file(path) as part:
            part.write_text("new")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs /proc")
def test_a_folder_that_only_looks_writable():
    file = Path("/proc/x.json")
    with pytest.raises(OutputError, match="written: No such file"), whole_file(file) as part:
        part.write_text("new")
    refused = pytest.raises(OutputError, match="cannot be written to")
    with refused, whole_folder(Path("/proc/x"), ALL):
        pass
