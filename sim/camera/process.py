"""Draws frames in a process of its own: ``python process.py WIDTH HEIGHT``.

MuJoCo chooses its OpenGL platform when it is imported, and dies there if the library is missing.
So whoever wants frames starts this file with ``MUJOCO_GL`` set, writes a compiled model and the
positions to its standard input, and reads raw RGB from its standard output; a crash of the graphics
driver takes nobody else along. Nothing of it touches the disk: whoever is killed leaves nothing
there, and this process ends when nobody reads on.
"""

from __future__ import annotations

import sys
from io import BytesIO
from typing import Any

import mujoco
import numpy as np

CAMERA = "top"
_NAME = "stage.mjb"


def main(width: str, height: str) -> None:
    """Write one frame of ``width`` x ``height`` x 3 bytes per row of the positions."""
    mj: Any = mujoco
    log = mj.MjLogConfig.get()
    log.logto_console, log.logto_file = False, False  # else a warning leaves a file somewhere
    mj.MjLogConfig.set(log)
    given = BytesIO(sys.stdin.buffer.read())
    binary, positions = np.load(given), np.load(given)
    model = mj.MjModel.from_binary_path(_NAME, {_NAME: binary.tobytes()})
    data = mj.MjData(model)
    mj.mj_forward(model, data)  # before the first scene, else the camera is at the origin
    with mj.Renderer(model, int(height), int(width)) as renderer:
        for qpos in positions:
            data.qpos[:] = qpos
            mj.mj_forward(model, data)
            renderer.update_scene(data, camera=CAMERA)
            sys.stdout.buffer.write(renderer.render().tobytes())
            sys.stdout.buffer.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
