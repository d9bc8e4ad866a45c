"""Grasps that keep their guarantee with friction: what their README says, planned again."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from icage.formats.case_json import read_case
from icage.planner import plan
from models import FRICTION, object_names

MU = 0.3
CASES = sorted(FRICTION.glob("*.json"))


def test_every_tool_has_one() -> None:
    assert [path.stem for path in CASES] == [f"{name}_friction" for name in object_names()]


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_twentieth_of_the_opening_is_kept(path: Path) -> None:
    cage = plan(read_case(path))
    level = cage.friction(MU).sigma_first
    assert level is not None
    assert cage.sigma_first is not None
    assert level / cage.sigma_0 >= 1.05
    said = re.search(rf"\| `{path.stem}` \|[^|]*\| ([\d.]+) \| ([\d.]+) \|",
                     (FRICTION / "README.md").read_text(encoding="utf-8"))  # fmt: skip
    assert said is not None
    assert float(said[1]) == pytest.approx(cage.sigma_first / cage.sigma_0, abs=6e-5)
    assert float(said[2]) == pytest.approx(level / cage.sigma_0, abs=6e-5)
