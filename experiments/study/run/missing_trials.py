"""Which trials of a study are still to be run, cut into shards."""

from __future__ import annotations

from itertools import pairwise


def missing(spans: list[tuple[int, int]], total: int, size: int) -> list[tuple[int, int]]:
    """(first, last) of what spans leave of trials 0..total-1, cut into pieces of ``size``.

    >>> missing([(0, 3), (6, 7)], 12, 3)
    [(4, 5), (8, 9), (10, 11)]
    """
    gaps: list[tuple[int, int]] = []
    at = 0
    for first, last in [*sorted(spans), (total, total)]:
        gaps += _cut(at, min(first, total), size)
        at = max(at, last + 1)
    return gaps


def _cut(first: int, end: int, size: int) -> list[tuple[int, int]]:
    """Even pieces of first..end-1, none longer than ``size``."""
    count = -(-(end - first) // size) if end > first else 0
    edges = [first + (end - first) * k // count for k in range(count + 1)] if count else []
    return [(a, b - 1) for a, b in pairwise(edges)]
