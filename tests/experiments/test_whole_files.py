"""Output files appear whole or not at all."""

from __future__ import annotations

import contextlib
from pathlib import Path

from experiments.replay_files import ALL, JSON, VIDEO, whole_folder
from experiments.whole_files import whole_file


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
    with whole_folder(folder) as staging:
        for name in ALL:
            (staging / name).write_text("new")
            assert not (folder / name).exists()
    assert sorted(p.name for p in folder.iterdir()) == sorted(ALL)


def test_a_failed_replay_leaves_no_folder_it_made(tmp_path: Path):
    folder = tmp_path / "a" / "b"
    with contextlib.suppress(RuntimeError), whole_folder(folder) as staging:
        (staging / JSON).write_text("half")
        raise RuntimeError
    assert not (tmp_path / "a").exists()


def test_a_failed_replay_leaves_an_older_one_as_it_was(tmp_path: Path):
    (tmp_path / JSON).write_text("old")
    (tmp_path / "notes.txt").write_text("mine")
    with contextlib.suppress(RuntimeError), whole_folder(tmp_path) as staging:
        (staging / JSON).write_text("half")
        raise RuntimeError
    found = {p.name: p.read_text() for p in tmp_path.iterdir()}
    assert found == {JSON: "old", "notes.txt": "mine"}


def test_a_film_of_another_run_does_not_stay(tmp_path: Path):
    (tmp_path / VIDEO).write_text("old")
    (tmp_path / "notes.txt").write_text("mine")
    with whole_folder(tmp_path) as staging:
        (staging / JSON).write_text("new")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["notes.txt", JSON]
