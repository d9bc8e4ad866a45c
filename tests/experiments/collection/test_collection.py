"""``icage grasps`` of many objects: one table, whoever makes it, however often it is broken off."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from experiments.cli import main
from experiments.collection import rows
from experiments.collection.kept_rows import KeptRows
from experiments.environment import ROOT
from tests.experiments.commands.runner import Result, here

TRIANGLE = [[0, 0], [4, 0], [0, 3]]
L = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]
T = [[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1]]
OBJECTS = {"a.json": TRIANGLE, "in/a.json": L, "t.json": T}
SEARCHED = len(OBJECTS)
BROKEN = "no.svg"
FILES = ["a.json", "in/a.json", BROKEN, "t.json"]


def write_outline(path: Path, vertices: Any, **changed: Any) -> None:
    path.parent.mkdir(exist_ok=True)
    case = {"format": "icage-case/1", "name": path.stem, "unit": "mm"}
    path.write_text(json.dumps({**case, "outline": {"vertices": vertices}, **changed}))


def objects_in(place: Path) -> Path:
    """A folder of three small objects, two of one name, and a drawing that is none."""
    place.mkdir()
    for name, vertices in OBJECTS.items():
        write_outline(place / name, vertices)
    (place / BROKEN).write_text("<svg nonsense")
    (place / "notes.txt").write_text("no object")
    (place / ".hidden.json").write_text("{}")
    return place


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return objects_in(tmp_path / "objects")


@pytest.fixture
def grasps(folder: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., Result]:
    """The command, with a table beside the folder."""

    def run(*options: str, out: str = "table.parquet") -> Result:
        table = str(folder.parent / out)
        return here(capsys, "grasps", str(folder), "--out", table, "--top", "2", *options)

    return run


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The table by one worker that nothing has disturbed."""
    place = tmp_path_factory.mktemp("alone")
    table = place / "table.parquet"
    command = ("grasps", str(objects_in(place / "objects")), "--out", str(table), "--top", "2")
    assert main([*command, "--workers", "1"]) == 0
    return table


@pytest.fixture
def begun(folder: Path) -> Path:
    """A search that was killed, without a chance to clean up, when one object was kept."""
    killed = """
import os, signal, sys
from experiments.cli import main
from experiments.cli import main
from experiments.collection import rows
from experiments.collection.kept_rows import KeptRows
keep = KeptRows.keep
def last(self, *given):
    keep(self, *given)
    os.kill(os.getpid(), signal.SIGKILL)
KeptRows.keep = last
main(sys.argv[1:])
"""
    table = folder.parent / "table.parquet"
    words = ("grasps", str(folder), "--out", str(table), "--top", "2", "--workers", "1")
    done = subprocess.run([sys.executable, "-c", killed, *words], cwd=ROOT, timeout=300)
    assert done.returncode == -9
    assert not table.exists()
    assert len(parts(table)) == 1
    return table


def parts(table: Path) -> list[Path]:
    return sorted(table.with_name(f".{table.name}.parts").glob("*"))


def check_same(table: Path, alone: Path) -> None:
    """To the last byte, and nothing is left beside it."""
    assert table.read_bytes() == alone.read_bytes()
    assert [path.name for path in table.parent.glob(".*")] == []


# ---------------------------------------------------------------------------- what is in it


def test_a_row_a_grasp_or_a_reason(alone: Path):
    found = pq.read_table(alone).to_pylist()
    assert [row["file"] for row in found if row["rank"] in (1, None)] == FILES
    assert len({row["seed"] for row in found}) == len(FILES)
    for row in found:
        if row["file"] == BROKEN:
            assert row["why"] == "not an SVG file: unclosed token, line 1 column 1"
            assert {v for k, v in row.items() if k not in ("file", "digest", "seed", "why")} == {
                None
            }
        else:
            assert row["why"] is None
            assert row["sigma_0"] < row["sigma_first"] <= row["sigma_max"]
            assert row["score"] == row["sigma_first"] / row["sigma_0"]


def test_the_grasps_of_a_row_are_those_of_its_file_with_its_seed(
    alone: Path, folder: Path, capsys: pytest.CaptureFixture[str]
):
    mine = [row for row in pq.read_table(alone).to_pylist() if row["file"] == "t.json"]
    seed = str(mine[0]["seed"])
    one = here(capsys, "grasps", str(folder / "t.json"), "--seed", seed, "--json", "-")
    found = json.loads(one.out)["grasps"]
    assert len(found) >= len(mine) == 2
    for row, grasp in zip(mine, found, strict=False):
        assert [[row[f"x_{k}"], row[f"y_{k}"]] for k in (1, 2, 3)] == grasp["contacts"]
        for name in ("score", "sigma_0", "sigma_first", "sigma_max", "free_gap", "alike"):
            assert row[name] == grasp[name]


def test_what_is_asked_goes_with_the_table(alone: Path):
    words = pq.read_schema(alone).metadata[b"icage-grasp-table"]
    document = json.loads(words)
    assert document["format"] == "icage-grasp-table/1"
    assert document["options"]["top"] == 2
    assert "numpy" in document["versions"]


# ---------------------------------------------------------------------------- who makes it


def test_two_workers(alone: Path, folder: Path, grasps: Callable[..., Result]):
    done = grasps("--workers", "2")
    assert done.code == 0
    assert done.err == f"icage: {BROKEN}: not an SVG file: unclosed token, line 1 column 1\n"
    assert f"4 objects, 3 with a grasp, 1 without; {SEARCHED} searched now" in done.out
    check_same(folder.parent / "table.parquet", alone)


def test_a_cluster(alone: Path, folder: Path, grasps: Callable[..., Result]):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp",
        host="127.0.0.1", dashboard_address=None,
    ) as cluster:  # fmt: skip
        done = grasps("--scheduler", cluster.scheduler_address)
    assert done.code == 0, done
    check_same(folder.parent / "table.parquet", alone)


# ---------------------------------------------------------------------------- broken off


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_killed_and_gone_on_with(alone: Path, begun: Path, grasps: Callable[..., Result]):
    half = begun.with_name(f".{begun.stem}.0123abcd.parquet")
    half.write_bytes(b"half a table")
    assert f"{SEARCHED - 1} searched now" in grasps("--workers", "1").out
    check_same(begun, alone)


def test_interrupted(
    alone: Path, folder: Path, grasps: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
):
    keep = KeptRows.keep

    def interrupted(self: KeptRows, *given: Any) -> None:
        keep(self, *given)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(KeptRows, "keep", interrupted)
        assert grasps("--workers", "1").code == 130
    table = folder.parent / "table.parquet"
    assert len(parts(table)) == 1
    assert f"{SEARCHED - 1} searched now" in grasps().out
    check_same(table, alone)


def test_a_killed_worker_ends_the_command_and_loses_nothing(
    alone: Path, folder: Path, grasps: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
):
    keep = KeptRows.keep

    def killing(self: KeptRows, *given: Any) -> None:
        keep(self, *given)
        for worker in multiprocessing.active_children():
            worker.kill()

    with monkeypatch.context() as patch:
        patch.setattr(KeptRows, "keep", killing)
        line = grasps("--workers", "2").error_line()
    assert line.startswith("a process that searched was killed")
    kept = len(parts(folder.parent / "table.parquet"))
    assert kept >= 1
    assert f"{SEARCHED - kept} searched now" in grasps("--workers", "1").out
    check_same(folder.parent / "table.parquet", alone)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks /proc")
def test_workers_end_with_the_command_that_was_killed(folder: Path):
    killed = """
import multiprocessing, os, signal, sys
from experiments.cli import main
from experiments.collection.kept_rows import KeptRows
def last(self, *given):
    print(*(child.pid for child in multiprocessing.active_children()), flush=True)
    os.kill(os.getpid(), signal.SIGKILL)
KeptRows.keep = last
if __name__ == "__main__":
    main(sys.argv[1:])
"""
    words = ("grasps", str(folder), "--out", str(folder.parent / "t.parquet"), "--workers", "2")
    done = subprocess.run(
        [sys.executable, "-c", killed, *words], cwd=ROOT, timeout=300, stdout=subprocess.PIPE
    )  # returns when nobody holds standard output any more: workers would
    assert done.returncode == -9
    workers = done.stdout.split()
    assert len(workers) == 2
    for worker in workers:
        place = Path("/proc", worker.decode(), "stat")
        assert not place.exists() or place.read_text().rpartition(")")[2].split()[0] in "ZX"


def test_a_part_with_a_hole_is_searched_again(
    alone: Path, begun: Path, grasps: Callable[..., Result]
):
    (part,) = parts(begun)
    whole = bytearray(part.read_bytes())
    whole[100:200] = bytes(100)
    part.write_bytes(whole)
    assert f"{SEARCHED} searched now" in grasps("--workers", "1").out
    check_same(begun, alone)


def test_other_options_are_refused(begun: Path, grasps: Callable[..., Result]):
    (part,) = parts(begun)
    before = part.read_bytes()
    line = grasps("--seed", "5", "--finger-radius", "0.1").error_line()
    assert "holds another search: finger_radius was None, is 0.1; seed was 0, is 5" in line
    assert part.read_bytes() == before
    assert not begun.exists()


def test_two_at_once_are_refused(begun: Path, grasps: Callable[..., Result]):
    with KeptRows(begun, {}).alone():
        assert "another icage grasps is running in" in grasps().error_line()


# ---------------------------------------------------------------------------- again


def test_only_what_is_new_or_changed_is_searched(
    alone: Path, folder: Path, grasps: Callable[..., Result]
):
    table = folder.parent / "table.parquet"
    shutil.copy(alone, table)
    assert "; 0 searched now" in grasps().out
    check_same(table, alone)
    write_outline(folder / "a.json", [[0, 0], [4, 0], [0, 2.5]])
    (folder / BROKEN).unlink()
    assert "3 objects, 3 with a grasp, 0 without; 1 searched now" in grasps().out
    was, now = (pq.read_table(path).to_pylist() for path in (alone, table))
    kept = [row for row in was if row["file"] in ("in/a.json", "t.json")]
    assert [row for row in now if row["file"] != "a.json"] == kept
    assert {row["diameter"] for row in now if row["file"] == "a.json"} == {(16 + 6.25) ** 0.5}


def test_a_finished_table_of_another_search_stays(
    alone: Path, folder: Path, grasps: Callable[..., Result]
):
    table = folder.parent / "table.parquet"
    shutil.copy(alone, table)
    assert (
        "holds another search: aim was 'first', is 'cage'" in grasps("--aim", "cage").error_line()
    )
    check_same(table, alone)


def test_no_table_of_grasps_is_not_replaced(folder: Path, grasps: Callable[..., Result]):
    table = folder.parent / "table.parquet"
    for content in (b"mine", b""):
        table.write_bytes(content)
        assert "is no table of grasps and is not replaced" in grasps().error_line()
        assert table.read_bytes() == content


# ---------------------------------------------------------------------------- objects that fail


@pytest.mark.skipif(sys.platform != "linux", reason="file names and pipes of Linux")
def test_every_object_fails_by_itself(folder: Path, grasps: Callable[..., Result]):
    """Nothing that lies in a folder ends the search of the others."""
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "a drawing.svg").mkdir()
    write_outline(folder / "a drawing.svg" / "big fingers.json", TRIANGLE, finger_radius=6.0)
    write_outline(folder / "no room.json", TRIANGLE)
    write_outline(folder / "crossed.json", [[0, 0], [1, 1], [1, 0], [0, 1]])
    write_outline(folder / "far.json", {"file": "../gone.svg"})
    (folder / "deep.json").write_text("[" * 100_000)
    (folder / "empty.SVG").write_text("")
    (folder / "link.json").symlink_to("nowhere.json")
    os.mkfifo(folder / "pipe.json")
    (folder / "line\nbreak.json").write_text("{}")
    Path(os.fsdecode(os.fsencode(folder) + b"/\xff.json")).write_text("{}")
    assert grasps("--least-gap", "100", "--workers", "1").code == 0
    found = pq.read_table(folder.parent / "table.parquet").to_pylist()
    assert len(found) == 10
    whys = {row["file"]: row["why"] for row in found}
    assert all(why and why.isprintable() and "internal" not in why for why in whys.values())
    assert whys["a drawing.svg/big fingers.json"] == "--finger-radius 6: the object's diameter is 5"
    assert whys["no room.json"].startswith("no immobilizing three-finger grasp was found")
    assert whys["pipe.json"] == "this is no regular file"
    assert "'link.json' does not exist" in whys["link.json"]
    assert str(folder) not in "".join(whys.values())
    assert "\\xff.json" in whys


def test_a_fault_of_our_own_is_one_row(
    folder: Path, grasps: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
):
    def fault(*_: Any) -> None:
        raise ZeroDivisionError("of ours")

    monkeypatch.setattr(rows, "best_of_case", fault)
    assert grasps("--workers", "1").code == 0
    found = pq.read_table(folder.parent / "table.parquet").to_pylist()
    why = {row["why"] for row in found if row["file"] != BROKEN}
    assert why == {"internal: ZeroDivisionError: of ours (our fault)"}
    assert {row["vertices"] for row in found if row["file"] == "a.json"} == {3}


# ---------------------------------------------------------------------------- files one by one


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
