"""What MUJOCO_GL says matters to pictures and to nothing else."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import sim
from icage.errors import InputError
from sim.camera import renderer
from sim.camera.renderer import check_graphics, find_backend, render_frames
from sim.camera.stage import View
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.experiments.commands.runner import here
from tests.experiments.small import cage_of
from tests.oracles.against_itself import ends

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


def test_the_camera_process_is_where_it_is_started() -> None:
    """It was renamed once, and every film was drawn in two dimensions for months."""
    worker = renderer._WORKER
    done = subprocess.run(
        [sys.executable, "-P", str(worker), "8", "8"], input=b"", capture_output=True, check=False
    )
    assert b"EOFError" in done.stderr, done.stderr  # it is there, and misses its model


def camera() -> str:
    backend = find_backend()
    if backend is None:
        pytest.skip("no offscreen OpenGL on this machine")
    return backend


def test_frames_of_the_camera() -> None:
    camera()
    cage = cage_of("T")
    scene = Scene(cage.outline, cage.hand, cage.finger_radius, SimConfig())
    qpos = scene.start_positions(cage.target_placement.as_array()).repeat(3, axis=0)
    view = View.around(scene, qpos, 96, 64)
    frames = list(render_frames(scene, qpos, view))
    assert [frame.shape for frame in frames] == [(64, 96, 3)] * 3
    assert np.std(frames[0]) > 10.0
    assert (frames[0] == frames[2]).all()


def test_a_killed_camera_leaves_no_file_and_no_process(tmp_path: Path) -> None:
    camera()
    code = """
import numpy as np, os, signal
from sim.camera.renderer import render_frames
from sim.camera.stage import View
from sim.world.config import SimConfig
from sim.world.scene import Scene
from tests.experiments.small import cage_of
cage = cage_of("T")
scene = Scene(cage.outline, cage.hand, cage.finger_radius, SimConfig())
qpos = scene.start_positions(cage.target_placement.as_array()).repeat(10_000, axis=0)
frames = render_frames(scene, qpos, View.around(scene, qpos, 96, 64))
next(frames)
os.kill(os.getpid(), signal.SIGKILL)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT.parent, capture_output=True, check=False,
        env={**os.environ, "TMPDIR": str(tmp_path), ends._MARK: str(tmp_path)}, timeout=120,
    )  # fmt: skip
    assert done.returncode == -signal.SIGKILL, done.stderr
    for _ in range(100):
        if not ends._processes(str(tmp_path)):
            break
        time.sleep(0.1)
    else:
        raise AssertionError("the camera goes on")
    assert list(tmp_path.iterdir()) == []
