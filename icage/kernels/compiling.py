"""Word that the kernels are about to be compiled, for whoever would wonder at the wait.

Apart from the decorator so that it can be asked for without loading numba.
"""

from __future__ import annotations

from collections.abc import Callable

_listener: Callable[[], None] | None = None


def when_compiling(tell: Callable[[], None]) -> None:
    """Have ``tell`` called, once, if this process finds no compiled kernels."""
    global _listener
    _listener = tell


def announce() -> None:
    """Tell whoever asked; nobody is told twice."""
    global _listener
    tell, _listener = _listener, None
    if tell is not None:
        tell()
