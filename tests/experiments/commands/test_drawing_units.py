"""A drawing in millimetres is answered in millimetres, and the size says where it is from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.experiments.commands.runner import here

PATH = '<path d="M0 0h40v10h-30v20h-10z"/></svg>'


def drawing(folder: Path, size: str) -> str:
    path = folder / "drawing.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 40 30">{PATH}')
    return str(path)


MM, CM, NONE = 'width="40mm" height="30mm"', 'width="4cm" height="3cm"', ""
INCH = 'width="4in" height="3in"'


@pytest.mark.parametrize(
    ("size", "options", "unit", "wide", "words"),
    [
        (MM, (), "mm", 40.0, "40 x 30 mm, from the file's mm"),
        (CM, (), "cm", 4.0, "4 x 3 cm, from the file's cm"),
        (INCH, (), "mm", 101.6, "101.6 x 76.2 mm, from the file's in"),
        (MM, ("--unit", "m"), "m", 0.04, "0.04 x 0.03 m, from the file's mm"),
        (
            MM, ("--width", "180"), "mm", 180.0,
            "from --width 180 mm (no --unit given: mm is assumed, as in the file)",
        ),
        (
            NONE, ("--width", "180"), "m", 180.0,
            "from --width 180 m (no --unit given: m is assumed, the file states none)",
        ),
        (NONE, ("--width", "18", "--unit", "cm"), "cm", 18.0, "18 x 13.5 cm, from --width 18 cm"),
    ],
)  # fmt: skip
def test_the_unit_of_an_outline(
    size: str, options: tuple[str, ...], unit: str, wide: float, words: str, tmp_path: Path,
    capsys: Any,
):  # fmt: skip
    path = drawing(tmp_path, size)
    told = here(capsys, "outline", path, *options)
    assert told.code == 0
    assert words in told.out
    document = json.loads(here(capsys, "outline", path, *options, "--json", "-").out)
    assert document["unit"] == unit
    assert max(x for x, _ in document["outline"]["vertices"]) == pytest.approx(wide)


def test_the_grasps_of_a_drawing_are_in_its_unit(tmp_path: Path, capsys: Any):
    path = drawing(tmp_path, MM)
    told = here(capsys, "grasps", path, "--top", "1")
    assert "40 x 30 mm, from the file's mm" in told.out


def test_a_case_that_names_a_drawing_stays_in_m(tmp_path: Path, capsys: Any):
    """The contract: a case file without ``unit`` is in m, whatever its drawing is in."""
    drawing(tmp_path, MM)
    case = {"format": "icage-case/1", "name": "l", "outline": {"file": "drawing.svg"}}
    (tmp_path / "case.json").write_text(json.dumps(case))
    told = here(capsys, "grasps", str(tmp_path / "case.json"), "--top", "1", "--json", "-")
    assert json.loads(told.out)["unit"] == "m"
