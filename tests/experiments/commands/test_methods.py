"""``icage plan --method``: the paper's search beside the cells, and a loud failure."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from models import CASES
from tests.experiments.commands.runner import here

GOLDEN = str(CASES / "tunnel_golden.json")


def planned(capsys: Any, *options: str) -> dict[str, Any]:
    result = here(capsys, "plan", GOLDEN, "--json", "-", *options)
    assert result.code == 0, result
    return json.loads(result.out)


def test_the_contact_space_adds_the_course_of_its_search(capsys: Any) -> None:
    cells, other = planned(capsys), planned(capsys, "--method", "contact-space")
    assert other.keys() - cells.keys() == {"search"}
    for key in ("sigma_0", "sigma_first", "sigma_max"):
        assert other[key] == pytest.approx(cells[key], rel=1e-9)
    search = other["search"]
    assert search.keys() == {
        "iterations", "rectangles_explored", "rectangles_total", "nodes",
        "tunnel_edges_tried", "tunnel_edges_used",
    }  # fmt: skip
    assert search["iterations"][0].keys() == {"sigma", "pair", "edges", "kind"}
    assert search["rectangles_total"] == 243
    assert search["tunnel_edges_used"] == 1
    assert other["regions"] == cells["regions"]


def test_both_say_that_they_agree(capsys: Any) -> None:
    result = here(capsys, "plan", GOLDEN, "--method", "both")
    assert result.code == 0
    assert "agree to 1e-7" in result.out
    assert planned(capsys, "--method", "both")["search"]["tunnel_edges_used"] == 1


def test_a_disagreement_is_exit_1_with_both_numbers(
    capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from experiments.cases import by_methods as methods

    true_plan = methods.plan

    def off(outline: Any, contacts: Any, radius: float, *engine: Any) -> Any:
        cage = true_plan(outline, contacts, radius, *engine)
        return replace(cage, sigma_max=cage.sigma_max * (1.0 + 2e-7)) if engine else cage

    monkeypatch.setattr(methods, "plan", off)
    result = here(capsys, "plan", GOLDEN, "--method", "both")
    assert result.code == 1
    assert "disagree: sigma_max: 4.30777738" in result.err
    assert " against 4.3077782" in result.err


def test_without_tunnels_sigma_max_is_too_high(capsys: Any) -> None:
    document = planned(capsys, "--method", "contact-space", "--no-tunnels")
    assert document["sigma_max"] == pytest.approx(4.454539874, rel=1e-9)


def test_no_tunnels_goes_with_the_contact_space_only(capsys: Any) -> None:
    line = here(capsys, "plan", GOLDEN, "--no-tunnels").error_line()
    assert "--method contact-space" in line
    assert "cells" in here(capsys, "plan", GOLDEN, "--method", "magic").error_line()
