"""An object that fails is a row with its reason, and the others are searched."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from experiments.collection import rows
from tests.experiments.collection.objects import (
    BROKEN,
    TRIANGLE,
    write_outline,
)
from tests.experiments.commands.runner import Result


@pytest.mark.skipif(sys.platform != "linux", reason="file names and pipes of Linux")
def test_every_object_fails_by_itself(folder: Path, grasps: Callable[..., Result]):
    """Nothing that lies in a folder ends the search of the others."""
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "a drawing.svg").mkdir()
    write_outline(folder / "a drawing.svg" / "big fingers.json", TRIANGLE, finger_radius=6.0)
    write_outline(folder / "no room.json", TRIANGLE)
    write_outline(folder / "crossed.json", [[0, 0], [1, 1], [1, 0], [0, 1]])
    write_outline(folder / "far.json", {"file": "../gone.svg"})
    (folder / "deep.json").write_text("[" * 100_000)
    (folder / "empty.SVG").write_text("")
    (folder / "link.json").symlink_to("nowhere.json")
    os.mkfifo(folder / "pipe.json")
    (folder / "line\nbreak.json").write_text("{}")
    Path(os.fsdecode(os.fsencode(folder) + b"/\xff.json")).write_text("{}")
    assert grasps("--least-gap", "100", "--workers", "1").code == 0
    found = pq.read_table(folder.parent / "table.parquet").to_pylist()
    assert len(found) == 10
    whys = {row["file"]: row["why"] for row in found}
    assert all(why and why.isprintable() and "internal" not in why for why in whys.values())
    assert whys["a drawing.svg/big fingers.json"] == (
        "the finger radius of big fingers is 6; up to the object's diameter, 5, is allowed"
    )
    assert whys["no room.json"].startswith("no immobilizing three-finger grasp was found")
    assert whys["pipe.json"] == "this is no regular file"
    assert "'link.json' does not exist" in whys["link.json"]
    assert str(folder) not in "".join(whys.values())
    assert "\\xff.json" in whys


def test_a_fault_of_our_own_is_one_row(
    folder: Path, grasps: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
):
    def fault(*_: Any) -> None:
        raise ZeroDivisionError("of ours")

    monkeypatch.setattr(rows, "best_of_case", fault)
    assert grasps("--workers", "1").code == 0
    found = pq.read_table(folder.parent / "table.parquet").to_pylist()
    why = {row["why"] for row in found if row["file"] != BROKEN}
    assert why == {"internal: ZeroDivisionError: of ours (our fault)"}
    assert {row["vertices"] for row in found if row["file"] == "a.json"} == {3}
