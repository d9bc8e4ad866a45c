"""How the loops over closings are compiled.

They make no array and return none, so they count no references: what numba counts at every view of
an array, in steps that no two threads can take at once, was half the time of a computed step. They
touch no Python object, so they release its lock and the threads of a study share the cores.
``inlined`` is for what has one or two callers: a tuple of arrays is copied word by word wherever it
is handed on.
"""

from __future__ import annotations

from typing import Any

from numba import njit

_njit: Any = njit  # whose type tells of no private options

borrowing: Any = _njit(cache=True, nogil=True, _nrt=False)
"""Compile a loop that is called, from Python or from others."""

inlined: Any = _njit(cache=True, nogil=True, _nrt=False, inline="always")
"""Compile a loop into those that call it."""
