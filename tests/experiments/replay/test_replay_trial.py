"""``icage replay-trial``: a recorded trial repeats to the bit, and a false record is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from experiments.io.parquet_files import words_of, write_table
from experiments.replay import clips, video
from experiments.replay.recorded_trial import RecordingError, read_trial, rerun
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A replay of the T by the command itself."""
    from experiments.cli import main

    place = tmp_path_factory.mktemp("replay")
    case = write_case(t_case(), place / "t.json")
    options = ["--trials", "6", "--seed", "3", "--no-video"]
    assert main(["replay", str(case), "--out", str(place / "out"), *options]) == 0
    return place / "out"


def copied(folder: Path, place: Path, **changed: Any) -> Path:
    """A replay with some columns of its first row, or keys of its document, changed."""
    place.mkdir()
    table = pq.read_table(folder / "trials.parquet")
    document = json.loads((folder / "replay.json").read_text())
    for name, value in changed.items():
        if name in table.column_names:
            column = [value, *table[name].to_pylist()[1:]]
            at = table.column_names.index(name)
            table = table.set_column(at, name, pa.array(column))
        else:
            document[name] = value
    write_table(table, place / "trials.parquet", words_of(table))
    (place / "replay.json").write_text(json.dumps(document))
    return place


def test_every_trial_repeats_to_the_last_bit(folder: Path):
    for index in range(6):
        done = rerun(read_trial(folder, index))
        assert done.identical, done.differences
        assert done.trial.row["trial"] == index


def test_the_command_says_so(folder: Path, capsys: Any):
    result = here(capsys, "replay-trial", str(folder), "4")
    assert result.code == 0, result
    assert "record       the same to the last bit" in result.out
    assert "outcome      target after" in result.out
    answer = json.loads(here(capsys, "replay-trial", str(folder), "4", "--json", "-").out)
    assert answer["format"] == "icage-replay-trial/1"
    assert answer["identical"]
    assert (answer["differences"], answer["versions_differ"]) == ([], {})
    row = pq.read_table(folder / "trials.parquet").to_pylist()[4]
    assert answer["end"] == [row[f"end_{name}"] for name in ("x", "y", "theta", "sigma")]
    assert answer["recorded"]["outcome"] == answer["outcome"] == "target"


def test_a_last_bit_off_fails(folder: Path, tmp_path: Path, capsys: Any):
    end_x = pq.read_table(folder / "trials.parquet")["end_x"][0].as_py()
    off = copied(folder, tmp_path / "off", end_x=float(np.nextafter(end_x, np.inf)))
    result = here(capsys, "replay-trial", str(off), "0")
    assert result.code == 1
    assert "same versions, but end_x differ" in result.err
    assert "differs      end_x was" in result.out
    assert here(capsys, "replay-trial", str(off), "1").code == 0


def test_other_versions_may_differ_and_are_named(folder: Path, tmp_path: Path, capsys: Any):
    versions = json.loads((folder / "replay.json").read_text())["versions"]
    versions["mujoco"] = "4.0.7"
    old = copied(folder, tmp_path / "old", steps=1, versions=versions)
    result = here(capsys, "replay-trial", str(old), "0")
    assert result.code == 0, result
    assert "version      mujoco was 4.0.7, is" in result.out
    assert "differs      steps was 1, is" in result.out


def test_another_object_is_another_trial(folder: Path, tmp_path: Path):
    document = json.loads((folder / "replay.json").read_text())
    document["runs"][0]["outline"]["vertices"][0][0] += 0.01
    place = copied(folder, tmp_path / "moved", runs=document["runs"])
    assert not all(rerun(read_trial(place, index)).identical for index in range(6))


@pytest.mark.parametrize(
    ("index", "words"), [("6", "has no trial 6; it has 6"), ("-1", "not a whole number")]
)
def test_no_such_row(folder: Path, index: str, words: str, capsys: Any):
    result = here(capsys, "replay-trial", str(folder), "--", index)
    assert words in result.error_line()


def test_what_is_no_replay_is_an_input_error(folder: Path, tmp_path: Path, capsys: Any):
    assert "cannot be read" in here(capsys, "replay-trial", str(tmp_path), "0").error_line()
    other = copied(folder, tmp_path / "other", format="icage-plan/1")
    with pytest.raises(RecordingError, match="'icage-replay/1' is needed"):
        read_trial(other, 0)
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    del runs[0]["outline"]
    with pytest.raises(RecordingError, match="before outline and settings were kept"):
        read_trial(copied(folder, tmp_path / "before", runs=runs), 0)
    broken = copied(folder, tmp_path / "broken")
    (broken / "trials.parquet").write_bytes(b"PAR1 and nothing else")
    with pytest.raises(RecordingError, match="trials"):
        read_trial(broken, 0)


@pytest.mark.parametrize(
    ("key", "value"),
    [("grasps", {}), ("grasps", []), ("finger_radius", None), ("finger_radius", {}),
     ("finger_radius", [0.1]), ("finger_radius", 0.0), ("finger_radius", 1e-12)],
)  # fmt: skip
def test_a_plan_that_nothing_can_be_closed_with_is_an_input_error(
    folder: Path, tmp_path: Path, key: str, value: object, capsys: Any
) -> None:
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    runs[0]["plan"][key] = value
    if value is None:
        del runs[0]["plan"][key]
    other = copied(folder, tmp_path / "other", runs=runs)
    words = "grasps" if key == "grasps" else "finger_radius"
    assert words in here(capsys, "replay-trial", str(other), "0").error_line()


def test_a_grasp_or_a_plateau_that_is_none_is_an_input_error(
    folder: Path, tmp_path: Path, capsys: Any
) -> None:
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    whole = runs[0]["plan"]["grasps"][0]
    grasps = ([], [1], "grasp", 7, None, {})
    plateaus = ([], {}, 7, [1, 2], [[[0, 0]], [[0, 0]]], "ends")
    for k, wrong in enumerate((*grasps, *(whole | {"plateau": ends} for ends in plateaus))):
        runs[0]["plan"]["grasps"] = [wrong]
        other = copied(folder, tmp_path / str(k), runs=runs)
        told = here(capsys, "replay-trial", str(other), "0").error_line()
        assert "is not a replay" in told or "contacts" in told, wrong


@pytest.mark.parametrize("key", ["id", "target", "sigma_0", "contacts", "free_fingers"])
@pytest.mark.parametrize("value", [{}, [[]], "one", None, {"id": 1}, [7.5], True, 1e400])
def test_whatever_a_grasp_has_is_read_or_refused(
    folder: Path, tmp_path: Path, key: str, value: object, capsys: Any
) -> None:
    """None of it gets as far as the judge of the closing."""
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    runs[0]["plan"]["grasps"][0][key] = value
    other = copied(folder, tmp_path / "other", runs=runs)
    ended = here(capsys, "replay-trial", str(other), "0")
    if (key, value) in (("target", True), ("free_fingers", {})):
        assert ended.code in (0, 1)
    else:
        assert ended.error_line()


@pytest.mark.parametrize("key", ["contacts", "verdict", "regions", "sigma_max", "hand"])
@pytest.mark.parametrize("value", [{}, [[]], "one", {"id": 1}, [7.5], [{"polygons": 1}]])
def test_whatever_a_film_draws_is_read_or_refused(
    folder: Path, tmp_path: Path, key: str, value: object, capsys: Any
) -> None:
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    runs[0]["plan"][key] = value
    other = copied(folder, tmp_path / "other", runs=runs)
    ended = here(capsys, "replay-trial", str(other), "0")
    assert ended.code in (0, 1) if (key, value) == ("regions", {}) else ended.error_line()


@pytest.mark.parametrize("unit", [None, 7, []])
def test_a_run_without_a_unit_is_an_input_error(
    folder: Path, tmp_path: Path, unit: object, capsys: Any
) -> None:
    runs = json.loads((folder / "replay.json").read_text())["runs"]
    runs[0]["unit"] = unit
    if unit is None:
        del runs[0]["unit"]
    other = copied(folder, tmp_path / "other", runs=runs)
    assert "is not a replay" in here(capsys, "replay-trial", str(other), "0").error_line()


@pytest.mark.slow
def test_it_is_filmed(folder: Path, tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(video, "find_backend", lambda: None)
    for module in (clips, video):
        monkeypatch.setattr(module, "FPS", 10)
    film = tmp_path / "trial.mp4"
    result = here(capsys, "replay-trial", str(folder), "2", "--video", str(film))
    assert result.code == 0, result
    assert film.stat().st_size > 20_000
    wrong = here(capsys, "replay-trial", str(folder), "2", "--video", str(tmp_path / "a.gif"))
    assert "a name ending in .mp4 is needed" in wrong.error_line()
