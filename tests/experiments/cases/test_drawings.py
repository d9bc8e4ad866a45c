"""A drawing in place of a case: the best grasp is taken, said, kept, and gives the same again."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import icage
from tests.experiments.commands.runner import Result, here
from tests.experiments.small import t_case, write_case
from tests.icage.formats.svg.drawings import drawing
from tests.icage.formats.test_load import T_PATH, without_grasp

SIZE = ("--width", "60", "--unit", "mm", "--finger-radius", "3")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("t.svg").write_text(drawing(T_PATH, 'viewBox="0 0 60 40"'))
    return tmp_path


def told(done: Result, count: int = 1) -> None:
    which = "is the best" if count == 1 else f"are the best {count}"
    assert f"has no grasp yet: taken {which} of " in done.err
    assert "score " in done.err


def test_plan_takes_the_best_grasp_and_says_how_to_keep_it(
    capsys: pytest.CaptureFixture[str],
):
    done = here(capsys, "plan", "t.svg", *SIZE, "--json", "-")
    assert done.code == 0
    told(done)
    found = json.loads(done.out)
    assert found["name"] == "t/1"
    command = shlex.split(done.err.split("`")[1])
    kept = here(capsys, *command[1:-1], "kept", "--json", "grasps.json")
    assert kept.code == 0, kept
    listed = json.loads(Path("grasps.json").read_text())
    first = np.array(listed["grasps"][0]["contacts"])  # planned once more: the last digits move
    assert np.abs(first - found["contacts"]).max() < 1e-9
    # The same case three times: the file kept, the list, and the plan itself.
    Path("plan.json").write_text(done.out)
    for again in (["kept/1.json"], ["grasps.json"], ["plan.json"]):
        planned = json.loads(here(capsys, "plan", *again, "--json", "-").out)
        assert planned["sigma_max"] == pytest.approx(found["sigma_max"], rel=1e-6)
    names = {path.name for path in Path("kept").iterdir()}
    assert names == {f"{k}.json" for k in range(1, len(listed["grasps"]) + 1)}
    for k, row in enumerate(listed["grasps"], 1):
        case = icage.load(f"kept/{k}.json")
        assert case.name == f"t/{k}"
        assert np.array_equal(case.contacts, row["contacts"])
        assert case == icage.load("grasps.json", grasp=k)


def test_cases_of_an_earlier_search_go_and_files_of_others_stay(
    capsys: pytest.CaptureFixture[str],
):
    assert here(capsys, "grasps", "t.svg", *SIZE, "--top", "2", "--cases", "c").code == 0
    Path("c/notes.txt").write_text("mine")
    write_case(t_case(), Path("c/7.json"))
    assert here(capsys, "grasps", "t.svg", *SIZE, "--top", "1", "--cases", "c").code == 0
    assert {path.name for path in Path("c").iterdir()} == {"1.json", "7.json", "notes.txt"}
    write_case(t_case(), Path("c/1.json"))
    before = Path("c/1.json").read_bytes()
    line = here(capsys, "grasps", "t.svg", *SIZE, "--top", "1", "--cases", "c").error_line()
    assert "holds 1.json, which no search of icage has written" in line
    assert Path("c/1.json").read_bytes() == before


def test_cases_and_json_may_not_be_one_file(capsys: pytest.CaptureFixture[str]):
    Path("c").mkdir()
    command = ("grasps", "t.svg", *SIZE, "--cases", "c", "--json", "c/1.json")
    assert "is the name of a case in --cases c" in here(capsys, *command).error_line()


@pytest.mark.slow
def test_replay_keeps_its_cases_and_can_be_repeated_from_them(
    capsys: pytest.CaptureFixture[str],
):
    small = ("--no-video", "--trials", "4")
    done = here(capsys, "replay", "t.svg", *SIZE, "--grasps", "2", *small, "--out", "o")
    assert done.code == 0, done
    told(done, 2)
    cases = [icage.load(f"o/case-{k}.json") for k in (1, 2)]
    document = json.loads(Path("o/replay.json").read_text())
    assert document["name"] == "t"
    assert {run["grasp"] for run in document["runs"]} == {case.name for case in cases}
    again = here(capsys, "replay", "o/case-1.json", *small, "--out", "o")
    assert again.code == 0, again
    repeated = json.loads(Path("o/replay.json").read_text())
    assert repeated["sigma_range"] == document["sigma_range"]
    assert {path.name for path in Path("o").glob("case*")} == {"case-1.json"}


def test_a_study_keeps_its_case(capsys: pytest.CaptureFixture[str]):
    small = ("--trials", "4", "--no-figures")
    done = here(capsys, "study", "t.svg", *SIZE, *small, "--out", "s")
    assert done.code == 0, done
    told(done)
    document = json.loads(Path("s/study.json").read_text())
    assert document["config"]["case"] == str(Path("s") / "case.json")
    assert icage.load("s/case.json").contacts.tolist() == document["case"]["contacts"]
    again = here(capsys, "study", "s/case.json", *small, "--out", "s", "--resume")
    assert again.code == 0, again
    refused = here(capsys, "study", "--width", "60", "--out", "s", "--resume")
    assert "width is given without a CASE" in refused.error_line()


def test_query_and_figures_take_a_drawing(capsys: pytest.CaptureFixture[str]):
    Path("rows.csv").write_text("x,y,theta,sigma\n0,0,0,0.5\n")
    told(here(capsys, "query", "t.svg", "rows.csv", *SIZE))
    done = here(capsys, "figures", "t.svg", *SIZE, "--only", "sigma", "--out", "f")
    told(done)
    assert icage.load("f/case.json").name == "t/1"


def test_an_outline_without_a_grasp_stands_for_a_drawing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    path = without_grasp(tmp_path)
    told(here(capsys, "plan", str(path)))


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (["plan", "t.svg"], "a width is needed"),
        (["plan", "pliers", "--width", "9"], "for drawings"),
        (["plan", "pliers", "--finger-radius", "1"], "icage.regrasp"),
        (["plan", "t.svg", "--width", "60", "--grasp", "1"], "has no grasps"),
        (
            ["plan", "t.svg", "--width", "60", "--finger-radius", "99"],
            "up to the object's diameter",
        ),
        (["replay", "t.svg", "--width", "60", "--out", "o"], "--finger-radius"),
        (["replay", "pliers", "--grasps", "2", "--out", "o"], "comes with its grasp"),
    ],
)
def test_what_does_not_go_together_is_said(
    command: list[str], words: str, capsys: pytest.CaptureFixture[str]
):
    assert words in here(capsys, *command).error_line()
    assert not Path("o").exists()


@pytest.mark.parametrize("command", [["figures"], ["replay", "--no-video"], ["study"]])
def test_a_case_of_somebody_else_stays(command: list[str], capsys: Any):
    Path("o").mkdir()
    for name in ("case.json", "case-1.json"):
        write_case(t_case(), Path("o") / name)
    before = {path: path.read_bytes() for path in Path("o").iterdir()}
    line = here(capsys, command[0], "t.svg", *SIZE, *command[1:], "--out", "o").error_line()
    assert "which no search of icage has written" in line
    assert {path: path.read_bytes() for path in Path("o").iterdir()} == before
