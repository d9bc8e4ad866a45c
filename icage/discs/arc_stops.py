"""Where an arc is split into chords or tangents, so that its contacts keep the arc's own normal."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from icage.arrays import FloatArray
from icage.discs.kernels.arc_stops import RESTING as RESTING
from icage.discs.kernels.arc_stops import resting_halves, stops_between


def unit_vectors(angle: FloatArray) -> FloatArray:
    """Unit vectors (k, 2) in these directions (k,), [rad]."""
    return np.column_stack([np.cos(angle), np.sin(angle)])


def even_stops(turn: float, segments: int, through: Iterable[float] = ()) -> FloatArray:
    """Angles from 0 to ``turn`` [rad], at most a quadrant / ``segments`` apart, the given ones too.

    Examples
    --------
    >>> (even_stops(np.pi, 2, [0.5 * np.pi]) / np.pi).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    knots = sorted({0.0, turn, *(t for t in through if 0.0 < t < turn)})
    return stops_between(np.array(knots), segments)


def resting_chords(turn: float, contacts: Iterable[float]) -> list[tuple[float, float]]:
    """Contacts on an arc, in order, each with half the short chord that it rests on, [rad].

    The chord is shorter where two contacts are close, and near an end of the arc: cut off there, it
    would have another normal.
    """
    resting, half = resting_halves(turn, np.array(list(contacts), dtype=np.float64))
    return list(zip(resting.tolist(), half.tolist(), strict=True))
