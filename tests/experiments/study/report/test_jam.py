"""A jam is two or three forces in balance, each inside its cone of friction."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from experiments.study.report.jam import draw_jam, presses
from experiments.study.run.one_trial_again import rerun_trial
from icage.errors import InputError
from tests.experiments.commands.runner import here
from tests.experiments.small import t_case, write_case


def study(tmp_path: Path, capsys: Any, *arguments: str) -> Path:
    case, out = write_case(t_case(), tmp_path / "t.json"), tmp_path / "out"
    done = here(capsys, "study", str(case), *arguments, "--out", str(out), "--no-figures")
    assert done.code == 0, done
    return out


def test_forces_of_a_jam_balance_inside_their_cones(tmp_path: Path, capsys: Any) -> None:
    out = study(tmp_path, capsys, "--trials", "24", "--vary", "friction=0.9")
    jams = [
        row["trial"]
        for row in pq.read_table(out / "trials.parquet").to_pylist()
        if row["outcome"] == "jammed"
    ]
    assert len(jams) > 3
    for trial in jams[:4]:
        done = rerun_trial(out, trial)
        assert not done.differences
        found = presses(done)
        assert len(found) >= 2
        forces = np.array([one.force for one in found])
        most = np.hypot(*forces.T).max()
        assert np.hypot(*forces.sum(axis=0)) < 0.02 * most
        for one in found:
            along = one.force @ one.inward
            across = abs(one.force[0] * one.inward[1] - one.force[1] * one.inward[0])
            assert across <= 0.9 * along * (1.0 + 1e-6) + 1e-6 * most
    draw_jam(rerun_trial(out, jams[0]), tmp_path / "jam.svg")
    assert b"<svg" in (tmp_path / "jam.svg").read_bytes()[:1000]


def test_what_was_not_closed_has_no_forces(tmp_path: Path, capsys: Any) -> None:
    out = study(tmp_path, capsys, "--trials", "8", "--vary", "place_xy=normal:30%")
    rows = pq.read_table(out / "trials.parquet").to_pylist()
    collided = next(row["trial"] for row in rows if row["outcome"] == "collision")
    with pytest.raises(InputError, match="no contact"):
        draw_jam(rerun_trial(out, collided), tmp_path / "jam.svg")
    found = json.loads((out / "study.json").read_text())["found"]
    assert found["outcomes"]["collision"] == sum(row["outcome"] == "collision" for row in rows)
    assert "inside the object" in (out / "results.md").read_text()
