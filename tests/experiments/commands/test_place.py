"""``icage place``: its document, its lines, its figure, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import icage
from models import CASES
from tests.experiments.commands.runner import here

PLIERS = str(CASES / "pliers_best.json")


def document(capsys: Any, *options: str, case: str = PLIERS) -> dict[str, Any]:
    result = here(capsys, "place", case, "--json", "-", *options)
    assert result.code == 0, result
    return json.loads(result.out)


def test_an_opening_that_is_set_and_missed(capsys: Any) -> None:
    cage = icage.plan(icage.load(PLIERS))
    near = 0.01 * cage.sigma_0 + 0.99 * (cage.sigma_first or 0.0)
    found = document(capsys, "--opening", repr(near), "--opening-error")
    known = document(capsys, "--opening", repr(near))
    assert (found["opening"], found["opening_error"]) == (near, True)
    assert found["tolerance"] < known["tolerance"]
    assert found["tolerance"] == icage.place(cage, opening=near, opening_error=True).tolerance


def test_the_keys_of_the_document(capsys: Any) -> None:
    found = document(capsys, "--opening-error", "--friction", "0.3")
    cage = icage.plan(icage.load(PLIERS))
    best = icage.place(cage, 0.3, opening_error=True)
    assert found["format"] == "icage-place/1"
    assert found["tolerance"] == pytest.approx(best.tolerance, rel=1e-12)
    assert found["tolerance"] <= found["tolerance_upper"] <= 1.001 * found["tolerance"]
    assert found["level"] == cage.friction(0.3).sigma_first
    assert found["mu"] == 0.3
    assert found["limited_by"] == "level"
    assert found["tolerance_box"]["shift"] >= found["tolerance"] * (1.0 - 1e-12)
    assert found["tolerance_box"]["turn_deg"] == found["tolerance_curve"]["turn_deg"][-1]
    row = [found["placement"][key] for key in ("x", "y", "theta", "sigma")]
    assert cage.hand.fingers(row).tolist() == [pytest.approx(at) for at in found["fingers"]]
    assert cage.query(row).verdict == "target"


def test_a_known_opening(capsys: Any) -> None:
    cage = icage.plan(icage.load(PLIERS))
    opening = 1.2 * cage.sigma_0
    found = document(capsys, "--opening", f"{opening!r}")
    assert found["placement"]["sigma"] == found["opening"] == opening
    assert found["tolerance_box"]["shift"] == pytest.approx(found["tolerance"])


def test_the_lines_and_the_figure(capsys: Any, tmp_path: Path) -> None:
    figure = tmp_path / "place.svg"
    result = here(capsys, "place", PLIERS, "--figure", str(figure))
    assert result.code == 0
    words = [line.split("  ")[0] for line in result.out.splitlines()]
    assert words[1] == "placement"
    assert {"tolerance", "limited by", "as a whole"} <= set(words)
    drawn = figure.read_bytes()
    assert drawn.startswith(b"<?xml")
    here(capsys, "place", PLIERS, "--figure", str(figure))
    assert figure.read_bytes() == drawn


def test_a_drawing_is_placed_for(capsys: Any, tmp_path: Path) -> None:
    drawing = tmp_path / "bar.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20">'
        '<path d="M0 0H40V20H25V10H15V20H0Z"/></svg>'
    )
    result = here(capsys, "place", str(drawing), "--finger-radius", "1", "--json", "-")
    assert result.code == 0, result
    assert json.loads(result.out)["tolerance"] > 0.0
    assert "no grasp yet" in result.err


@pytest.mark.parametrize(
    ("case", "options", "words"),
    [
        ("T_best", ("--opening", "17"), "below the level"),
        ("T_best", ("--opening", "-1"), "not above 0"),
        ("T_best", ("--friction", "0.1,0.2"), "one coefficient is needed"),
        ("T_best", ("--friction", "-1"), "below 0"),
        ("T_best", ("--figure", "place.pdf"), ".svg or .png"),
        ("rectangle_notcage", (), "not a cage"),
    ],
)
def test_what_is_refused(case: str, options: tuple[str, ...], words: str, capsys: Any) -> None:
    result = here(capsys, "place", str(CASES / f"{case}.json"), *options)
    assert words in result.error_line()
