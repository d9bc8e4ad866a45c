"""``icage plan`` writes what the contract says, whole, and agrees with the solved problems."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
import shapely

from models import CASES, object_names
from tests.experiments.commands.runner import here, process

KEYS = {
    "format",
    "name",
    "unit",
    "diameter",
    "hand",
    "verdict",
    "sigma_0",
    "sigma_first",
    "sigma_max",
    "punctures",
    "escape_path",
    "grasps",
    "regions",
}


def plan(capsys: Any, case: str | Path, *options: str) -> dict[str, Any]:
    result = here(capsys, "plan", str(case), "--json", "-", *options)
    assert result.code == 0, result

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} in a plan")

    return json.loads(result.out, parse_constant=refuse)


@pytest.mark.parametrize("name", ["cross_multi", "rectangle_notcage", "never_escapes_b"])
def test_a_plan_has_the_keys_of_the_contract(name: str, capsys: Any):
    document = plan(capsys, CASES / f"{name}.json")
    case = json.loads((CASES / f"{name}.json").read_text())
    assert document.keys() >= KEYS
    assert document["format"] == "icage-plan/1"
    assert (document["name"], document["unit"]) == (case["name"], case["unit"])
    expected = case["expected"]
    assert document["verdict"] == expected["verdict"]
    for key in ("sigma_0", "sigma_first", "sigma_max"):
        level = expected[key]
        assert document[key] == (level and pytest.approx(level, rel=1e-7)), key
    z = document["hand"]["unit_fingers"]
    phi = [math.atan2(z[2][1], z[2][0]), math.atan2(z[2][1], z[2][0] - 1)]
    assert z[:2] == [[0, 0], [1, 0]]
    assert document["hand"]["phi_deg"] == pytest.approx([math.degrees(a) for a in phi])
    vertices = case["outline"]["vertices"]
    assert document["diameter"] == max(math.dist(a, b) for a in vertices for b in vertices)


def test_levels_punctures_and_grasps_hang_together(capsys: Any):
    document = plan(capsys, CASES / "cross_multi.json")
    levels = [puncture["sigma"] for puncture in document["punctures"]]
    assert levels == sorted(levels)
    assert (levels[0], levels[-1]) == (document["sigma_first"], document["sigma_max"])
    assert document["punctures"][-1]["kind"] == "escape"
    assert [grasp["id"] for grasp in document["grasps"]] == list(range(len(document["grasps"])))
    assert [grasp["target"] for grasp in document["grasps"]].count(True) == 1
    assert document["grasps"][0]["target"]
    assert document["grasps"][0]["sigma_0"] == document["sigma_0"]
    ids = {i for puncture in document["punctures"] for i in puncture["joins"]}
    assert ids <= {grasp["id"] for grasp in document["grasps"]} - {0}
    x, y, theta, sigma = document["escape_path"][0]
    first, second, _ = document["grasps"][0]["contacts"]
    assert [x, y] == pytest.approx(first)
    reached = [x + sigma * math.cos(theta), y + sigma * math.sin(theta)]
    assert reached == pytest.approx(second)
    assert max(row[3] for row in document["escape_path"]) <= document["sigma_max"] * (1 + 1e-9)


def test_regions_are_open_rings_between_their_bounds(capsys: Any):
    document = plan(capsys, CASES / "L_best.json")
    areas: dict[tuple[int, str], float] = {}
    for region in document["regions"]:
        assert region["level"] == "sigma_max"
        polygons = []
        for part in region["polygons"]:
            for ring in [part["outer"], *part["holes"]]:
                assert ring[0] != ring[-1]
            assert shapely.LinearRing(part["outer"]).is_ccw
            polygons.append(shapely.Polygon(part["outer"], part["holes"]))
        whole = shapely.MultiPolygon(polygons)
        assert whole.is_valid
        areas[region["finger"], region["bound"]] = whole.area
        finger = document["grasps"][0]["contacts"][region["finger"] - 1]
        assert whole.distance(shapely.Point(finger)) <= 1e-9 * document["diameter"]
    assert {finger for finger, _ in areas} == {1, 2, 3}
    for finger in (1, 2, 3):
        inner, outer = areas[finger, "inner"], areas[finger, "outer"]
        assert inner <= outer <= inner / (1 - 1.001e-3)


def test_discs_have_brackets(capsys: Any):
    document = plan(capsys, CASES / "disc_hammer.json")
    assert document["finger_radius"] == 0.05
    assert document["sigma_max"] <= document["sigma_max_upper"] < document["sigma_max"] * 1.0001
    assert document["sigma_first"] <= document["sigma_first_upper"]
    assert isinstance(document["sigma_first_converged"], bool)


def test_no_cage_has_a_reason_and_exit_code_0(capsys: Any):
    document = plan(capsys, CASES / "rectangle_notcage.json")
    assert document["sigma_first"] == document["sigma_max"] == document["sigma_0"]
    assert document["why"]
    assert document["escape_path"] is None


def test_a_hand_that_never_escapes_has_no_escape_level(capsys: Any):
    document = plan(capsys, CASES / "never_escapes_a.json")
    assert document["verdict"] == "never_escapes"
    assert document["sigma_max"] is document["escape_path"] is document["sigma_first"] is None
    assert {region["level"] for region in document["regions"]} == {"all"}


def test_files_and_the_summary(tmp_path: Path, capsys: Any):
    file, figure = tmp_path / "plan.json", tmp_path / "cage.svg"
    case = str(CASES / "L_best.json")
    result = here(capsys, "plan", case, "--json", str(file), "--figure", str(figure))
    assert result.code == 0
    assert "sigma_max" in result.out
    assert json.loads(file.read_text()) == plan(capsys, case)
    assert "<svg" in figure.read_text()
    assert {path.name for path in tmp_path.iterdir()} == {"plan.json", "cage.svg"}


@pytest.mark.parametrize("name", object_names())
def test_a_shipped_object_needs_only_its_name(name: str, capsys: Any):
    result = here(capsys, "plan", name)
    assert result.code == 0
    assert "verdict      cage\n" in result.out
    assert " mm, hand (phi_1, phi_2) = " in result.out


@pytest.mark.slow
@pytest.mark.parametrize("name", object_names())
def test_a_shipped_object_has_regions_and_a_figure(name: str, tmp_path: Path, capsys: Any):
    document = plan(capsys, name, "--figure", str(tmp_path / "cage.png"))
    assert (document["verdict"], document["unit"]) == ("cage", "mm")
    assert len(document["regions"]) == 6
    assert max(region["area_gap"] for region in document["regions"]) <= 1e-3
    assert (tmp_path / "cage.png").stat().st_size > 10_000


def test_json_alone_on_standard_output_as_a_user_sees_it():
    result = process("plan", str(CASES / "T_best.json"), "--json", "-")
    assert result.code == 0
    assert json.loads(result.out)["format"] == "icage-plan/1"
    assert result.err == ""
