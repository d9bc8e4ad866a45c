"""Stretches of an outline where no finger may touch, by arclength."""

from __future__ import annotations

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from icage.outline import Outline


def stretch(outline: Outline, start: float, end: float) -> FloatArray:
    """Segments (n, 4) = x, y, x, y of the outline from one arclength to another, [unit].

    Arclength runs counterclockwise from the first vertex; a stretch that begins behind its end runs
    over the first vertex.

    Raises
    ------
    InputError:
        An arclength below 0 or above the outline's length.

    Examples
    --------
    >>> square = Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> stretch(square, 1.0, 3.0).tolist()
    [[1.0, 0.0, 2.0, 0.0], [2.0, 0.0, 2.0, 1.0]]
    >>> len(stretch(square, 7.0, 1.0))
    2
    """
    a = outline.vertices
    side = np.roll(a, -1, axis=0) - a
    length = np.hypot(side[:, 0], side[:, 1])
    at = np.concatenate([[0.0], np.cumsum(length)])
    whole = float(at[-1])
    for value in (start, end):
        if not 0.0 <= value <= whole * (1.0 + 1e-9):
            raise InputError(
                f"avoid from {start:g} to {end:g}: arclengths run from 0 to {whole:.6g}, the "
                "length of the outline"
            )
    parts = [(start, end)] if start <= end else [(start, whole), (0.0, end)]
    found: list[FloatArray] = []
    for low, high in parts:
        t_0 = np.clip((low - at[:-1]) / length, 0.0, 1.0)
        t_1 = np.clip((high - at[:-1]) / length, 0.0, 1.0)
        use = t_1 > t_0
        if low == high:  # a point is a stretch, too
            use = np.arange(len(a)) == min(int(np.searchsorted(at, low, "right")) - 1, len(a) - 1)
        found.append(
            np.hstack([a[use] + t_0[use, None] * side[use], a[use] + t_1[use, None] * side[use]])
        )
    return np.concatenate(found)
