"""``icage outline`` and the options of drawings, as a user sees them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import shapely

import icage
from tests.experiments.commands.runner import here

HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">'
ROUND = HEAD + '<circle cx="20" cy="20" r="15"/></svg>'
TWO = (
    HEAD
    + '<g id="big"><path d="M0 0 H20 V4 H8 V14 H0 Z"/></g>'
    + '<rect id="bar" y="30" width="9" height="5"/></svg>'
)
LASER = HEAD + '<path fill="none" stroke="red" d="M2 2 H30 V20 H2 Z"/></svg>'


def drawn(folder: Path, text: str, name: str = "a.svg") -> str:
    path = folder / name
    path.write_text(text)
    return str(path)


def test_the_summary_says_size_area_and_distance(tmp_path: Path, capsys: Any):
    told = here(capsys, "outline", drawn(tmp_path, ROUND), "--tolerance", "0.1")
    assert told.code == 0
    assert "30 x 30 mm, from the file's" in told.out
    for word in ("vertices, area 7", "diameter ", "symmetric difference to the drawing ", "apart"):
        assert word in told.out


def test_the_document_has_the_source_and_is_a_case(tmp_path: Path, capsys: Any):
    told = here(
        capsys, "outline", drawn(tmp_path, ROUND), "--safe", "outside", "--tolerance", "0.1",
        "--json", "-",
    )  # fmt: skip
    document = json.loads(told.out)
    assert document["source"]["area"] == pytest.approx(706.86, rel=1e-3)
    assert 0.0 < document["source"]["distance"] <= document["source"]["tolerance"] <= 0.1 + 1e-9
    assert document["made_by"] == "icage outline a.svg --tolerance 0.1 --safe outside --unit mm"
    path = tmp_path / "case.json"
    path.write_text(told.out)
    assert icage.load(path).outline.area > 706.86


def test_a_case_is_no_drawing(tmp_path: Path, capsys: Any):
    path = tmp_path / "case.json"
    path.write_text("{}")
    line = here(capsys, "outline", str(path)).error_line()
    assert "no drawing but JSON: a case has its outline already" in line
    assert ".geojson" in line


def test_a_name_of_several_parts_asks_for_another_name(tmp_path: Path, capsys: Any):
    path = drawn(tmp_path, TWO.replace('id="bar"', 'id="bar" class="x"').replace(
        HEAD, HEAD + '<g id="both">').replace("</svg>", "</g></svg>"))  # fmt: skip
    assert "or --pick id=NAME" in here(capsys, "outline", path).error_line()
    line = here(capsys, "outline", path, "--pick", "id=both").error_line()
    assert "what --pick id=both names has 2 separate filled parts" in line
    assert line.count("--pick") == 1


def test_the_figure_shows_outline_and_drawing(tmp_path: Path, capsys: Any):
    figure = tmp_path / "f.svg"
    told = here(capsys, "outline", drawn(tmp_path, ROUND), "--figure", str(figure))
    assert told.code == 0
    assert figure.read_text().count("<circle") > 10
    told = here(capsys, "outline", drawn(tmp_path, ROUND), "--figure", "f.png")
    assert ".svg is needed" in told.error_line()


def test_parts_are_picked_and_said(tmp_path: Path, capsys: Any):
    path = drawn(tmp_path, TWO)
    assert "--pick largest" in here(capsys, "outline", path).error_line()
    told = here(capsys, "outline", path, "--pick", "largest")
    assert "20 x 14 mm" in told.out
    assert told.err.startswith("icage: warning: a: of 2 separate filled parts")
    assert "9 x 5 mm" in here(capsys, "outline", path, "--pick", "id=bar").out
    assert "20 x 14 mm" in here(capsys, "outline", path, "--pick", "id=big").out
    assert "'pin'" in here(capsys, "outline", path, "--pick", "id=pin").error_line()


def test_strokes_are_asked_for(tmp_path: Path, capsys: Any):
    path = drawn(tmp_path, LASER)
    assert "try --strokes outline" in here(capsys, "outline", path).error_line()
    assert "28 x 18 mm" in here(capsys, "outline", path, "--strokes", "outline").out
    assert "29 x 19 mm" in here(capsys, "outline", path, "--strokes", "drawn").out


def test_a_grasp_of_a_drawing_is_found_again_by_the_command_that_is_told(
    tmp_path: Path, capsys: Any
):
    path = drawn(tmp_path, TWO)
    options = ("--pick", "id=big", "--tolerance", "0.1")
    told = here(capsys, "plan", path, *options, "--json", "-")
    assert told.code == 0
    words = f"icage grasps {path} --tolerance 0.1 --pick id=big --cases DIR"
    assert words in told.err
    plan = json.loads(told.out)
    listed = here(capsys, "grasps", path, *options, "--top", "1", "--json", "-")
    (best,) = json.loads(listed.out)["grasps"]
    assert best["contacts"] == plan["contacts"]


def test_a_bracket_of_a_drawing(tmp_path: Path, capsys: Any):
    text = HEAD + '<path d="M2 2 H38 V12 Q14 12 14 38 H2 Z"/></svg>'
    path = drawn(tmp_path, text)
    told = here(capsys, "plan", path, "--bracket", "--json", "-")
    assert told.code == 0
    plan = json.loads(told.out)
    bracket = plan["bracket"]
    assert 0.9 * plan["sigma_max"] < bracket["lower"] < bracket["upper"] < 1.1 * plan["sigma_max"]


def test_a_bracket_is_for_drawings(capsys: Any):
    assert "is exact" in here(capsys, "plan", "pliers", "--bracket").error_line()


def test_options_of_drawings_are_refused_elsewhere(capsys: Any):
    line = here(capsys, "plan", "pliers", "--strokes", "outline", "--pick", "2").error_line()
    assert line.startswith("--strokes and --pick are for drawings") or line.startswith(
        "--pick and --strokes are for drawings"
    )


def test_a_case_file_may_say_how_its_drawing_is_read(tmp_path: Path):
    drawn(tmp_path, TWO)
    case = {
        "format": "icage-case/1", "name": "bar", "unit": "mm",
        "outline": {"file": "a.svg", "pick": "id=bar", "safe": "inside"},
    }  # fmt: skip
    path = tmp_path / "case.json"
    path.write_text(json.dumps(case))
    found = icage.load(path).outline.polygon
    assert shapely.hausdorff_distance(found, shapely.box(0, 0, 9, 5)) < 1e-9
    case["outline"] = {"file": "a.svg", "pick": 7}
    path.write_text(json.dumps(case))
    with pytest.raises(icage.InputError, match="pick is 7"):
        icage.load(path)


@pytest.mark.parametrize(
    ("options", "kinds"),
    [
        (("--layers", "CUT"), "--layers is for a DXF drawing, and this is an SVG drawing"),
        (("--section", "2"), "--section is for an STL mesh or an OBJ mesh or a PLY mesh"),
        (("--threshold", "0.5"), "--threshold is for a PNG or JPEG image"),
    ],
)
def test_options_of_another_format_are_refused(
    options: tuple[str, ...], kinds: str, tmp_path: Path, capsys: Any
):
    line = here(capsys, "outline", drawn(tmp_path, ROUND), *options).error_line()
    assert kinds in line


def test_a_unit_inside_the_outline_of_a_case_is_refused(tmp_path: Path):
    drawn(tmp_path, ROUND)
    case = {
        "format": "icage-case/1", "name": "a", "outline": {"file": "a.svg", "unit": "mm"},
    }  # fmt: skip
    path = tmp_path / "case.json"
    path.write_text(json.dumps(case))
    with pytest.raises(icage.InputError, match="the unit of a case is its own key"):
        icage.load(path)
