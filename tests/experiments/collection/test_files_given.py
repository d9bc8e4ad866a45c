"""Files and folders one by one, and what makes no table."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tests.experiments.collection.objects import (
    check_same,
)
from tests.experiments.commands.runner import here


def test_files_and_folders_give_the_rows_of_the_folder(
    alone: Path, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Whatever path leads to them, in any order; ``in/a.json`` keeps its name in a folder of it."""
    apart = folder.parent / "apart"
    (apart / "sub").mkdir(parents=True)
    (folder / "in").rename(apart / "sub" / "in")
    (folder / "a.json").rename(apart / "a.json")
    (folder / "t.json").rename(folder.parent / "t.json")
    given = ("t.json", "objects", "apart/../apart/a.json", str(apart / "sub"))
    monkeypatch.chdir(folder.parent)
    done = here(capsys, "grasps", *given, "--top", "2", "--out", "t.parquet", "--workers", "1")
    assert done.code == 0, done
    assert "4 files and folders: 4 objects, 3 with a grasp, 1 without; 3 searched now" in done.out
    check_same(folder.parent / "t.parquet", alone)


def test_more_files_go_on_with_the_table_of_one(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(folder)
    kept = ("--top", "2", "--out", "../t.parquet", "--workers", "1")
    assert "a.json: 1 objects, 1 with" in here(capsys, "grasps", "a.json", *kept).out
    assert "; 1 searched now" in here(capsys, "grasps", "t.json", "a.json", *kept).out
    found = pq.read_table("../t.parquet")["file"].to_pylist()
    assert sorted(set(found)) == ["a.json", "t.json"]


def test_a_reason_is_the_same_from_inside_the_folder(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """What is cut out of a reason is the way to the file, and nothing that looks like it."""
    far = {"format": "icage-case/1", "name": "far", "outline": {"file": "../gone.svg", "width": 1}}
    (folder / "in" / "far.json").write_text(json.dumps(far))
    monkeypatch.chdir(folder / "in")
    tables = []
    for k, given in enumerate(("far.json", str(folder / "in" / "far.json"), "../in/far.json")):
        out = f"{folder.parent}/{k}.parquet"
        assert here(capsys, "grasps", given, "--out", out, "--workers", "1").code == 0
        tables.append(pq.read_table(out).to_pylist())
    assert "outline: ../gone.svg does not exist" in tables[0][0]["why"]
    assert tables[0] == tables[1] == tables[2]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("a.json", "t.json"), "2 are given: --out FILE.parquet is needed"),
        (("a.json", "t.json", "--json", "-"), "--json is for one object; 2 are given"),
        (("a.json", "--out", "{}", "--cases", "c"), "--cases is for one object; --out is for"),
        (("a.json", "gone.svg", "--out", "{}"), "'gone.svg' is no file and no folder"),
        (("a.json", "notes.txt", "--out", "{}"), "'notes.txt' is no drawing (*.svg, "),
        (("a.json", "in/a.json", "--out", "{}"), "both 'a.json' in the table"),
        (("a.json", "./a.json", "--out", "{}"), "'a.json' is given twice"),
        ((".", "t.json", "--out", "{}"), "'t.json' is given twice"),
        (("a.json", "saw", "--out", "{}"), "'saw' is the shipped object"),
        (("a.json", "x" * 300 + ".svg", "--out", "{}"), "no folder to look into: file name too"),
    ],
)
def test_files_that_make_no_table(
    folder: Path,
    given: tuple[str, ...],
    words: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.chdir(folder)
    named = [one.format("../t.parquet") for one in given]
    assert words in here(capsys, "grasps", *named).error_line()
    assert [path.name for path in folder.parent.iterdir()] == [folder.name]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "is a folder: --out FILE.parquet is needed"),
        (("--out", "{}/table.csv"), "a name ending in .parquet is needed"),
        (("--out", "{}/none/table.parquet"), "there is no folder"),
        (("--out", "{}/t.parquet", "--json", "-"), "--json is for one object"),
        (("--out", "{}/t.parquet", "--cases", "{}/c"), "--cases is for one object"),
        (("--out", "{}/t.parquet", "--phi", "60", "120"), "--phi without --within lists"),
        (("--out", "{}/t.parquet", "--scheduler", "here"), "tcp://HOST:PORT is needed"),
    ],
)
def test_options_of_a_folder(
    folder: Path, options: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
):
    given = [option.format(folder.parent) for option in options]
    assert words in here(capsys, "grasps", str(folder), *given).error_line()
    assert [path.name for path in folder.parent.iterdir()] == [folder.name]


def test_options_of_one_object(folder: Path, capsys: pytest.CaptureFixture[str]):
    line = here(capsys, "grasps", "pliers", "--out", f"{folder}/t.parquet").error_line()
    assert "'pliers' is the shipped object, and a table is of files and folders" in line
    one = str(folder / "t.json")
    line = here(capsys, "grasps", one, "--scheduler", "tcp://127.0.0.1:1").error_line()
    assert "--scheduler is for a table: --out FILE.parquet is needed" in line
    line = here(capsys, "grasps", "x" * 300).error_line()
    assert "cannot be a file" in line


def test_a_folder_without_objects(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    (tmp_path / ".a.json").write_text("{}")
    line = here(capsys, "grasps", str(tmp_path), "--out", f"{tmp_path}/t.parquet").error_line()
    assert "holds no drawing (*.svg, *.dxf" in line
    assert [path.name for path in tmp_path.iterdir()] == [".a.json"]
