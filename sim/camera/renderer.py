"""Frames from MuJoCo's offscreen renderer, where the machine can draw.

EGL first (surfaceless Mesa works), then OSMesa; both are tried once, each in a child process, and
nothing here touches the environment of this one.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from collections.abc import Generator
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from icage.arrays import FloatArray
from icage.errors import IcageError, InputError
from sim.camera.stage import Decor, View, dressed
from sim.world.engine import GRAPHICS, mj
from sim.world.scene import Scene

BACKENDS: Final = ("egl", "osmesa")

INSTALL_HINT: Final = "apt-get install libegl1 libgl1 libgl1-mesa-dri"
"""One line for a Debian or Ubuntu machine without a display."""

_KNOWN: Final = (
    "", "egl", "osmesa", "glfw", "glx", "cgl", "wgl", "enable", "enabled", "on", "true", "1",
    "disable", "disabled", "off", "false", "0",
)  # fmt: skip
"""Values of ``MUJOCO_GL`` that mean something to the engine, on whatever system."""

_PROBE_SECONDS: Final = 60.0
_WORKER: Final = Path(__file__).with_name("process.py")
_PROBE_MODEL: Final = """<mujoco><worldbody><camera name="top" pos="0 0 1"/>
<geom name="ball" size="0.1"/></worldbody></mujoco>"""


class RenderingUnavailable(IcageError):
    """No offscreen drawing on this machine, or the renderer failed half way."""


def check_graphics() -> None:
    """Refuse to draw under a setting that means nothing: whoever made it wants something else.

    Raises
    ------
    InputError:
        ``MUJOCO_GL`` is set to what the engine does not know.
    """
    setting = os.environ.get(GRAPHICS, "")
    if setting.lower().strip() not in _KNOWN:
        raise InputError(
            f"{GRAPHICS}={setting} in the environment is no graphics that MuJoCo knows; "
            f"unset it or take one of {', '.join(BACKENDS)}; without a video it does not matter"
        )


@functools.cache
def find_backend() -> str | None:
    """The first of ``BACKENDS`` that draws a frame here, or None. Takes 0.5 to 2 s, once."""
    model = mj.MjModel.from_xml_string(_PROBE_MODEL)
    for backend in BACKENDS:
        try:
            frames = list(_draw(model, np.zeros((1, 0)), 32, 32, backend))
        except RenderingUnavailable:
            continue
        if frames[0].any():
            return backend
    return None


def render_frames(
    scene: Scene, qpos: FloatArray, view: View, decor: Decor | None = None
) -> Generator[NDArray[np.uint8]]:
    """Draw engine positions (F, 6), as in ``Recording.qpos``; yields (height, width, 3) frames.

    Raises
    ------
    RenderingUnavailable:
        Neither EGL nor OSMesa works here; draw in two dimensions instead.
    """
    backend = find_backend()
    if backend is None:
        raise RenderingUnavailable(
            f"no offscreen OpenGL on this machine (try: {INSTALL_HINT}); tried {BACKENDS}"
        )
    model = _staged_model(scene, view, decor or Decor())
    yield from _draw(model, qpos, view.width, view.height, backend)


def _staged_model(scene: Scene, view: View, decor: Decor) -> object:
    spec = dressed(scene, view, decor)
    spec.visual.global_.offwidth = view.width
    spec.visual.global_.offheight = view.height
    return spec.compile()


def _draw(
    model: object, qpos: FloatArray, width: int, height: int, backend: str
) -> Generator[NDArray[np.uint8]]:
    size = width * height * 3
    worker = subprocess.Popen(
        [sys.executable, "-P", str(_WORKER), str(width), str(height)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, GRAPHICS: backend},
    )
    assert worker.stdin is not None
    assert worker.stdout is not None
    try:
        with suppress(BrokenPipeError):  # it has ended already: there is no frame to read, either
            worker.stdin.write(_packed(model, qpos))
            worker.stdin.close()
        for number in range(len(qpos)):
            raw = worker.stdout.read(size)
            if len(raw) < size:
                raise RenderingUnavailable(f"{backend} stopped at frame {number}")
            yield np.frombuffer(raw, dtype=np.uint8).reshape(height, width, 3)
    finally:
        worker.kill()
        worker.wait(timeout=_PROBE_SECONDS)
        worker.stdout.close()
        with suppress(BrokenPipeError):
            worker.stdin.close()


def _packed(model: object, qpos: FloatArray) -> bytes:
    """The compiled model and the positions, as the process takes them."""
    binary = np.empty(mj.mj_sizeModel(model), dtype=np.uint8)
    mj.mj_saveModel(model, None, binary)
    packed = BytesIO()
    np.save(packed, binary)
    np.save(packed, np.asarray(qpos, dtype=np.float64))
    return packed.getvalue()
