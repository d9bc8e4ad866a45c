"""What MUJOCO_GL says matters to pictures and to nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import sim
from icage.errors import InputError
from sim.camera.renderer import check_graphics
from tests.experiments.commands.runner import here

ROOT = Path(sim.__file__).parent


@pytest.mark.parametrize("setting", ["nonsense", "", None])
def test_physics_needs_no_graphics(setting: str | None) -> None:
    code = (
        "import os, sim.world.engine; from sim.world.engine import mj; "
        "mj.MjModel.from_xml_string('<mujoco/>'); print(os.environ.get('MUJOCO_GL'))"
    )
    environment = {k: v for k, v in os.environ.items() if k != "MUJOCO_GL"}
    environment |= {} if setting is None else {"MUJOCO_GL": setting}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False
    )
    assert done.stdout == f"{setting}\n", done.stderr


def test_one_module_imports_the_engine() -> None:
    """So that no command can fail where the import of the engine does."""
    folders = [ROOT, ROOT.parent / "experiments", ROOT.parent / "icage"]
    files = [file for folder in folders for file in folder.rglob("*.py")]
    importing = {
        file.name
        for file in files
        for line in file.read_text().splitlines()
        if line.strip().startswith(("import mujoco", "from mujoco"))
    }
    assert importing == {"engine.py", "process.py"}


@pytest.mark.parametrize("setting", ["egl", "OSMesa ", "disable", ""])
def test_known_graphics(setting: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", setting)
    check_graphics()


def test_a_video_under_unknown_graphics_is_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    with pytest.raises(InputError, match="MUJOCO_GL=nonsense"):
        check_graphics()
    out = tmp_path / "out"
    assert "MUJOCO_GL=nonsense" in here(capsys, "replay", "pliers", "--out", str(out)).error_line()
    assert not out.exists()
