"""The one decorator behind every compiled function, and its cache.

numba's own cache asks only whether the file of a function has changed, not the files of the
functions it calls: after an update that touches one kernel, its callers would go on running the
old machine code without a word. Here the stamp is the content of all kernel files together.
Environments that share a checkout do not share the cache, or each would make the other's stale:
the versions of numba and llvmlite are part of its files' names, as Python's is by numba's doing.
``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python, for debugging.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import llvmlite
import numba
from numba.core.event import Event, Listener, register

from icage.kernels.compiling import announce

Function = TypeVar("Function", bound=Callable[..., Any])

TOOLS = f"numba{numba.__version__}-llvmlite{llvmlite.__version__}"
"""What makes the machine code."""

_dispatchers: list[Any] = []
"""All kernels of this process."""


@lru_cache(maxsize=1)
def kernel_digest() -> str:
    """Digest of the sources of all kernels, and of the tolerances that they hold as constants."""
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted([package / "tolerance.py", *package.glob("**/kernels/*.py")]):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def compiled(function: Function) -> Function:
    """Compile without fast-math (results must not depend on it) and cache on disk.

    Kernels touch no Python object, so they release its lock and threads share the cores.

    Where numba may write a cache neither beside the file nor into the user's own folder, every
    process compiles for itself.
    """
    try:
        dispatcher: Any = numba.njit(cache=True, fastmath=False, nogil=True)(function)
    except RuntimeError:
        dispatcher = numba.njit(fastmath=False, nogil=True)(function)
        _dispatchers.append(dispatcher)
        return dispatcher
    if not hasattr(dispatcher, "_cache"):  # NUMBA_DISABLE_JIT=1: the plain function
        return dispatcher
    # private names of numba's, checked by a test: without them the cache would go stale unseen
    cache = dispatcher._cache
    cache._cache_file = type(cache._cache_file)(
        cache_path=cache.cache_path,
        filename_base=f"{cache._impl.filename_base}.{TOOLS}",
        source_stamp=kernel_digest(),
    )
    _dispatchers.append(dispatcher)
    return dispatcher


class _Watch(Listener):
    """Announces the first compilation, unless some kernel came from the cache."""

    def on_start(self, event: Event) -> None:
        kernel = (event.data or {}).get("dispatcher")
        if kernel in _dispatchers and not any(one.stats.cache_hits for one in _dispatchers):
            announce()

    def on_end(self, event: Event) -> None:
        pass


register("numba:compile", _Watch())
