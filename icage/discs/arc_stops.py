"""Where an arc is split into chords or tangents, so that its contacts keep the arc's own normal."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from icage.arrays import FloatArray, IntArray

RESTING = 1e-3
"""[rad] Half the chord on which a contact of an arc rests. Were the contact a corner of the chords,
its normal would be off by half a step on either side, and a grasp could slide away that the arc
holds. The chord lies only 5e-7 radii inside."""

_GRADED = 3.0
"""[1] Beyond the resting chord each segment ends this many times as far from the contact: chords
are then flat against the distance from it, and levels there are those of the true curve."""

_WHOLE = 1e-6
"""[segment] An arc this little longer than a whole number of segments gets no further one: a right
angle that the rounding of a distant drawing has opened is split as the right angle is."""


def unit_vectors(angle: FloatArray) -> FloatArray:
    """Unit vectors (k, 2) in these directions (k,), [rad]."""
    return np.column_stack([np.cos(angle), np.sin(angle)])


def even_parts(turn: FloatArray, segments: int) -> IntArray:
    """Into how many equal parts (k,) arcs (k,) [rad] are split, ``segments`` a quadrant or more.

    Examples
    --------
    >>> even_parts(np.radians([0.0, 30.0, 45.0, 46.0]), 2).tolist()
    [1, 1, 1, 2]
    """
    parts = np.ceil(turn / (0.5 * math.pi / segments) - _WHOLE)
    return np.maximum(1, parts.astype(np.int64))


def even_stops(turn: float, segments: int, through: Iterable[float] = ()) -> FloatArray:
    """Angles from 0 to ``turn`` [rad], at most a quadrant / ``segments`` apart, the given ones too.

    Examples
    --------
    >>> (even_stops(np.pi, 2, [0.5 * np.pi]) / np.pi).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    coarse = 0.5 * math.pi / segments
    angles = [0.0]
    for low, high in pairwise(sorted({0.0, turn, *(t for t in through if 0.0 < t < turn)})):
        parts = max(1, math.ceil((high - low) / coarse - _WHOLE))
        angles.extend(np.linspace(low, high, parts + 1)[1:].tolist())
    return np.array(angles)


def resting_chords(turn: float, contacts: Iterable[float]) -> list[tuple[float, float]]:
    """Contacts on an arc, in order, each with half the short chord that it rests on, [rad].

    The chord is shorter where two contacts are close, and near an end of the arc: cut off there, it
    would have another normal.
    """
    resting = sorted(set(contacts))
    found: list[tuple[float, float]] = []
    for k, t in enumerate(resting):
        room = [abs(t - u) / 3.0 for u in resting[max(0, k - 1) : k + 2] if u != t]
        found.append((t, min([RESTING, t, turn - t, *room])))
    return found


def graded_stops(
    turn: float, segments: int, contacts: Iterable[float], *, touched: bool = False
) -> FloatArray:
    """Angles from 0 to ``turn`` that split an arc, at the contacts on it too if ``touched``.

    Round every contact a short chord, then longer and longer ones up to the common length.
    """
    coarse = 0.5 * math.pi / segments
    chords = resting_chords(turn, contacts)
    resting = [t for t, _ in chords]
    stops: set[float] = set()
    for t, half in chords:
        while half < coarse:
            stops |= {t - half, t + half}
            half *= _GRADED
    # a stop inside the resting chord of another contact would spoil it
    kept = [
        s
        for s in stops
        if all(
            abs(s - t) >= 0.999 * min(RESTING, t, turn - t) or _own(s, t, resting) for t in resting
        )
    ]
    return even_stops(turn, segments, [*kept, *resting] if touched else kept)


def _own(stop: float, contact: float, resting: list[float]) -> bool:
    """Whether a contact is the one that a stop is nearest to."""
    return min(resting, key=lambda t: abs(t - stop)) == contact
