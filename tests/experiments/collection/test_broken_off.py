"""However often a search of many objects is broken off, the table is the same."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from experiments.collection.kept_rows import KeptRows
from experiments.environment import ROOT
from tests.experiments.collection.objects import (
    SEARCHED,
    check_same,
    parts,
)
from tests.experiments.commands.runner import Result
from tests.killed import killed


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_killed_and_gone_on_with(alone: Path, begun: Path, grasps: Callable[..., Result]):
    killed(begun.parent)
    mine = begun.with_name(f".{begun.stem}.0123abcd.parquet")
    mine.write_bytes(b"only looks like half a table")
    assert f"{SEARCHED - 1} searched now" in grasps("--workers", "1").out
    mine.unlink()
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
    assert line.startswith("a process that worked for this one was killed")
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
