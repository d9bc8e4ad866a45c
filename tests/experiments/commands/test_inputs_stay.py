"""No output takes the place of a file that the answer was made from, however it is named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.experiments.commands.runner import here
from tests.icage.formats.svg.drawings import drawing


@pytest.fixture
def folder(tmp_path: Path, square: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case whose outline is a drawing beside it, with names that commands write, too."""
    monkeypatch.chdir(tmp_path)
    square["grasp"]["contacts"] = [[0, 0.5], [2, 0.25], [2, 0.75]]
    box = drawing('<rect x="7" width="30" height="15"/>')
    for name, svg in {"replay": "regions", "case": "grasps"}.items():
        (tmp_path / f"{svg}.svg").write_text(box)
        square["outline"] = {"file": f"{svg}.svg", "width": 2.0}
        (tmp_path / f"{name}.json").write_text(json.dumps(square))
    (tmp_path / "rows.csv").write_text("x,y,theta,sigma\n0,0,0,1\n")
    (tmp_path / "link.svg").symlink_to("grasps.svg")
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        "plan case.json --figure grasps.svg",
        "plan case.json --figure link.svg",
        "plan case.json --json ./grasps.svg",
        "plan case.json --json case.json",
        "query case.json rows.csv --json grasps.svg",
        "query case.json rows.csv --json rows.csv",
        "grasps case.json --json grasps.svg",
        "grasps grasps.svg --width 2 --json grasps.svg",
        "outline grasps.svg --width 2 --json link.svg",
        "figures case.json --out . --only grasps",
        "replay replay.json --out .",
        "replay case.json --out . --no-video",
    ],
)
def test_inputs_stay(command: str, folder: Path, capsys: Any):
    if command.startswith("replay case"):  # only the drawing is in the way
        (folder / "case.json").write_bytes((folder / "replay.json").read_bytes())
        (folder / "replay.json").unlink()
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert "would overwrite an input" in here(capsys, *command.split()).error_line()
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_a_shipped_object_stays(capsys: Any):
    from models import outline_path

    path = outline_path("saw")
    before = path.read_bytes()
    line = here(capsys, "grasps", "saw", "--json", str(path)).error_line()
    assert "would overwrite an input" in line
    assert path.read_bytes() == before
