"""Draws frames in a process of its own: ``python process.py MODEL POSITIONS WIDTH HEIGHT``.

MuJoCo chooses its OpenGL platform when it is imported, and dies there if the library is missing.
So whoever wants frames starts this file with ``MUJOCO_GL`` set, and reads raw RGB from its standard
output; a crash of the graphics driver takes nobody else along.
"""

from __future__ import annotations

import sys
from typing import Any

import mujoco
import numpy as np

CAMERA = "top"


def main(model_file: str, positions_file: str, width: str, height: str) -> None:
    """Write one frame of ``width`` x ``height`` x 3 bytes per row of the positions."""
    mj: Any = mujoco
    model = mj.MjModel.from_binary_path(model_file)
    positions = np.load(positions_file)
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
