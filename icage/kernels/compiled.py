"""The one decorator behind every compiled function, and its cache.

numba's own cache asks only whether the file of a function has changed, not the files of the
functions it calls: after an update that touches one kernel, its callers would go on running the
old machine code without a word. Here the stamp is the content of all kernel files together.
``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python, for debugging.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


@lru_cache(maxsize=1)
def kernel_digest() -> str:
    """Digest of the sources of all kernels."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def compiled(function: Function) -> Function:
    """Compile without fast-math (results must not depend on it) and cache on disk."""
    dispatcher: Any = numba.njit(cache=True, fastmath=False)(function)
    if not hasattr(dispatcher, "_cache"):  # NUMBA_DISABLE_JIT=1: the plain function
        return dispatcher
    # private names of numba's, checked by a test: without them the cache would go stale unseen
    dispatcher._cache._cache_file._source_stamp = kernel_digest()
    return dispatcher
