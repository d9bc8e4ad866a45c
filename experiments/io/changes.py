"""What two records of one thing differ in, in words."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any


def changes(
    old: Mapping[str, Any],
    new: Mapping[str, Any],
    free: Collection[str] = (),
    shown: Callable[[Any], str] = repr,
) -> Iterator[str]:
    """A line per key whose value differs; keys in ``free`` may. ``shown`` makes words of a value.

    >>> list(changes({"seed": 0, "top": 1}, {"seed": 1, "top": 1}))
    ['seed was 0, is 1']
    """
    for key in sorted({*old, *new}):
        was, now = old.get(key), new.get(key)
        if was != now and key not in free:
            yield f"{key} was {shown(was)}, is {shown(now)}"
