"""What the commands print says what the numbers are: openings, intervals, radii, angles."""

from __future__ import annotations

import importlib
import json
import math
import pkgutil
import re
from pathlib import Path
from typing import Any

import pytest

import experiments.commands
from experiments.environment import ROOT
from icage.hand import HandShape
from models import CASES
from tests.experiments.commands.runner import here

HAMMER = str(CASES / "disc_hammer.json")
COMMANDS = sorted(
    module.name.replace("_", "-")
    for module in pkgutil.iter_modules(experiments.commands.__path__)
    if hasattr(importlib.import_module(f"experiments.commands.{module.name}"), "add_parser")
)


def help_of(command: str, capsys: Any) -> str:
    result = here(capsys, command, "--help")
    assert result.code == 0
    return result.out


def test_a_query_tells_openings_and_no_room(tmp_path: Path, capsys: Any):
    plan = json.loads(here(capsys, "plan", HAMMER, "--json", "-").out)
    x, y, theta, sigma = plan["escape_path"][0]
    last = plan["escape_path"][-2]
    file = tmp_path / "p.csv"
    file.write_text(f"x,y,theta,sigma\n{x},{y},{theta},{sigma}\n{','.join(map(str, last))}\n")
    _, target, out = here(capsys, "query", HAMMER, str(file)).out.splitlines()
    more = f"{plan['sigma_max'] - sigma:.6g} m"
    assert f"may open by {more} before the object can escape" in target
    assert f"by {plan['sigma_first'] - sigma:.6g} m before closing may end elsewhere" in target
    assert "margin" not in target
    assert "may open" not in out
    never = CASES / "never_escapes_b.json"
    plan = json.loads(here(capsys, "plan", str(never), "--json", "-").out)
    hand = HandShape.from_contacts(plan["contacts"])
    (a, b), sigma = plan["contacts"][:2], plan["sigma_0"]
    theta = math.atan2(b[1] - a[1], b[0] - a[0])
    assert hand.phi_deg == pytest.approx(plan["hand"]["phi_deg"])
    file.write_text(f"x,y,theta,sigma\n{a[0]},{a[1]},{theta},{sigma}\n")
    line = here(capsys, "query", str(never), str(file)).out.splitlines()[1]
    assert "however far it opens the object cannot escape" in line


def test_a_plan_says_where_the_object_is_free_and_which_region_to_draw(capsys: Any):
    plan = json.loads(here(capsys, "plan", HAMMER, "--json", "-").out)
    told = here(capsys, "plan", HAMMER).out
    assert f"the object is free from row {plan['escape_free_at']} on" in told
    assert "draw the inner, safe ones" in told
    assert "disc fingers of radius 0.05 m" in told
    assert "(phi_1, phi_2) = (71.57, 156.5) deg" in told
    assert "The inner one is on the safe side" in re.sub(r"\s+", " ", help_of("plan", capsys))


def test_the_sketch_of_the_angles_is_in_help_and_formats(capsys: Any):
    """In both, and the hand that they call equilateral is."""
    sketch = [r"/ phi_1 \ phi_2", "1---------2 - - - ->"]
    for text in (help_of("grasps", capsys), (ROOT / "docs/formats.md").read_text()):
        assert all(line in text for line in sketch)
        flat = re.sub(r"\s+", " ", text)
        assert "an equilateral hand is (60, 120), not (60, 60)" in flat
    z = HandShape.from_angles_deg(60.0, 120.0).z_3
    assert abs(z) == pytest.approx(1.0)
    assert abs(z - 1.0) == pytest.approx(1.0)
    line = here(capsys, "grasps", HAMMER, "--phi", "60", "60").error_line()
    assert "an equilateral hand is (60, 120)" in line


@pytest.mark.parametrize("command", COMMANDS)
def test_no_help_text_is_a_scrap(command: str, capsys: Any):
    """No option is explained by its default alone."""
    text = re.sub(r"\s+", " ", help_of(command, capsys))
    assert not re.search(r"(--[\w-]+|[A-Z]) default\b", text)


def test_a_disc_is_never_told_by_a_bare_length():
    """6 mm is a radius: every page says so."""
    for path in (ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *ROOT.glob("models/**/*.md")):
        text = re.sub(r"\s+", " ", path.read_text(encoding="utf-8"))
        assert not re.search(r"\b(discs?|fingers) of [\d.]+", text), path
