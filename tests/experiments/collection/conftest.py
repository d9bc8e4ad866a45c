"""A folder, the command on it, the table that it makes, and one that was broken off."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from experiments.cli import main
from experiments.environment import ROOT
from tests.experiments.collection.objects import (
    objects_in,
    parts,
)
from tests.experiments.commands.runner import Result, here


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


@pytest.fixture(scope="session")
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
