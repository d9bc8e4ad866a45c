"""Every shipped object is a folder that explains itself and can be made again."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest
import shapely

from experiments.cli import main
from icage.formats.case_json import read_case, read_object
from icage.formats.drawings.read import trace_file
from icage.formats.drawings.reading import Reading
from models import case_path, case_paths, object_names, outline_path

OBJECTS = object_names()


def test_the_three_tools_are_there():
    assert OBJECTS == ("pliers", "saw", "wrench")


@pytest.mark.parametrize("name", OBJECTS)
def test_the_outline_is_what_its_command_makes(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    document = json.loads(outline_path(name).read_text())
    program, *command = shlex.split(document["made_by"])
    assert program == "icage"
    monkeypatch.chdir(outline_path(name).parent)
    assert main([*command, "--json", str(tmp_path / "again.json")]) == 0
    again = read_object(tmp_path / "again.json")
    shipped = read_object(outline_path(name))
    assert (again.name, again.unit) == (shipped.name, shipped.unit) == (name, "mm")
    assert again.outline.vertices == pytest.approx(shipped.outline.vertices, abs=1e-9)


@pytest.mark.parametrize("name", OBJECTS)
def test_the_outline_is_near_its_drawing(name: str):
    document = json.loads(outline_path(name).read_text())
    words = shlex.split(document["made_by"])
    width, tolerance = (float(words[words.index(key) + 1]) for key in ("--width", "--tolerance"))
    path = outline_path(name).parent / f"{name}.svg"
    drawing = trace_file(path, Reading(width=width, tolerance=1e-5 * width)).outline
    shipped = read_object(outline_path(name)).outline
    apart = shapely.hausdorff_distance(
        drawing.polygon.exterior, shipped.polygon.exterior, densify=0.05
    )
    assert apart <= tolerance + 1e-5 * width
    assert max(shipped.polygon.bounds) == pytest.approx(width)
    assert shipped.polygon.bounds[:2] == (0, 0)


@pytest.mark.parametrize("name", OBJECTS)
def test_every_grasp_is_documented_and_on_the_outline(name: str):
    readme = (outline_path(name).parent / "README.md").read_text()
    outline = read_object(outline_path(name)).outline
    assert case_path(name) == case_paths(name)[0]
    for file in case_paths(name):
        case = read_case(file)  # checks the contacts
        assert case.outline.vertices.tolist() == outline.vertices.tolist()
        assert f"`{file.stem}`" in readme
    assert (outline_path(name).parent / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert (outline_path(name).parent / "LICENSE.txt").stat().st_size > 100


def test_an_unknown_object_is_answered_with_the_names():
    with pytest.raises(KeyError, match="pliers, saw, wrench"):
        case_path("spoon")
