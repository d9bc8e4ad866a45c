"""A slice of ``python -m benchmarks.faults``: commands on a disk that fails at one call."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.experiments.small import t_case, write_case
from tests.oracles.against_itself.faults import commands, tried, work_done_once

pytestmark = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks /proc")


@pytest.mark.parametrize("which", range(3), ids=["study", "replay", "plan"])
def test_old_results_intact_or_new_ones_whole(
    tmp_path: Path, which: int, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.delenv("ICAGE_DEBUG", raising=False)
    case = write_case(t_case(), tmp_path / "t.json")
    with work_done_once():
        told = tried(commands(case)[which], tmp_path / "runs", most=15, seed=1)
    assert told.broken == []
    assert told.faults == 15
    assert told.codes["2"] > 0
    assert told.calls > 30
