"""What libraries raise about what a user gave ends here, in an error of ours."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from types import TracebackType
from typing import Final

from icage.errors import FormatError, LibraryError

_OF_GEOMETRY: Final = ("ShapelyError", "LinAlgError")
"""Bases of the errors of shapely and numpy, by name: asking must not load them."""


@contextmanager
def geometry_told() -> Generator[None]:
    """Around a way in: errors of the libraries that compute geometry are input errors, and flags
    that they leave in the processor are no warnings.

    GEOS divides by zero where it wants to; numpy would report that at whatever call of shapely.

    Raises
    ------
    LibraryError:
        In place of an error of shapely or of numpy's linear algebra.
    """
    import numpy as np

    try:
        with np.errstate(all="ignore"):
            yield
    except Exception as error:
        if {kind.__name__ for kind in type(error).__mro__}.isdisjoint(_OF_GEOMETRY):
            raise
        raise LibraryError(
            f"a library that computes geometry gave up on this object: {error}"
        ) from error


@contextmanager
def decoding_told(library: str, what: str) -> Generator[None]:
    """Whatever a library raises about a broken file is a format error; our own faults stay so.

    Raises
    ------
    FormatError:
        In place of any error that was raised within the package ``library``.
    """
    try:
        yield
    except Exception as error:
        if not raised_in(error, library):
            raise
        why = " ".join(str(error).split())[:160] or type(error).__name__
        raise FormatError(f"{what} cannot be read ({why})") from error


def raised_in(error: BaseException, package: str) -> bool:
    """Whether the innermost frame of an error is in a module of the package.

    >>> import json
    >>> try:
    ...     json.loads("{")
    ... except ValueError as error:
    ...     raised_in(error, "json"), raised_in(error, "shapely")
    (True, False)
    """
    frame: TracebackType | None = error.__traceback__
    name = ""
    while frame is not None:
        name, frame = str(frame.tb_frame.f_globals.get("__name__", "")), frame.tb_next
    return name == package or name.startswith(f"{package}.")
