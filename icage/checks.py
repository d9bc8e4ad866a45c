"""Is what a caller gave of the kind that was asked for? One place, one wording. Our own."""

from __future__ import annotations

import math
import os
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeGuard, TypeVar

from icage.errors import InputError

Kind = TypeVar("Kind")


def a_number(value: object, name: str, error: type[InputError] = InputError) -> float:
    """A finite real number as a float.

    >>> a_number(2, "width")
    2.0
    """
    try:
        if _is_a(value, Real) and math.isfinite(value):
            return float(value)
    except OverflowError:  # an integer beyond all floats
        pass
    raise error(f"{name} is {_shown(value)}; a finite number is needed")


def a_count(value: object, name: str, least: int = 1) -> int:
    """A whole number, at least ``least``.

    >>> a_count(3, "trials")
    3
    """
    if _is_a(value, Integral) and int(value) >= least:
        return int(value)
    raise InputError(f"{name} is {_shown(value)}; a whole number, {least} or more, is needed")


def one_of(value: object, names: tuple[str, ...], name: str) -> None:
    """One of some words."""
    if not isinstance(value, str) or value not in names:
        raise InputError(f"{name} is {_shown(value)}; one of {', '.join(names)} is needed")


def an_instance(value: Any, kind: type[Kind], name: str, hint: str = "") -> Kind:
    """A value of a class."""
    if not isinstance(value, kind):
        raise InputError(f"{name} is {_shown(value)}; a {kind.__name__} is needed{hint}")
    return value


def a_path(value: object, name: str) -> Path:
    """The path of a file, as text or a path."""
    if not isinstance(value, str | os.PathLike) or "\0" in os.fsdecode(value):
        raise InputError(f"{name} is {_shown(value)}; the path of a file is needed")
    return Path(os.fsdecode(value))


def _is_a(value: object, kind: type[Kind]) -> TypeGuard[Kind]:
    """Whether it is such a number; True and False are none."""
    return not isinstance(value, bool) and isinstance(value, kind)


def _shown(value: object) -> str:
    """Short, whatever it is."""
    if value is None or isinstance(value, str | bytes | bool | Real):
        try:
            text = repr(value)
        except ValueError:  # an integer of more digits than Python prints
            text = "a huge number"
        return text if len(text) <= 60 else f"{text[:57]}..."
    return f"a {type(value).__name__}"
