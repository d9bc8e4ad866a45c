"""Array aliases, and the one way in for numbers that users bring.

The aliases are in one file, because strict pyright rejects inline shape strings.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray: TypeAlias = NDArray[np.float64]
GreyArray: TypeAlias = NDArray[np.float32]
ComplexArray: TypeAlias = NDArray[np.complex128]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]
AnyArray: TypeAlias = NDArray[Any]


def read_only(array: AnyArray) -> AnyArray:
    """Return the array itself, marked read-only (value types hand out no writable state)."""
    array.flags.writeable = False
    return array


def real_numbers(values: ArrayLike) -> FloatArray:
    """The values as an array of floats of its own, of whatever shape.

    Raises
    ------
    TypeError, ValueError:
        Rows of different lengths, or anything but real numbers. (numpy alone drops imaginary parts
        and reads numbers out of strings.)

    Examples
    --------
    >>> real_numbers([[0, 1], [2, 3]]).tolist()
    [[0.0, 1.0], [2.0, 3.0]]
    >>> real_numbers(["0", "1"])
    Traceback (most recent call last):
    TypeError: only real numbers are allowed
    """
    found = np.array(values)
    kind = found.dtype.kind
    odd = found.ravel().tolist() if kind == "O" else []
    if kind in "cSUmMV" or any(isinstance(value, str | bytes | complex) for value in odd):
        raise TypeError("only real numbers are allowed")
    return found.astype(np.float64)
