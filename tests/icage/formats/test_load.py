"""load(): every way in leads to the same case, and what does not go together is refused."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest

import icage
from experiments.study.inputs.config import read_toml
from icage.case import Case
from icage.errors import CaseError, FormatError, InputError
from icage.formats import streams
from icage.formats.case_json import case_document, grasp_name, read_case
from icage.formats.json_out import write_json
from icage.formats.placements_csv import read_placements
from icage.outline import Outline
from models import CASES, case_paths
from tests.experiments.small import t_case, write_case
from tests.icage.formats.svg.drawings import drawing

T_PATH = '<path d="M0 0H60V12H36V40H24V12H0Z"/>'


@pytest.fixture
def svg(tmp_path: Path) -> Path:
    path = tmp_path / "t.svg"
    path.write_text(drawing(T_PATH, 'viewBox="0 0 60 40"'))
    return path


def without_grasp(folder: Path, **changed: Any) -> Path:
    path = write_case(t_case(), folder / "alone.json", **changed)
    data = json.loads(path.read_text())
    del data["grasp"]
    path.write_text(json.dumps(data))
    return path


def test_a_drawing_is_a_case_without_a_grasp(svg: Path):
    case = icage.load(svg, width=180, unit="mm", finger_radius=6)
    assert (case.name, case.unit, case.finger_radius, case.target) == ("t", "mm", 6.0, None)
    assert np.ptp(case.outline.vertices, axis=0) == pytest.approx([180.0, 120.0])
    assert case == icage.load(str(svg), width=180, unit="mm", finger_radius=6)
    assert case.sources == (svg,)
    assert icage.load(svg, width=18, unit="cm").unit == "cm"


def test_a_tolerance_reaches_the_drawing(tmp_path: Path):
    path = tmp_path / "disc.svg"
    path.write_text(drawing('<circle r="10"/>'))
    coarse, fine = (icage.load(path, width=20, tolerance=t).outline for t in (1.0, 0.01))
    assert len(coarse) < len(fine)


def test_vertices_and_an_outline_are_named_object():
    triangle = [[0, 0], [4, 0], [0, 3]]
    case = icage.load(triangle, unit="cm", finger_radius=0.5)
    assert case == Case("object", "cm", Outline(triangle), 0.5)
    assert icage.load(Outline(triangle)) == Case("object", "m", Outline(triangle))


def test_a_case_file_with_and_without_a_grasp(tmp_path: Path):
    whole = t_case()
    assert icage.load(write_case(whole, tmp_path / "t.json")) == whole
    alone = icage.load(without_grasp(tmp_path))
    assert (alone.target, alone.finger_radius) == (None, whole.finger_radius)
    assert icage.load(without_grasp(tmp_path), finger_radius=0.25).finger_radius == 0.25


def test_a_case_written_is_the_case_read(tmp_path: Path):
    path = tmp_path / "t.json"
    write_json(case_document(t_case(), "icage grasps t.svg"), str(path))
    assert icage.load(path) == t_case()


def test_a_plan_is_its_case(tmp_path: Path):
    path = tmp_path / "cage.json"
    cage = icage.plan(t_case())
    cage.save(path)
    case = icage.load(path)
    assert (case.name, case.unit, case.finger_radius) == ("T", "mm", t_case().finger_radius)
    assert np.array_equal(case.contacts, cage.contacts)
    again = icage.read_cage(path)
    assert again.sigma_max == pytest.approx(cage.sigma_max, rel=1e-9)
    with pytest.raises(CaseError, match="a plan file has one grasp"):
        icage.load(path, grasp=2)


def test_a_plan_without_a_name_is_called_object(tmp_path: Path):
    square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    cage = icage.plan(square, [[0, 1], [2, 0.9], [2, 1.1]])
    cage.save(tmp_path / "cage.json")
    assert (cage.name, icage.load(tmp_path / "cage.json").name) == ("", "object")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sigma_max": 3.0}, "sigma_max is 3.0, but its object and grasp give"),
        ({"contacts": None}, "contacts is null"),
        ({"outline": None}, "outline is null"),
    ],
)
def test_a_plan_that_was_edited_is_not_believed(tmp_path: Path, change: dict[str, Any], words: str):
    path = tmp_path / "cage.json"
    icage.plan(t_case()).save(path)
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(CaseError, match=words):
        icage.read_cage(path)


def grasps_file(folder: Path, rows: Any) -> Path:
    data = json.loads(write_case(t_case(), folder / "g.json").read_text())
    del data["grasp"]
    path = folder / "g.json"
    path.write_text(json.dumps({**data, "format": "icage-grasps/1", "grasps": rows}))
    return path


def test_a_list_of_grasps_is_counted_from_one(tmp_path: Path):
    one = t_case().contacts
    rows = [{"contacts": np.roll(one, k, axis=0).tolist()} for k in range(2)]
    path = grasps_file(tmp_path, rows)
    assert icage.load(path).name == "T/1"
    assert np.array_equal(icage.load(path).contacts, one)
    assert np.array_equal(icage.load(path, grasp=2).contacts, np.roll(one, 1, axis=0))
    assert icage.load(path, grasp=2).name == "T/2"
    for number in (0, 3):
        with pytest.raises(CaseError, match=f"grasp is {number}; the file has grasps 1 to 2"):
            icage.load(path, grasp=number)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([], "the file has no grasps"),
        ({}, "grasps is an object; a list is needed"),
        ([7], r"grasps\[0\] is 7; an object is needed"),
        ([{}], r"grasps\[0\] has no key 'contacts'"),
        ([{"contacts": [[0, 0]]}], r"grasps\[0\].contacts has 1 points; 3 are needed"),
    ],
)
def test_a_list_of_grasps_that_is_none(tmp_path: Path, rows: Any, words: str):
    with pytest.raises(CaseError, match=words):
        icage.load(grasps_file(tmp_path, rows))


def test_a_shipped_object_is_its_first_grasp_or_the_one_asked_for():
    assert icage.load("pliers") == icage.load("pliers/1_best")
    assert icage.load("pliers", grasp=2) == read_case(case_paths("pliers")[1])
    with pytest.raises(InputError, match="grasp is 99; pliers has grasps 1 to"):
        icage.load("pliers", grasp=99)


def test_a_grasp_belongs_to_its_radius(tmp_path: Path):
    path = write_case(t_case(), tmp_path / "t.json")
    assert icage.load(path, finger_radius=t_case().finger_radius) == t_case()
    with pytest.raises(CaseError, match=r"icage\.regrasp"):
        icage.load(path, finger_radius=0.5 * t_case().finger_radius)


@pytest.mark.parametrize("option", [{"width": 2.0}, {"unit": "mm"}, {"tolerance": 0.1}])
def test_size_is_for_drawings(tmp_path: Path, option: dict[str, Any]):
    for source in (write_case(t_case(), tmp_path / "t.json"), without_grasp(tmp_path), "pliers"):
        with pytest.raises(InputError, match=r"for drawings, but .* has its own"):
            icage.load(source, **option)


def test_options_that_say_nothing_are_refused(tmp_path: Path, svg: Path):
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    for source, option in (
        (square, {"width": 1.0}), (square, {"grasp": 1}), (svg, {"width": 9.0, "grasp": 1}),
        (without_grasp(tmp_path), {"grasp": 1}),
    ):  # fmt: skip
        with pytest.raises(InputError, match=r"is 1, but|is for drawings, but"):
            icage.load(source, **option)


def test_a_misspelt_grasp_is_no_missing_one(tmp_path: Path):
    path = write_case(t_case(), tmp_path / "t.json")
    path.write_text(path.read_text().replace('"grasp"', '"Grasp"'))
    with pytest.raises(CaseError, match="no key 'grasp' .it has 'Grasp'"):
        icage.load(path)


def test_a_long_name_keeps_its_number():
    assert grasp_name("x" * 100, 12) == "x" * 97 + "/12"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with names")
@pytest.mark.parametrize("suffix", [".svg", ".dxf", ".stl", ".png", ".geojson"])
def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path: Path, suffix: str):
    pipe = tmp_path / f"a{suffix}"
    os.mkfifo(pipe)
    with pytest.raises(FormatError, match="is a pipe or a device"):
        icage.load(pipe, width=1.0, unit="mm")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with names")
@pytest.mark.parametrize("name", ["a.json", "a.csv", "a.toml", "a"])
def test_a_pipe_that_nobody_writes_to_is_not_waited_for_for_ever(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(streams, "NOBODY", 0.2)
    pipe = tmp_path / name
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="a pipe, and in .* nobody wrote to it"):
        {"a.csv": read_placements, "a.toml": read_toml}.get(name, icage.load)(pipe)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with names")
@pytest.mark.parametrize("pause", [0.0, 0.3])
def test_a_case_comes_through_a_pipe(tmp_path: Path, pause: float):
    """Late, and in two pieces."""
    pipe, content = tmp_path / "a.json", (CASES / "T_best.json").read_bytes()
    os.mkfifo(pipe)

    def write() -> None:
        sleep(pause)
        with pipe.open("wb", buffering=0) as file:
            file.write(content[:100])
            sleep(pause)
            file.write(content[100:])

    with ThreadPoolExecutor() as pool:
        writing = pool.submit(write)
        assert icage.load(pipe).target is not None
        writing.result()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with names")
def test_a_writer_that_is_silent_is_not_waited_for_for_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(streams, "SILENT", 0.2)
    pipe = tmp_path / "a.json"
    os.mkfifo(pipe)
    both = os.open(pipe, os.O_RDWR)
    with pytest.raises(InputError, match="nothing was written to it for 0.2 s"):
        icage.load(pipe)
    os.close(both)


@pytest.mark.parametrize(
    "option", [{"layers": 5}, {"layers": [1]}, {"layers": "CUT"}, {"background": "no"}]
)
def test_options_of_a_wrong_type_are_refused(svg: Path, option: dict[str, Any]):
    with pytest.raises(InputError, match=f"{next(iter(option))} is"):
        icage.load(svg, width=60.0, unit="mm", **option)
