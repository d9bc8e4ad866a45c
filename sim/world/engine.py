"""The engine under one typed name: MuJoCo's compiled modules carry no type stubs.

``mj`` is the package ``mujoco``. The aliases say what a value is; strict pyright treats their
members as unknown, and our own annotations check what comes back.
"""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, Final, TypeAlias

GRAPHICS: Final = "MUJOCO_GL"
"""The variable that chooses the engine's graphics."""


@contextmanager
def _no_graphics() -> Generator[None]:
    """MUJOCO_GL switched off for as long as the engine is imported, then as it was.

    The import fails on a value that it does not know. No picture is drawn in this process (frames
    come from one of their own, see ``sim.camera``), so what is set there does not matter here.
    """
    before = os.environ.get(GRAPHICS)
    os.environ[GRAPHICS] = "disable"
    try:
        yield
    finally:
        del os.environ[GRAPHICS]
        if before is not None:
            os.environ[GRAPHICS] = before


with _no_graphics():
    import mujoco
    import mujoco.batch

mj: Any = mujoco
Batch: Any = mujoco.batch.Batch

MjSpec: TypeAlias = Any
MjModel: TypeAlias = Any
MjData: TypeAlias = Any
MjBody: TypeAlias = Any
MjGeom: TypeAlias = Any


@contextmanager
def no_log() -> Generator[None]:
    """Keep the engine's warnings out of the console and of MUJOCO_LOG.TXT in the user's folder.

    They are not lost: every caller reads the warning counters and reports them as diverged.
    """
    config = mj.MjLogConfig.get()
    before = (config.logto_console, config.logto_file)
    config.logto_console, config.logto_file = False, False
    mj.MjLogConfig.set(config)
    try:
        yield
    finally:
        config.logto_console, config.logto_file = before
        mj.MjLogConfig.set(config)
