"""Arrays as text in a page: their bytes in base64, little-endian, with the name of their type.

JavaScript has a typed array of each of these names; doubles keep every bit, infinities too.
"""

from __future__ import annotations

from base64 import b64encode
from typing import Any, Final

import numpy as np

from icage.arrays import AnyArray, IntArray

_TYPES: Final = {"Float64Array": "<f8", "Uint16Array": "<u2", "Uint32Array": "<u4"}


def doubles(array: AnyArray) -> dict[str, Any]:
    """Numbers in full precision, row after row."""
    return _encoded(array, "Float64Array")


def indices(array: IntArray) -> dict[str, Any]:
    """Whole numbers of 0 or more, in two bytes each where they fit.

    >>> indices(np.array([[1, 2], [3, 4]]))
    {'type': 'Uint16Array', 'data': 'AQACAAMABAA='}
    """
    largest = int(array.max()) if array.size else 0
    return _encoded(array, "Uint16Array" if largest < 1 << 16 else "Uint32Array")


def _encoded(array: AnyArray, name: str) -> dict[str, Any]:
    plain = np.ascontiguousarray(array).astype(_TYPES[name])
    return {"type": name, "data": b64encode(plain.tobytes()).decode("ascii")}
