from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from models import CASES
from tests.experiments.commands.runner import here, process

CASE = str(CASES / "L_best.json")


def table(*rows: tuple[float, ...]) -> str:
    return "x,y,theta,sigma\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)


def query(capsys: Any, folder: Path, *rows: tuple[float, ...]) -> list[dict[str, Any]]:
    file = folder / "placements.csv"
    file.write_text(table(*rows))
    result = here(capsys, "query", CASE, str(file), "--json", "-")
    assert result.code == 0, result
    document = json.loads(result.out)
    assert document["format"] == "icage-query/1"
    return document["results"]


def target(capsys: Any) -> dict[str, Any]:
    return json.loads(here(capsys, "plan", CASE, "--json", "-").out)


def test_one_answer_a_row_in_order(tmp_path: Path, capsys: Any):
    plan = target(capsys)
    x, y, theta, sigma = plan["escape_path"][0]
    answers = query(capsys, tmp_path, (x, y, theta, sigma), (1e6, 1e6, 0.0, 1.0), (x, y, 0.0, 0.0))
    at_target, far, pinched = answers
    assert at_target["verdict"] == "target"
    assert at_target["in_cage"] is True
    assert at_target["grasps"] == [0]
    assert at_target["sigma"] == sigma
    assert at_target["margin"] == pytest.approx(plan["sigma_max"] - sigma)
    assert at_target["target_margin"] == pytest.approx(plan["sigma_first"] - sigma)
    for other in (far, pinched):
        assert other["verdict"] == "escapes"
        assert other["in_cage"] is False
        assert (other["margin"], other["target_margin"], other["grasps"]) == (0, None, [])


def test_a_table_without_rows_has_no_answers(tmp_path: Path, capsys: Any):
    assert query(capsys, tmp_path) == []


def test_placements_from_standard_input_as_a_user_sees_it():
    result = process("query", CASE, "-", stdin=table((1e6, 1e6, 0.0, 1.0)).encode())
    assert result.code == 0
    assert result.out.startswith("1 placements: 0 target, 0 caged, 0 other, 1 escapes")


def test_a_long_summary_counts_what_it_does_not_show(tmp_path: Path, capsys: Any):
    file = tmp_path / "many.csv"
    file.write_text(table(*[(1e6, k, 0.0, 1.0) for k in range(50)]))
    result = here(capsys, "query", CASE, str(file))
    assert result.out.count("\n") == 22
    assert "30 more" in result.out
