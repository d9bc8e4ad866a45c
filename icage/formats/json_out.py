"""JSON answers: finite numbers in full precision, files whole or not at all."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from icage.formats.whole_files import whole_file


def json_text(document: dict[str, Any]) -> str:
    """The document, one line a key; numpy values as the numbers they hold.

    Raises
    ------
    ValueError:
        A number is NaN or infinite: then the document is wrong, never the reader.

    Examples
    --------
    >>> print(json_text({"sigma": np.float64(0.1), "ids": np.arange(2)}), end="")
    {
    "sigma": 0.1,
    "ids": [0, 1]
    }
    """
    lines = [f"{json.dumps(key)}: {_dumped(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_json(document: dict[str, Any], target: str) -> None:
    """To the file ``target``, whole or not at all, or to standard output for ``-``."""
    text = json_text(document)
    if target == "-":
        sys.stdout.write(text)
        return
    with whole_file(Path(target)) as part:
        part.write_text(text, encoding="utf-8")


def _dumped(value: Any) -> str:
    return json.dumps(value, allow_nan=False, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in JSON")
