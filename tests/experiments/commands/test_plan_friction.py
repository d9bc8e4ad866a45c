"""``icage plan --friction``: its keys, its lines, and what it refuses."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import icage
from models import CASES
from tests.experiments.commands.runner import here

PLIERS = str(CASES / "pliers_best.json")


def document(capsys: Any, *options: str, case: str = PLIERS) -> dict[str, Any]:
    result = here(capsys, "plan", case, "--json", "-", *options)
    assert result.code == 0, result
    return json.loads(result.out)


def test_the_keys_of_the_document(capsys: Any) -> None:
    plan = document(capsys, "--friction", "0.3,0, 0.1")
    cage = icage.plan(icage.load(PLIERS))
    assert [row["mu"] for row in plan["friction"]] == [0.3, 0.0, 0.1]
    assert plan["tolerance"] == {"position": 0.005, "angle_deg": pytest.approx(math.degrees(0.02))}
    for row, found in zip(
        plan["friction"], icage.friction_levels(cage, [0.3, 0.0, 0.1]), strict=True
    ):
        assert row["sigma_first"] == pytest.approx(found.sigma_first, rel=1e-12)
    assert plan["friction"][1] == {
        "mu": 0.0, "sigma_first": plan["sigma_first"], "jam": None,
        "ends": {"position_max": 0.0, "angle_max_deg": 0.0},
    }  # fmt: skip
    for row in plan["friction"]:
        assert row["ends"]["position_max"] <= 0.005 * (1.0 + 1e-9)
        assert row["ends"]["angle_max_deg"] <= math.degrees(0.02) * (1.0 + 1e-9)
    jam = plan["friction"][0]["jam"]
    assert jam["sigma"] == plan["friction"][0]["sigma_first"] < plan["sigma_first"]
    assert jam["placement"]["sigma"] == pytest.approx(jam["sigma"], rel=1e-12)
    assert math.dist(*jam["contacts"][:2]) == pytest.approx(jam["sigma"], rel=1e-12)
    assert len(jam["contacts"]) == 3
    assert set(jam["fingers"]) <= {1, 2, 3}


def test_what_is_no_cage_promises_nothing(capsys: Any) -> None:
    case = str(CASES / "rectangle_notcage.json")
    plan = document(capsys, "--friction", "0.1", case=case)
    assert plan["friction"] == [
        {"mu": 0.1, "sigma_first": plan["sigma_0"], "jam": None, "ends": None}
    ]


def test_a_plan_without_the_option_has_no_such_keys(capsys: Any) -> None:
    assert not {"friction", "tolerance"} & document(capsys).keys()


def test_a_wider_tolerance(capsys: Any) -> None:
    wide = document(
        capsys, "--friction", "0.8", "--within-position", "0.1", "--within-angle-deg", "20"
    )
    assert wide["tolerance"] == {"position": 0.1, "angle_deg": pytest.approx(20.0)}
    usual = document(capsys, "--friction", "0.8")
    assert wide["friction"][0]["sigma_first"] > usual["friction"][0]["sigma_first"]


def test_the_lines(capsys: Any) -> None:
    result = here(capsys, "plan", PLIERS, "--friction", "0,0.3")
    lines = [line for line in result.out.splitlines() if line.startswith("  mu ")]
    assert [line.split()[1] for line in lines] == ["0", "0.3"]
    assert "jam" not in lines[0]
    assert "jam there" in lines[1]
    assert lines[1].endswith("deg off")


def test_discs(capsys: Any) -> None:
    plan = document(capsys, "--friction", "0.05,0.5", case=str(CASES / "disc_Y.json"))
    little, much = plan["friction"]
    assert plan["sigma_0"] < much["sigma_first"] <= little["sigma_first"] <= plan["sigma_first"]
    assert much["jam"]["placement"]["sigma"] == pytest.approx(much["sigma_first"], rel=1e-9)


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_the_figure(suffix: str, capsys: Any, tmp_path: Path) -> None:
    files = [tmp_path / f"{k}.{suffix}" for k in range(2)]
    for file in files:
        result = here(
            capsys, "plan", PLIERS, "--friction", "0.1,0.3,0.6", "--friction-figure", str(file)
        )
        assert result.code == 0, result
    first, again = (file.read_bytes() for file in files)
    assert first == again
    assert len(first) > 10_000


def test_what_is_no_cage_and_what_never_escapes(capsys: Any) -> None:
    nothing = document(capsys, "--friction", "0.2", case=str(CASES / "rectangle_notcage.json"))
    assert nothing["friction"][0]["jam"] is None
    never = document(capsys, "--friction", "0.01", case=str(CASES / "never_escapes_a.json"))
    assert [(row["sigma_first"], row["jam"]) for row in never["friction"]] == [(None, None)]


@pytest.mark.parametrize(
    ("case", "options", "words"),
    [
        ("T_best", ("--friction", "0.1,-1"), "below 0"),
        ("T_best", ("--friction", "0.1,,2"), "finite number"),
        ("T_best", ("--friction", "nan"), "finite number"),
        ("T_best", ("--within-position", "0.1"), "--friction only"),
        ("T_best", ("--friction-figure", "a.svg"), "--friction only"),
        ("T_best", ("--friction", "0.1", "--friction-figure", "a.pdf"), ".svg or .png"),
        (
            "T_best",
            ("--friction", "0.1", "--friction-figure", "a.svg", "--figure", "a.svg"),
            "both",
        ),
        ("rectangle_notcage", ("--friction", "0.1", "--friction-figure", "a.svg"), "not a cage"),
        ("T_best", ("--friction", "0.1", "--within-angle-deg", "120"), "quarter turn"),
        ("T_best", ("--friction", "0.1", "--within-position", "3"), "0 to 1"),
    ],
)
def test_what_is_refused(case: str, options: tuple[str, ...], words: str, capsys: Any) -> None:
    result = here(capsys, "plan", str(CASES / f"{case}.json"), *options)
    assert words in result.error_line()
