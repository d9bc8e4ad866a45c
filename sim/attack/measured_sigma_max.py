"""A physical sigma_max: at which opening do attacks begin to succeed? An interval, not a number."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.errors import InputError
from sim.attack.held import ESCAPED, Attacks

AttackAt = Callable[[FloatArray, np.random.Generator], Attacks]
"""Runs one attack per opening (N,) [diameter]."""

_NO_WIDTH = 1e-12
"""[1] A window no wider than this (relative) holds no more levels to try."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Where attacks begin to succeed. Lengths in [diameter].

    Attributes
    ----------
    low:
        Largest opening tried below the first escape (0 if even the least tried let one out).
    high:
        Least opening at which one escaped, inf if none did.
    seen:
        Least sigma that an escape really had, its stop giving way: at least ``low`` as a rule.
    held, escaped:
        Attacks at or below ``low``, none of which escaped; and escapes over all.
    penetration_max, rise_max:
        Over all of them.
    """

    low: float
    high: float
    seen: float
    held: int
    escaped: int
    attacks: int
    penetration_max: float
    rise_max: float


def measure(
    attack_at: AttackAt,
    window: tuple[float, float],
    rng: np.random.Generator,
    *,
    rounds: int,
    sections: int,
    repeats: int,
    known: Sequence[Attacks] = (),
) -> Measured:
    """Cut a window of openings [diameter] in ``sections`` and go on in the one where escapes begin.

    Every level is attacked ``repeats`` times in a round. ``rounds`` narrow the window by a factor
    of ``sections + 1`` each; it begins below any escape that is ``known`` already.
    """
    low, high = window
    if not 0.0 < low < high < math.inf:
        raise InputError(f"a window of openings {window} has no width")
    runs = list(known)
    least = _least_escape(runs)
    high = least if low < least < high else high
    for number in range(rounds):
        levels = np.linspace(low, high, sections + 2)
        ends = number == 0  # later both ends have been attacked
        tried = levels if ends else levels[1:-1]
        runs.append(attack_at(np.repeat(tried, repeats), rng))
        least = _least_escape(runs)
        if not low < least <= high:
            break
        high = least
        low = float(levels[levels < least].max())
        if not high > low * (1.0 + _NO_WIDTH):
            break
    openings = np.concatenate([run.openings for run in runs])
    escaped = np.concatenate([run.ending == ESCAPED for run in runs])
    rise = np.concatenate([run.rise_max for run in runs])
    first = float(openings[escaped].min()) if escaped.any() else math.inf
    below = openings < first
    return Measured(
        low=float(openings[below].max()) if below.any() else 0.0,
        high=first,
        seen=float((openings * rise)[escaped].min()) if escaped.any() else math.inf,
        held=int(below.sum()),
        escaped=int(escaped.sum()),
        attacks=len(openings),
        penetration_max=max(float(run.penetration_max.max()) for run in runs),
        rise_max=float(rise.max()),
    )


def _least_escape(runs: Sequence[Attacks]) -> float:
    """Least opening at which one escaped, inf if none did."""
    return min(
        (float(run.openings[run.ending == ESCAPED].min()) for run in runs if run.escapes),
        default=math.inf,
    )
