"""Every bad input or option: exit 2, one line that says what, where and what is allowed, and
nothing written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from models import CASES
from tests.experiments.commands.runner import here, process
from tests.icage.formats.svg.drawings import drawing

POCKET = [[0, 0], [10, 0], [10, 10], [5.5, 10], [5.5, 9], [8, 9], [8, 4], [2, 4], [2, 9], [4.5, 9]]

BAD: dict[str, tuple[Any, str]] = {
    "invalid JSON": (b'{"format": "icage-case/1", }', "line 1 column"),
    "cut off JSON": (b'{"format": "icage-case/1"', "line 1 column"),
    "empty file": (b"", "is empty"),
    "binary garbage": (bytes(range(256)) * 8, "not UTF-8 text"),
    "zero bytes": (b"\0" * 100, "byte 0 is zero"),
    "absurdly large file": (b" " * 10_000_001, "larger than 10 MB"),
    "wrong format": ({"format": "icage-study/1"}, "'icage-case/1' is needed"),
    "missing key": ({"grasp": None}, "grasp is null; an object is needed"),
    "mistyped number": ({"finger_radius": "1 mm"}, "a number is needed"),
    "boolean as number": ({"finger_radius": True}, "a number is needed"),
    "NaN": (b'{"format": "icage-case/1", "finger_radius": NaN}', "NaN is not a JSON number"),
    "infinite number": (b'{"format": "icage-case/1", "x": -Infinity}', "-Infinity is not"),
    "number too large": (
        {"outline": {"vertices": [[0, 0], [10**400, 0], [1, 1]]}},
        "outline.vertices[1][0] is too large",
    ),
    "self-crossing outline": (
        {"outline": {"vertices": [[0, 0], [1, 1], [1, 0], [0, 1]]}},
        "Self-intersection[0.5 0.5]",
    ),
    "zero-area outline": ({"outline": {"vertices": [[0, 0], [1, 0], [2, 0]]}}, "outline"),
    "two vertices": ({"outline": {"vertices": [[0, 0], [1, 0]]}}, "at least 3"),
    "absurd coordinates": ({"outline": {"vertices": [[0, 0], [1e15, 0], [0, 1e15]]}}, "1e+12"),
    "absurdly many vertices": (
        {"outline": {"vertices": [[k, k * k] for k in range(2001)]}},
        "2000",
    ),
    "clockwise contacts": ({"grasp": {"contacts": [[0, 0.5], [1, 0.75], [1, 0.25]]}}, "clockwise"),
    "collinear contacts": ({"grasp": {"contacts": [[0, 0.1], [0, 0.9], [0, 0.5]]}}, "collinear"),
    "coincident contacts": ({"grasp": {"contacts": [[0, 0.5], [1, 0.5], [1, 0.5]]}}, "coincide"),
    "contact off the boundary": (
        {"grasp": {"contacts": [[0, 0.5], [1, 0.25], [1.125, 0.75]]}},
        "contact 3 at [1.125, 0.75] is 0.125 mm from the outline",
    ),
    "contact inside": (
        {"grasp": {"contacts": [[0, 0.5], [1, 0.25], [0.875, 0.75]]}},
        "contact 3 at [0.875, 0.75] lies inside the outline, 0.125 mm from it",
    ),
    "negative radius": ({"finger_radius": -1}, "0 or more"),
    "absurd radius": ({"finger_radius": 1e6}, "10 diameters"),
    "overlapping discs": (
        {"finger_radius": 0.3, "grasp": {"contacts": [[-0.3, 0.5], [1.3, 0.25], [1.3, 0.75]]}},
        "fingers 2 and 3 overlap",
    ),
    "radius that swallows a pocket": (
        {
            "outline": {"vertices": [*POCKET, [4.5, 10], [0, 10]]},
            "finger_radius": 0.8,
            "grasp": {"contacts": [[-0.8, 5.0], [5.0, 4.8], [10.8, 6.0]]},
        },
        "contact 2 at [5.0, 4.8] lies in a pocket that finger_radius = 0.8 mm closes off",
    ),
    "unknown unit": ({"unit": "furlong"}, "one of m, mm, cm"),
    "empty SVG": ({"outline": {"file": "empty.svg", "width": 1}}, "nothing in the drawing"),
    "XML entities": ({"outline": {"file": "bomb.svg", "width": 1}}, "entities are not allowed"),
    "garbage as SVG": ({"outline": {"file": "noise.svg", "width": 1}}, "not an SVG file"),
    "folder as SVG": ({"outline": {"file": "folder.svg", "width": 1}}, "is a folder"),
    "missing SVG": ({"outline": {"file": "none.svg", "width": 1}}, "does not exist"),
    "negative width": ({"outline": {"file": "empty.svg", "width": -1}}, "above 0"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "empty.svg").write_text(drawing(""))
    (tmp_path / "sizeless.svg").write_text(drawing('<circle r="1"/>', 'width="20px"'))
    (tmp_path / "bomb.svg").write_text(
        '<!DOCTYPE svg [<!ENTITY a "aaaa">]><svg xmlns="http://www.w3.org/2000/svg">&a;</svg>'
    )
    (tmp_path / "noise.svg").write_bytes(bytes(range(256)))
    (tmp_path / "folder.svg").mkdir()
    return tmp_path


def files(folder: Path) -> set[Path]:
    return set(folder.rglob("*"))


@pytest.mark.parametrize("kind", BAD)
def test_bad_cases(kind: str, folder: Path, square: dict[str, Any], capsys: Any):
    bad, message = BAD[kind]
    case = folder / "case.json"
    case.write_bytes(bad if isinstance(bad, bytes) else json.dumps({**square, **bad}).encode())
    before = files(folder)
    outputs = ["--json", str(folder / "plan.json"), "--figure", str(folder / "plan.svg")]
    line = here(capsys, "plan", str(case), *outputs).error_line()
    assert message in line
    assert "case.json" in line
    assert files(folder) == before
    assert here(capsys, "query", str(case), "none.csv").error_line() == line


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "COMMAND"),
        (("bake",), "invalid choice: 'bake'"),
        (("plan",), "CASE"),
        (("plan", "none.json"), "'none.json' does not exist; shipped objects: pliers, saw, wrench"),
        (("plan", "."), "is a folder"),
        (("plan", "a\0b"), "cannot be a file|does not exist"),
        (("plan", "x" * 5000), "cannot be|does not exist"),
        (("plan", "L", "--speed", "9"), "unrecognized arguments: --speed 9"),
        (("plan", "L", "--js", "-"), "unrecognized arguments"),
        (("plan", "L", "--json"), "--json: expected one argument"),
        (("plan", "L", "--json", "."), "--json '.' is a folder"),
        (("plan", "L", "--json", "no/such/place.json"), "there is no folder 'no/such'"),
        (("plan", "L", "--json", "L"), "would overwrite an input"),
        (("plan", "L", "--figure", "cage.pdf"), "ending in .svg or .png"),
        (("plan", "L", "--figure", "c.svg", "--json", "c.svg"), "both name"),
        (("plan", "L", "--figure", "./c.svg", "--json", "c.svg"), "both name"),
        (("plan", ""), "CASE-or-DRAWING: '' names no file"),
        (("query", "L", ""), "PLACEMENTS: '' names no file"),
        (("outline", ""), "DRAWING: '' names no file"),
        (("replay", "L", "--out", ""), "--out: '' names no file"),
        (("plan", "empty.svg"), "states no size in mm, cm or in; a width is needed"),
        (("plan", "empty.svg", "--width", "9"), "nothing in the drawing is filled"),
        (("query", "L"), "PLACEMENTS"),
        (("query", "L", "."), "is a folder"),
        (("query", "L", "none.csv"), "none.csv does not exist"),
        (("query", "L", "bad.csv"), "bad.csv, row 2 (line 3): sigma is -1; 0 or more is needed"),
        (("outline", "L", "--width", "2"), "L is no drawing; .svg"),
        (("outline", "none.svg", "--width", "0"), "--width: '0' is not above 0"),
        (("outline", "none.svg", "--width", "nan"), "not a finite number"),
        (("outline", "sizeless.svg"), "states no size in mm, cm or in; a width is needed"),
        (("outline", "none.svg", "--width", "2"), "none.svg does not exist"),
        (("outline", "none.svg", "--width", "2", "--unit", "inch"), "invalid choice: 'inch'"),
    ],
)
def test_wrong_options(
    arguments: tuple[str, ...], message: str, folder: Path, monkeypatch: Any, capsys: Any
):
    monkeypatch.chdir(folder)
    (folder / "L").write_bytes((CASES / "L_best.json").read_bytes())
    (folder / "bad.csv").write_text("x,y,theta,sigma\n0,0,0,1\n0,0,0,-1\n")
    before = files(folder)
    line = here(capsys, *arguments).error_line()
    assert any(part in line for part in message.split("|"))
    assert files(folder) == before


@pytest.mark.parametrize(
    ("arguments", "stdin", "message"),
    [
        (("plan", "crossing.json", "--json", "out.json"), b"", "Self-intersection[0.5 0.5]"),
        (("query", "wrench", "-", "--json", "-"), b"x,y,theta,sigma\n1,2,3,nan\n", "row 1"),
        (("plan", "pliers", "--jsn", "-"), b"", "unrecognized"),
    ],
)
def test_as_a_user_sees_it(
    arguments: tuple[str, ...], stdin: bytes, message: str, folder: Path, square: dict[str, Any]
):
    square["outline"]["vertices"] = [[0, 0], [1, 1], [1, 0], [0, 1]]
    (folder / "crossing.json").write_text(json.dumps(square))
    before = files(folder)
    assert message in process(*arguments, stdin=stdin, cwd=folder).error_line()
    assert files(folder) == before


def test_odd_names_stay_on_one_line(folder: Path, capsys: Any):
    line = here(capsys, "plan", str(folder / "two\nlines\x1b[31m.json")).error_line()
    assert "does not exist" in line
