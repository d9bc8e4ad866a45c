"""One process at a time works in a folder, also while others remove it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from experiments.io import held_folder as holding
from experiments.io.held_folder import held_folder
from icage.errors import InputError, OutputError

posix = pytest.mark.skipif(os.name == "nt", reason="needs POSIX locks")


@posix
def test_the_second_is_refused_and_the_next_is_not(tmp_path: Path):
    place = tmp_path / "a" / "b"
    with (
        held_folder(place, "study"),
        pytest.raises(InputError, match="another icage study is running in"),
        held_folder(place, "study"),
    ):
        pass
    with held_folder(place, "study"):
        assert place.is_dir()


@posix
def test_a_folder_that_goes_before_it_is_held_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Whoever held it removes it as it ends."""
    place, left, lock = tmp_path / "parts", [1, 2], holding.fcntl.flock

    def removed_first(handle: int, how: int) -> None:
        if left:
            left.pop()
            place.rmdir()
        lock(handle, how)

    monkeypatch.setattr(holding.fcntl, "flock", removed_first)
    with held_folder(place, "grasps"):
        assert not left
        (place / "row").write_text("kept")
        with pytest.raises(InputError, match="another"), held_folder(place, "grasps"):
            pass


@posix
def test_a_folder_that_always_goes_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    place = tmp_path / "parts"
    monkeypatch.setattr(holding.fcntl, "flock", lambda *_: place.rmdir())
    with pytest.raises(InputError, match="all the time"), held_folder(place, "grasps"):
        pass


def test_a_file_is_in_the_way(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(OutputError, match="cannot be written to"),
        held_folder(tmp_path / "file" / "parts", "grasps"),
    ):
        pass
