"""MuJoCo side of icage: the hand, the free object, and what happens when the hand closes.

``from sim import replay`` is what a user of Python needs; inside the project, import from the
modules. Nothing here plots, and nothing touches ``MUJOCO_GL`` at import.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.closing.replay import Replayed, replay
    from sim.world.config import SimConfig

_WHERE = {
    "Replayed": "sim.closing.replay",
    "SimConfig": "sim.world.config",
    "replay": "sim.closing.replay",
}

__all__ = ["Replayed", "SimConfig", "replay"]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"sim has no {name!r}; it has {', '.join(__all__)}")
    return getattr(import_module(_WHERE[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
