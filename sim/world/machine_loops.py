"""How the loops over closings and attacks are compiled.

Most make no array and return none, so they count no references: what numba counts at every view of
an array, in steps that no two threads can take at once, was half the time of a computed step. They
touch no Python object, so they release its lock and the threads of a study share the cores.
``inlined`` is for what has one or two callers: a tuple of arrays is copied word by word wherever it
is handed on.

Loops call loops of other files, of whose changes numba's cache on disk knows nothing: the stamp of
each is the content of all these files together, as kernels have it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from icage.kernels.digest import Sources
from icage.kernels.machine import stamped

FILES: Final = (
    "attack/guided.py",
    "attack/held.py",
    "attack/rigid_search.py",
    "closing/approach.py",
    "closing/computed_step.py",
    "closing/look.py",
    "closing/near_edges.py",
    "closing/push_loop.py",
    "closing/varied_shapes.py",
    "world/hand_in_object.py",
    "world/machine_loops.py",
)
"""Files of this package with compiled loops, or that loops call."""

_ROOM: Final = Path(__file__).parents[1]

SOURCES: Final = Sources(_ROOM, lambda: [_ROOM / name for name in FILES])


def _compiling(**options: Any) -> Any:
    def compiling(function: Callable[..., Any]) -> Any:
        return stamped(function, SOURCES, **options)

    return compiling


borrowing: Any = _compiling(nogil=True, _nrt=False)
"""Compile a loop that is called, from Python or from others."""

inlined: Any = _compiling(nogil=True, _nrt=False, inline="always")
"""Compile a loop into those that call it."""

counting: Any = _compiling()
"""Compile a loop that makes arrays."""
