"""The second engine under one typed name, imported only when somebody asks for it."""

from __future__ import annotations

import importlib
from typing import Any, TypeAlias

from icage.errors import InputError

Space: TypeAlias = Any
Body: TypeAlias = Any


def chipmunk() -> Any:
    """The package ``pymunk``.

    Raises
    ------
    InputError:
        It is not installed.
    """
    try:
        return importlib.import_module("pymunk")
    except ImportError as error:
        raise InputError(
            "the second engine needs pymunk, which is not installed: pip install 'icage[second]'"
        ) from error
