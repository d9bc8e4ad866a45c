"""Numbers as captions write them."""

from __future__ import annotations


def significant(value: float, digits: int = 4) -> str:
    """A computed number with all its digits: a zero at the end is one that is known.

    >>> significant(1.1), significant(0.3206), significant(1234.2), significant(1.0899951, 5)
    ('1.100', '0.3206', '1234', '1.0900')
    """
    return f"{value:#.{digits}g}".rstrip(".")
