"""What a killed process left is swept; nothing else ever is."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from icage.staging import PREFIX, Staging, staging, sweep
from tests.killed import killed

pytestmark = pytest.mark.skipif(os.name == "nt", reason="needs POSIX locks")


def test_what_a_killed_process_left_is_swept(tmp_path: Path):
    killed(tmp_path)
    assert [path.name[: len(PREFIX)] for path in tmp_path.iterdir()] == [PREFIX]
    sweep(tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_next_who_writes_there_sweeps(tmp_path: Path):
    killed(tmp_path)
    with staging(tmp_path) as place:
        assert list(tmp_path.iterdir()) == [place.path]
    assert not list(tmp_path.iterdir())


def test_a_living_process_keeps_its_own(tmp_path: Path):
    with staging(tmp_path) as place:
        (place.new / "half").write_text("half")
        sweep(tmp_path)
        assert (place.new / "half").read_text() == "half"


def test_what_only_looks_like_one_stays(tmp_path: Path):
    """A folder by the name without the record, with another's record, a file, a link."""
    killed(tmp_path)
    (left,) = tmp_path.iterdir()
    copy = tmp_path / f"{PREFIX}copy"
    left.rename(copy)  # its record names another folder
    mine = tmp_path / f"{PREFIX}mine"
    mine.mkdir()
    (mine / "thesis.txt").write_text("mine")
    (tmp_path / f"{PREFIX}file").write_text("mine")
    outside = tmp_path / "outside"
    outside.mkdir()
    killed(outside)
    (there,) = outside.iterdir()
    (tmp_path / there.name).symlink_to(there)
    before = sorted(path for path in tmp_path.rglob("*"))
    sweep(tmp_path)
    assert sorted(path for path in tmp_path.rglob("*")) == before


@pytest.mark.parametrize("moment", range(6))
def test_moves_that_were_begun_are_ended_by_the_sweep(tmp_path: Path, moment: int):
    """Killed at each rename: after the sweep all files are old, or all are new."""
    for name in ("a", "b", "gone"):
        (tmp_path / name).write_text("old")
    then = f"""
    real, calls = os.rename, []
    def rename(one, other):
        if len(calls) == {moment}:
            os.kill(os.getpid(), signal.SIGKILL)
        calls.append(one)
        real(one, other)
    os.rename = rename
    (place.new / "a").write_text("new")
    (place.new / "b").write_text("new")
    place.move(("a", "b", "gone"))
"""
    killed(tmp_path, then)
    sweep(tmp_path)
    found = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert found == {"a": "new", "b": "new"}


@pytest.mark.parametrize("for_good", [False, True])
@pytest.mark.parametrize("moment", range(5))
def test_a_move_that_fails_moves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: int, for_good: bool
):
    """Undone at once; or, where the disk is broken for good, ended by the next sweep."""
    for name in ("a", "b", "gone"):
        (tmp_path / name).write_text("old")
    real, calls = os.rename, [0]

    def rename(one: Any, other: Any) -> None:
        calls[0] += 1
        if calls[0] == moment + 1 or (for_good and calls[0] > moment):
            raise OSError(errno.EIO, "Input/output error")
        real(one, other)

    def write() -> None:
        with staging(tmp_path) as place:
            (place.new / "a").write_text("new")
            (place.new / "b").write_text("new")
            place.move(("a", "b", "gone"))

    with monkeypatch.context() as patch:
        patch.setattr(os, "rename", rename)
        with pytest.raises(OSError, match="Input"):
            write()
    if for_good:
        sweep(tmp_path)
    found = {path.name: path.read_text() for path in tmp_path.iterdir()}
    old, new = {"a": "old", "b": "old", "gone": "old"}, {"a": "new", "b": "new"}
    assert found == old or (for_good and found == new)


def test_a_folder_in_the_way_of_a_file_stays(tmp_path: Path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "thesis.txt").write_text("mine")
    with staging(tmp_path) as place:
        (place.new / "a").write_text("new")
        with pytest.raises(IsADirectoryError):
            place.move(("a",))
    assert (tmp_path / "a" / "thesis.txt").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_nothing_written_moves_nothing(tmp_path: Path):
    with staging(tmp_path) as place:
        assert isinstance(place, Staging)
        place.move(())
    assert not list(tmp_path.iterdir())
