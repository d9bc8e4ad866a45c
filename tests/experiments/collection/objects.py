"""A folder of small objects, and what a table of their grasps leaves beside it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

TRIANGLE = [[0, 0], [4, 0], [0, 3]]
L = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]
T = [[0, 0], [3, 0], [3, 1], [2, 1], [2, 3], [1, 3], [1, 1], [0, 1]]
OBJECTS = {"a.json": TRIANGLE, "in/a.json": L, "t.json": T}
SEARCHED = len(OBJECTS)
BROKEN = "no.svg"
FILES = ["a.json", "in/a.json", BROKEN, "t.json"]


def write_outline(path: Path, vertices: Any, **changed: Any) -> None:
    path.parent.mkdir(exist_ok=True)
    case = {"format": "icage-case/1", "name": path.stem, "unit": "mm"}
    path.write_text(json.dumps({**case, "outline": {"vertices": vertices}, **changed}))


def objects_in(place: Path) -> Path:
    """A folder of three small objects, two of one name, and a drawing that is none."""
    place.mkdir()
    for name, vertices in OBJECTS.items():
        write_outline(place / name, vertices)
    (place / BROKEN).write_text("<svg nonsense")
    (place / "notes.txt").write_text("no object")
    (place / ".hidden.json").write_text("{}")
    return place


def parts(table: Path) -> list[Path]:
    return sorted(table.with_name(f".{table.name}.parts").glob("*"))


def check_same(table: Path, alone: Path) -> None:
    """To the last byte, and nothing is left beside it."""
    assert table.read_bytes() == alone.read_bytes()
    assert [path.name for path in table.parent.glob(".*")] == []
