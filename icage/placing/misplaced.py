"""Hands that are off from where they should stand, each finger by no more than a tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from icage.arrays import ComplexArray, FloatArray, read_only
from icage.checks import a_count
from icage.errors import GeometryError

if TYPE_CHECKING:
    from icage.placing.best import BestPlacement

_ROUNDS = 1000
"""Rounds of drawing before giving up: a third and more of the hands of a round are taken."""

_INSIDE = 1.0 - 1e-9
"""[1] Fingers are off by this share of the tolerance at most: it holds for less than itself."""

_HALVINGS = 60


def draw_misplaced(
    best: BestPlacement, count: int, rng: np.random.Generator, *, furthest: bool = False
) -> FloatArray:
    """Placements (count, 4) whose fingers are each off by less than ``best.tolerance``.

    Uniform in position and angle, and in the size if the opening may err (else the size is that of
    the placement). ``furthest`` moves each on, the same way, until a finger is off by all of the
    tolerance.

    Examples
    --------
    >>> import icage
    >>> best = icage.place(icage.plan(icage.load("pliers")), opening=70.0)
    >>> from icage.placing.misplaced import draw_misplaced
    >>> draw_misplaced(best, 5, np.random.default_rng(0))[:, 3].tolist()
    [70.0, 70.0, 70.0, 70.0, 70.0]
    """
    a_count(count, "count")
    f = best.fingers @ np.array([1.0, 1.0j])
    w = f[1] - f[0]
    arm: ComplexArray = (f - f.mean()) / w
    r = _INSIDE * best.tolerance
    # the middle is off by the mean of what the fingers are off by, and a side by at most twice
    side = max(abs(f[i] - f[j]) for i in range(len(f)) for j in range(i))
    most = 2.0 * np.arcsin(min(1.0, r / side))
    wide = 2.0 * r / side * abs(w)
    found = list[ComplexArray]()
    have = 0
    for _ in range(_ROUNDS):
        if have >= count:
            break
        n = 4 * (count - have) + 16
        shift = r * _in_disc(rng, n)
        change: ComplexArray = wide * _in_disc(rng, n)
        if not best.opening_error:
            change = 1j * most * rng.uniform(-1.0, 1.0, n)
        off = _off(arm, w, shift, change, best.opening_error)
        steps: ComplexArray = np.stack([shift, change], axis=1)[off <= r]
        found.append(steps)
        have += len(steps)
    if have < count:
        raise GeometryError(f"only {have} of {count} misplaced hands in {_ROUNDS} rounds")
    shift, change = np.concatenate(found)[:count].T
    if furthest:
        shift, change = _stretched(arm, w, shift, change, r, best.opening_error)
    turned = w + change if best.opening_error else w * np.exp(change)
    first = f.mean() + shift + turned * arm[0]
    size = np.abs(turned) if best.opening_error else np.full(count, best.placement.sigma)
    return read_only(np.column_stack([first.real, first.imag, np.angle(turned), size]))


def _in_disc(rng: np.random.Generator, n: int) -> ComplexArray:
    """Complex numbers (n,), uniform in the unit disc."""
    found: ComplexArray = np.sqrt(rng.random(n)) * np.exp(2j * np.pi * rng.random(n))
    return found


def _off(
    arm: ComplexArray, w: complex, shift: ComplexArray, change: ComplexArray, errs: bool
) -> FloatArray:
    """How far the finger that is most off is, (n,)."""
    step = change if errs else w * (np.exp(change) - 1.0)
    return np.abs(shift[:, None] + step[:, None] * arm).max(axis=1)


def _stretched(
    arm: ComplexArray, w: complex, shift: ComplexArray, change: ComplexArray, r: float, errs: bool
) -> tuple[ComplexArray, ComplexArray]:
    """The same steps, longer, so that the furthest finger is off by r."""
    if errs:
        by = r / _off(arm, w, shift, change, errs)
        return shift * by, change * by
    low, high = np.ones(len(shift)), np.full(len(shift), 2.0)
    for _ in range(_HALVINGS):  # until all are out of it
        out = _off(arm, w, shift * high, change * high, errs) > r
        if out.all():
            break
        high[~out] *= 2.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        within = _off(arm, w, shift * middle, change * middle, errs) <= r
        low, high = np.where(within, middle, low), np.where(within, high, middle)
    return shift * low, change * low
