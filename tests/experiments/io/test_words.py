"""No name, whatever it is made of, is obeyed by a terminal, a page or a figure."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from experiments.figures.plan import draw_plan
from experiments.io.one_line import PrintableStream, markdown
from experiments.regress.junit import junit
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case
from tests.experiments.study.studies import Studied

HOSTILE = "red \x1b[31m bell \x07 back \u202e \r gone"


def test_a_folder_with_control_characters_is_shown_as_escapes(tmp_path: Path, capsys: Any):
    study = Studied(tmp_path / HOSTILE, capsys)
    study.path.parent.mkdir(exist_ok=True)
    result = study.run("--trials", "5")
    assert result.code == 0
    for text in (result.out, result.err):
        assert all(line.isprintable() for line in text.splitlines())
    assert "\\x1b[31m" in result.out
    page = (study.path / "results.md").read_text()
    assert all(line.isprintable() for line in page.split("\n"))


def test_markup_in_a_name_stands_for_itself_on_the_page(tmp_path: Path, capsys: Any):
    name = "<img src=x> **bold** [a](b) $x_1$ | `c`"
    write_case(replace(t_case(), name=name), tmp_path / "t.json")
    study = Studied(tmp_path / "out", capsys)
    assert study.run("--trials", "5").code == 0
    page = (study.path / "results.md").read_text()
    assert name not in page
    assert f"# Study: {markdown(name)}\n" in page
    assert json.loads((study.path / "study.json").read_text())["name"] == name


@pytest.mark.parametrize("name", ["$x$", "$\\frac$ half", "a $ b", "\\$"])
def test_dollars_in_a_name_are_no_mathematics(tmp_path: Path, name: str, monkeypatch: Any):
    """``$\\frac$`` is no formula: matplotlib raised."""
    import icage

    drawn: list[str] = []
    real = __import__("matplotlib.text", fromlist=["Text"]).Text._preprocess_math

    def looked_at(self: Any, text: str) -> Any:
        drawn.append(str(real(self, text)))
        return real(self, text)

    monkeypatch.setattr("matplotlib.text.Text._preprocess_math", looked_at)
    case = icage.load("pliers")
    draw_plan(icage.plan(case), (), name, case.unit, tmp_path / "plan.svg")
    assert str((name, False)) in drawn


def test_junit_takes_any_name():
    text = junit([{"case": "a\x00b", "failures": ["\x1b[0m"]}], [0.0])
    assert "\\x00" in text
    assert "\x1b" not in text


def test_a_stream_lets_lines_and_tabs_through(tmp_path: Path):
    path = tmp_path / "out"
    with path.open("w", newline="") as file:
        print("a\tb", "\x1b[1m", file=PrintableStream(file))  # pyright: ignore[reportArgumentType]
    assert path.read_text() == "a\tb \\x1b[1m\n"


def test_a_path_that_is_no_text_is_refused_before_anything_runs(tmp_path: Path, capsys: Any):
    place = str(tmp_path / "b\udcff")
    for command in (("study",), ("replay",), ("figures",)):
        line = here(capsys, *command, "pliers", "--out", place).error_line()
        assert "is no UTF-8 text" in line
    line = here(capsys, "plan", "pliers", "--json", place).error_line()
    assert "is no UTF-8 text" in line
    assert not list(tmp_path.iterdir())


def test_a_folder_where_a_file_is_to_be(tmp_path: Path, capsys: Any):
    (tmp_path / "replay.mp4").mkdir()
    line = here(capsys, "replay", "pliers", "--out", str(tmp_path)).error_line()
    assert "replay.mp4 is a folder there" in line
    assert [path.name for path in tmp_path.iterdir()] == ["replay.mp4"]
