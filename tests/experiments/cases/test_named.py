"""What a name on the command line stands for: a shipped object, its grasp, or a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from experiments.environment import ROOT
from experiments.study.run.session import _case, _with_file
from icage.errors import InputError
from icage.formats.case_json import read_case
from icage.formats.load import is_shipped, load, load_object, named
from models import case_path, case_paths, grasp_cases, object_names, outline_path
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


@pytest.mark.parametrize("name", object_names())
def test_a_shipped_object_is_all_its_grasps_and_its_outline(name: str):
    found = named(name)
    assert (found.shipped, found.cases) == (name, case_paths(name))
    assert found.outline == outline_path(name)
    assert load(name).name == read_case(case_path(name)).name


@pytest.mark.parametrize("name", list(grasp_cases()))
def test_a_shipped_grasp_is_a_case_of_its_own(name: str):
    found = named(name)
    assert (found.shipped, found.cases) == (None, (found.outline,))
    owner, grasp = name.split("/")
    assert found.outline in case_paths(owner)
    assert found.outline.stem == grasp
    vertices = (one(name).outline.vertices for one in (load_object, load))
    assert np.array_equal(*vertices)


def test_a_file_comes_before_a_shipped_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pliers").mkdir()  # a folder is no case
    assert named("pliers").shipped == "pliers"
    write_case(t_case(), tmp_path / "pliers" / "1_best")
    write_case(t_case(), tmp_path / "saw")
    for name in ("saw", "pliers/1_best"):
        assert named(name).shipped is None
        assert named(name).cases == (Path(name),)
        assert load(name).name == "T"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("spoon", "'spoon' does not exist; shipped objects: pliers, saw, wrench"),
        ("pliers/9_none", "shipped grasps of pliers: pliers/1_best, pliers/2_paper_shape"),
        ("spoon/1_best", "'spoon/1_best' does not exist; shipped objects: pliers, saw, wrench"),
        ("x" * 5000, "cannot be a file"),
    ],
)
def test_a_name_that_is_nothing_says_what_there_is(text: str, words: str):
    assert not is_shipped(text)
    with pytest.raises(InputError, match=words):
        named(text)


@pytest.mark.parametrize(
    "command",
    [
        ["plan"], ["query", "rows.csv"], ["figures", "--out", "o"], ["escape"], ["shake"],
        ["replay", "--out", "o"], ["study", "--out", "o"], ["grasps"],
    ],
    ids=lambda words: words[0],
)  # fmt: skip
@pytest.mark.parametrize("name", ["spoon", "pliers/9_none"])
def test_every_command_says_the_same_of_it(
    command: list[str], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
):  # fmt: skip
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as said:
        named(name)
    done = here(capsys, command[0], name, *command[1:])
    assert (done.code, done.err) == (2, f"icage: error: {said.value}\n")


def test_a_study_knows_the_same_names(tmp_path: Path):
    assert _case({"case": "pliers", "grasp": 2}).name == load("pliers/2_paper_shape").name
    assert _case({"case": "pliers/2_paper_shape"}).name == load("pliers/2_paper_shape").name
    with pytest.raises(InputError, match="a case file has one grasp"):
        _case({"case": "pliers/1_best", "grasp": 2})
    file = tmp_path / "study.toml"
    for name, expected in {
        "pliers": "pliers", "pliers/1_best": "pliers/1_best", "t.json": str(tmp_path / "t.json"),
    }.items():  # fmt: skip
        file.write_text(f'case = "{name}"\n')
        assert _with_file(file, {})["case"] == expected


def test_nobody_else_decides_it():
    """Files that look into the models: the one that decides, and three that list what there is."""
    looking = {
        str(path.relative_to(ROOT))
        for package in ("icage", "sim", "experiments")
        for path in (ROOT / package).rglob("*.py")
        if any(word in path.read_text(encoding="utf-8") for word in
               ("object_names", "case_path", "outline_path", "grasp_cases"))
    }  # fmt: skip
    assert looking == {
        "icage/formats/load.py",
        "experiments/jams/__main__.py",
        "experiments/regress/cases.py",
        "experiments/study/ready/__main__.py",
    }
