"""``icage replay``: what it writes, what it counts, and that it does not hide a failure."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from experiments.replay import run as replays
from experiments.replay.files import JSON, REGIONS, TRIALS, trial_table
from experiments.replay.run import Replay, replay, run_failures
from icage.case import Case
from icage.errors import InputError
from icage.formats.case_json import read_case
from icage.hand import Placement
from icage.sampling import Starts, draw_starts
from models import CASES, case_paths
from tests.experiments.commands.runner import Result, here
from tests.experiments.small import t_case, write_case

RUN_KEYS = {
    "grasp", "set", "plan", "unit", "diameter", "trials", "target", "other_grasp", "jammed",
    "escaped", "diverged", "timed_out", "unmatched", "position_error_max", "angle_error_max_deg",
    "penetration_max", "penetration_rest_max", "time_step", "sigma_range",
}  # fmt: skip
COUNTS = (
    "target", "other_grasp", "jammed", "escaped", "diverged", "timed_out", "unmatched",
)  # fmt: skip


def silent(stage: str, done: int, total: int) -> None:
    assert 0 <= done <= total, stage


@pytest.fixture(scope="module")
def done() -> Replay:
    return replay([t_case()], 30, 1, 2, silent)


def run_command(capsys: Any, case: Path, out: Path, *options: str) -> Result:
    return here(capsys, "replay", str(case), "--out", str(out), "--trials", "25", *options)


def test_the_command_writes_what_the_contract_says(tmp_path: Path, capsys: Any):
    case = write_case(t_case(), tmp_path / "t.json")
    result = run_command(capsys, case, tmp_path / "out", "--no-video", "--seed", "7")
    assert result.code == 0, result
    assert "25 of 25 closings from guaranteed sets ended in the target grasp" in result.out
    files = {path.name for path in (tmp_path / "out").iterdir()}
    assert files == {JSON, TRIALS, REGIONS}
    document = json.loads((tmp_path / "out" / JSON).read_text())
    assert document["format"] == "icage-replay/1"
    assert (document["name"], document["seed"]) == ("T", 7)
    assert document["versions"].keys() >= {"icage", "python", "mujoco", "numpy", "shapely"}
    (run,) = document["runs"]
    assert run.keys() >= RUN_KEYS
    assert {key: document[key] for key in RUN_KEYS} == {key: run[key] for key in RUN_KEYS}
    assert run["set"] == "guaranteed"
    assert run["trials"] == 25 == sum(run[name] for name in COUNTS)
    assert run["target"] == 25
    assert run["plan"]["format"] == "icage-plan/1"
    assert {region["level"] for region in run["plan"]["regions"]} == {"sigma_max"}
    assert 0.0 < run["position_error_max"] <= 1e-4 * run["diameter"]
    assert 0.0 < run["angle_error_max_deg"] <= np.degrees(1e-3)
    assert 0.0 < run["penetration_rest_max"] <= 1e-5 * run["diameter"]
    low, high = run["sigma_range"]
    assert run["plan"]["sigma_0"] < low < high < run["sigma_limit"] < run["plan"]["sigma_first"]
    table = pq.read_table(tmp_path / "out" / TRIALS)
    assert table.num_rows == 25
    assert table["outcome"].to_pylist() == ["target"] * 25
    assert table["verdict"].to_pylist() == ["target"] * 25
    assert table["seed"].to_pylist() == [7] * 25
    assert max(table["start_sigma"].to_pylist()) == high
    assert max(table["position_error"].to_pylist()) == run["position_error_max"]


def test_the_table_holds_the_trials(done: Replay):
    (run,) = done.runs
    table = trial_table(done).to_pydict()
    names = ("x", "y", "theta", "sigma")
    start = np.column_stack([table[f"start_{name}"] for name in names])
    end = np.column_stack([table[f"end_{name}"] for name in names])
    assert np.array_equal(start, run.starts.placements)
    target = run.cage.target_placement
    assert end[:, 3] == pytest.approx(target.sigma, rel=1e-4)
    for row in range(3):  # errors once more, by hand: the centroid seen from the hand
        seen = []
        for place in (Placement(*end[row]), target):
            turn = np.exp(-1j * place.theta)
            offset = run.case.outline.centroid - [place.x, place.y]
            seen.append(turn * complex(*offset))
        assert table["position_error"][row] == pytest.approx(abs(seen[0] - seen[1]), abs=1e-12)
        assert table["angle_error"][row] == pytest.approx(
            abs(np.angle(np.exp(1j * (end[row, 2] - target.theta)))), abs=1e-12
        )


def test_the_same_seed_gives_the_same_result_on_any_number_of_threads(done: Replay):
    again = replay([t_case()], 30, 1, 1, silent)
    assert trial_table(again).equals(trial_table(done))
    other = replay([t_case()], 30, 2, 2, silent)
    assert not trial_table(other).equals(trial_table(done))


def moved_target(cage: Any) -> Any:
    """The same cage, its list of grasps a hundredth of the object off: a wrong planner."""
    off = cage.grasps[0].contacts + 0.01 * cage.outline.diameter
    return replace(cage, grasps=(replace(cage.grasps[0], contacts=off), *cage.grasps[1:]))


def test_a_wrong_grasp_fails_the_run(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch):
    plan = replays.plan
    monkeypatch.setattr(replays, "plan", lambda *args, **named: moved_target(plan(*args, **named)))
    case = write_case(t_case(), tmp_path / "t.json")
    result = run_command(capsys, case, tmp_path / "out", "--no-video")
    assert result.code == 1
    assert "25 of 25 did not end in the target grasp (25 unmatched)" in result.err
    assert "FAILED" in result.out
    document = json.loads((tmp_path / "out" / JSON).read_text())
    assert document["passed"] is False
    assert (document["target"], document["unmatched"]) == (0, 25)
    assert document["position_error_max"] is None


def some_beside(cage: Any, which: Any, count: int, *rest: Any) -> Starts:
    """Starts of which every third has the hand beside the object: it shuts on nothing."""
    rows = draw_starts(cage, which, count, *rest).placements.copy()
    rows[::3, 0] += 5.0 * cage.outline.diameter
    return Starts(rows, count)


def test_an_escape_fails_the_run(tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sim.closing.replay.draw_starts", some_beside)
    case = write_case(t_case(), tmp_path / "t.json")
    result = run_command(capsys, case, tmp_path / "out", "--no-video")
    assert result.code == 1
    assert "9 of 25 did not end in the target grasp (9 escaped)" in result.err
    document = json.loads((tmp_path / "out" / JSON).read_text())
    assert document["escaped"] == 9
    assert document["trials"] == sum(document[name] for name in COUNTS) == 25


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("penetration_max", 2e-3, "penetration while closing up to 0.002 in 1 trials"),
        ("penetration_rest", 2e-5, "penetration at rest up to 2e-05 in 1 trials"),
        ("shape_error_max", 1e-4, "shape error up to 0.0001 in 1 trials"),
        ("sigma_rise_max", 1.01, "rise of sigma above its start up to 0.01 in 1 trials"),
        ("penetration_max", np.nan, "penetration while closing"),
    ],
)
def test_every_limit_is_looked_at(done: Replay, field: str, value: float, words: str):
    (run,) = done.runs
    assert not list(run_failures(run))
    values = getattr(run.closings, field).copy()
    values[3] = value
    broken = replace(run, closings=replace(run.closings, **{field: values}))
    (sentence,) = run_failures(broken)
    assert words in sentence


def test_a_set_too_small_to_draw_from_fails_the_run_and_leaves_nothing(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
):
    from icage import sampling as starts

    monkeypatch.setattr(starts, "TRIES_PER_START", 0)
    case = write_case(t_case(), tmp_path / "t.json")
    result = run_command(capsys, case, tmp_path / "out", "--no-video")
    assert result.code == 1
    assert "too small to draw from: 0 of 25 placements" in result.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (lambda: read_case(CASES / "T_best.json"), "finger_radius is 0"),
        (lambda: sideways(), "not a cage"),
    ],
)
def test_what_cannot_be_replayed_is_an_input_error(
    case: Any, words: str, tmp_path: Path, capsys: Any
):
    path = write_case(case(), tmp_path / "case.json")
    result = run_command(capsys, path, tmp_path / "out")
    assert words in result.error_line()
    assert not (tmp_path / "out").exists()


def sideways() -> Case:
    """A rectangle held on two parallel edges: the hand slides off."""
    from icage.outline import Outline

    contacts = np.array([[0.5, -0.1], [1.5, -0.1], [1.0, 1.1]])
    return Case("rectangle", "mm", Outline([[0, 0], [2, 0], [2, 1], [0, 1]]), 0.1, contacts)


def test_a_place_that_cannot_be_written_is_refused_first(tmp_path: Path, capsys: Any):
    case = write_case(t_case(), tmp_path / "t.json")
    (tmp_path / "file").write_text("mine")
    for out in ("file", "file/below"):
        line = run_command(capsys, case, tmp_path / out).error_line()
        assert "is a file; a folder is needed" in line
    assert (tmp_path / "file").read_text() == "mine"
    assert "does not exist" in here(capsys, "replay", "nothing", "--out", "x").error_line()
    line = here(capsys, "replay", str(case), "--out", "x", "--trials", "0").error_line()
    assert "--trials" in line


def test_point_fingers_are_refused_before_anything_is_planned(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(replays, "plan", None)
    with pytest.raises(InputError, match="some radius"):
        replay([t_case(), read_case(CASES / "T_best.json")], 5, 0, 1, silent)


@pytest.mark.slow
def test_the_rest_of_a_cage_is_replayed_and_nothing_escapes(tmp_path: Path, capsys: Any):
    path = next(path for path in case_paths("pliers") if "rest" in path.stem)
    result = run_command(capsys, path, tmp_path / "out", "--no-video")
    assert result.code == 0, result
    document = json.loads((tmp_path / "out" / JSON).read_text())
    assert [run["set"] for run in document["runs"]] == ["guaranteed", "rest"]
    rest = document["runs"][1]
    assert rest["target"] + rest["other_grasp"] == 25
    assert rest["plan"]["sigma_first"] < rest["sigma_limit"] < rest["plan"]["sigma_max"]
