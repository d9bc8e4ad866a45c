"""Warnings of Python and its libraries speak to who writes a program, not to who uses one."""

from __future__ import annotations

import sys
import warnings
from typing import Any


def keep_warnings() -> None:
    """Keep them to ourselves, in this process. Filters that make errors of them still do.

    ``python -W always`` and PYTHONWARNINGS show them.
    """
    if not sys.warnoptions:
        warnings.showwarning = _unheard


def _unheard(*_: Any, **__: Any) -> None:
    """Instead of ``warnings.showwarning``."""
