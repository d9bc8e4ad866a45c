"""The table of many objects: what is in it, whoever makes it, and made again."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tests.experiments.collection.objects import (
    BROKEN,
    FILES,
    SEARCHED,
    check_same,
    write_outline,
)
from tests.experiments.commands.runner import Result, here

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
