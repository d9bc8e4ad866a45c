"""Interpreted kernels give the digits of compiled ones, on every case that the repository ships."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from experiments.environment import ROOT


def documents(folder: Path, kind: str, **environment: str) -> dict[str, str]:
    folder.mkdir()
    subprocess.run(
        [sys.executable, "-W", "error", "-m", "tests.icage.kernels.documents", str(folder), kind],
        check=True, cwd=ROOT, env={**os.environ, **environment},
    )  # fmt: skip
    return {file.name: file.read_text() for file in folder.iterdir()}


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "least"), [("point", 20), ("disc", 2)])
def test_the_plan_documents_are_the_same(tmp_path: Path, kind: str, least: int) -> None:
    machine = documents(tmp_path / "machine", kind)
    plain = documents(tmp_path / "plain", kind, NUMBA_DISABLE_JIT="1")
    assert len(machine) >= least
    assert [name for name in machine if machine[name] != plain[name]] == []
    assert machine.keys() == plain.keys()
