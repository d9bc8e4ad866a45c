"""What all frozen values have in common: equality and a hash that answer, arrays included. Our own.

A dataclass that holds arrays cannot compare itself: ``==`` of two arrays is an array. Here two
values are equal if they are of one class and all their compared fields are equal, arrays by shape
and content.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import fields
from typing import Any

import numpy as np


class Value:
    """Base of a frozen dataclass (``eq=False``) whose fields may be arrays.

    Examples
    --------
    >>> from icage.hand import HandShape
    >>> one, other = (HandShape.from_angles_deg(60.0, 120.0) for _ in range(2))
    >>> one == other, len({one, other}), one == "a hand"
    (True, 1, False)
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return _compared(self) == _compared(other)

    def __hash__(self) -> int:
        return hash((type(self).__name__, _compared(self)))


def _compared(value: Any) -> tuple[Hashable, ...]:
    return tuple(_key(getattr(value, one.name)) for one in fields(value) if one.compare)


def _key(value: Any) -> Hashable:
    """The value itself, or something that is equal just where the value is."""
    if isinstance(value, np.ndarray):
        # adding 0.0 makes -0.0 and 0.0 one number, as == does
        same = value + 0.0 if value.dtype.kind in "fc" else value
        return (value.shape, value.dtype.str, same.tobytes())
    if isinstance(value, tuple | list):
        return tuple(_key(one) for one in value)
    return value
