"""Versions of everything that can change a number, for the record of a run."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Final

import icage
from sim.closing.outcome import RULES

RECORDED: Final = ("mujoco", "numpy", "scipy", "shapely", "numba")


def versions() -> dict[str, str]:
    """Name to version: icage, Python, the libraries that compute, our closings, the platform."""
    return {
        "icage": icage.__version__,
        "python": platform.python_version(),
        **{name: version(name) for name in RECORDED},
        "closings": RULES,
        "platform": f"{platform.system()} {platform.machine()}",
    }
