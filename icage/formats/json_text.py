"""JSON that a user gives: parsed strictly, then taken apart with the place of every mistake."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn, cast

import numpy as np

from icage.arrays import FloatArray
from icage.errors import CaseError, FormatError
from icage.formats.files import decode

_KINDS = {dict: "an object", list: "a list", str: "a string", bool: "true or false"}


def parse_json(content: bytes, where: str) -> object:
    """The JSON value in UTF-8 bytes; NaN and Infinity are no JSON, and a key stands once.

    Raises
    ------
    CaseError:
        Not text, not JSON (says the line and column), nested too deeply, a key given twice.
    """

    def refuse(constant: str) -> NoReturn:
        raise CaseError(f"{where}: {constant} is not a JSON number; finite numbers are needed")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            raise CaseError(f"{where}: key {twice!r} is given twice in one object")
        return found

    try:
        return json.loads(decode(content, where), parse_constant=refuse, object_pairs_hook=once)
    except FormatError as error:
        raise CaseError(str(error)) from error
    except json.JSONDecodeError as error:
        raise CaseError(
            f"{where} is not valid JSON: {error.msg}, line {error.lineno} column {error.colno}"
        ) from error
    except RecursionError as error:
        raise CaseError(f"{where} is nested too deeply") from error
    except ValueError as error:  # an integer of thousands of digits
        raise CaseError(f"{where} has a number with too many digits") from error


def describe(value: object) -> str:
    """What a value is, short enough for one line."""
    if value is None:
        return "null"
    kind = _KINDS.get(cast(type, type(value)))
    if kind in ("an object", "a list"):
        return kind
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "..."


def an_object(value: object, where: str) -> dict[str, Any]:
    """The value as a JSON object."""
    if not isinstance(value, dict):
        raise CaseError(f"{where} is {describe(value)}; an object is needed")
    return cast("dict[str, Any]", value)


def required(data: dict[str, Any], key: str, where: str) -> Any:
    """The value of a key that must be there."""
    if key not in data:
        near = [other for other in data if other.lower().replace("-", "_") == key]
        hint = f" (it has {near[0]!r})" if near else ""
        raise CaseError(f"{where} has no key {key!r}{hint}")
    return data[key]


def a_number(value: object, where: str) -> float:
    """The value as a finite number; true and false are none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CaseError(f"{where} is {describe(value)}; a number is needed")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise CaseError(f"{where} is too large for a double; a finite number is needed")
    return number


def points(value: object, where: str, *, least: int = 0, most: int) -> FloatArray:
    """The value as points (k, 2), ``least`` <= k <= ``most``: a list of pairs [x, y]."""
    if not isinstance(value, list):
        raise CaseError(f"{where} is {describe(value)}; a list of pairs [x, y] is needed")
    rows = cast("list[object]", value)
    if not least <= len(rows) <= most:
        needed = f"{most} are needed" if least == most else f"at most {most}"
        raise CaseError(f"{where} has {len(rows)} points; {needed}")
    found = np.empty((len(rows), 2))
    for k, row in enumerate(rows):
        if not isinstance(row, list) or len(cast("list[object]", row)) != 2:
            raise CaseError(f"{where}[{k}] is {describe(row)}; a pair of numbers [x, y] is needed")
        for axis, entry in enumerate(cast("list[object]", row)):
            found[k, axis] = a_number(entry, f"{where}[{k}][{axis}]")
    return found
