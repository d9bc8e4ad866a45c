"""The whole curve mu -> sigma_first(mu), with its jumps; and how much friction an opening bears.

The level never rises with mu. It falls in jumps, where a jam appears far from what jammed before,
and continuously between them. Intervals over which it falls are halved, the largest fall first:
a jump is followed until it is narrow, other falls until a straight line describes them.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass, field, replace

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.cage import Cage
from icage.cells.work import work_of
from icage.checks import a_number, an_instance
from icage.errors import InputError
from icage.friction.jam import Jam, JamTolerance
from icage.friction.jam_search import JamSearch
from icage.friction.levels import FrictionLevel, checked_mu, limited
from icage.library_faults import geometry_told
from icage.values import Value

_MOST = 500
"""Coefficients at which the level is computed."""

_NARROW = 1e-9
"""[1] A jump is followed until it is bracketed to this, in mu."""

_FLAT = 1e-8
"""[1] A fall of less (relative) is none: more than what levels of two searches may differ by."""

_STRAIGHT = 1e-3
"""[1] A fall is followed until the middle is this near to a straight line, over the fall, ..."""

_SMALL = 1e-4
"""[1] ... or is this small over the level."""


@dataclass(frozen=True, slots=True, eq=False)
class Jump(Value):
    """A coefficient at which the level jumps: between ``mu`` and ``mu_above`` [1].

    ``before`` and ``after`` [unit] are the levels there (inf: none); ``jam`` limits the level from
    there on.
    """

    mu: float
    mu_above: float
    before: float
    after: float
    jam: Jam | None


@dataclass(frozen=True, slots=True, eq=False)
class FrictionCurve(Value):
    """sigma_first against mu, from 0 to ``largest``.

    ``mu`` and ``level`` (n,) are where it was computed, in [1] and [unit] (inf: however far the
    hand opens), ``breakpoints`` its jumps. A level holds for all smaller mu.
    """

    mu: FloatArray
    level: FloatArray
    breakpoints: tuple[Jump, ...]
    tolerance: JamTolerance
    _levels: tuple[FrictionLevel, ...] = field(repr=False)
    _cage: Cage = field(repr=False)

    def __post_init__(self) -> None:
        for name in ("mu", "level"):
            object.__setattr__(self, name, read_only(np.array(getattr(self, name), np.float64)))

    @property
    def largest(self) -> float:
        """The largest coefficient of the curve."""
        return float(self.mu[-1])

    def at(self, mu: float) -> FrictionLevel:
        """The level for a coefficient, computed there unless the curve is level round it.

        Raises
        ------
        InputError:
            No number from 0 to ``largest``.
        """
        mu = checked_mu(mu)
        if mu > self.largest:
            raise InputError(f"mu is {mu:g}; this curve goes from 0 to {self.largest:g}")
        k = int(np.searchsorted(self.mu, mu, side="right")) - 1
        if self.mu[k] == mu:
            return self._levels[k]
        if self.level[k] == self.level[k + 1]:
            return replace(self._levels[k], mu=mu)
        work = work_of(self._cage)
        if work is None:
            return replace(self._levels[k], mu=mu)
        return limited(JamSearch(self._cage, work), replace(self._levels[k], mu=mu))

    def sigma_first(self, mu: float) -> float | None:
        """[unit] The level for a coefficient; None if there is none. See ``at``."""
        return self.at(mu).sigma_first

    def mu_max(self, opening: float) -> float | None:
        """[1] How much friction a hand bears that opens to ``opening`` [unit]; at most ``largest``.

        Up to it closing from there ends within the tolerance of the target. To 1e-9, from below.
        None if the opening is not below sigma_first even without friction.

        Raises
        ------
        InputError:
            No positive number.
        """
        opening = a_number(opening, "the opening")
        if opening <= 0.0:
            raise InputError(f"the opening is {opening:g}; more than 0 is needed")
        below = np.flatnonzero(self.level > opening)
        if not len(below):
            return None
        k = int(below[-1])
        low = float(self.mu[k])
        if k + 1 == len(self.mu):
            return low
        high = float(self.mu[k + 1])
        while high - low > _NARROW:
            middle = 0.5 * (low + high)
            if _level(self.at(middle)) > opening:
                low = middle
            else:
                high = middle
        return low


@geometry_told()
def friction_curve(
    cage: Cage, largest: float = 1.0, tolerance: JamTolerance | None = None
) -> FrictionCurve:
    """sigma_first for every coefficient from 0 to ``largest``.

    Jumps are bracketed to 1e-9 in mu, continuous falls followed to 1e-3 of each. At most 500
    levels are computed.

    Raises
    ------
    InputError:
        ``largest`` is not a positive number; no cage.
    MethodError:
        The cage was planned by the contact space: plan it by the cells.

    Examples
    --------
    Turned by 0.02 rad a hand jams on a triangle from tan(0.02) on.

    >>> from icage.planner import plan
    >>> cage = plan(
    ...     [[0, 0], [1, 0], [0.5, 0.75**0.5]],
    ...     [[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]],
    ... )
    >>> curve = friction_curve(cage)
    >>> [round(jump.mu, 6) for jump in curve.breakpoints]
    [0.020003]
    >>> round(curve.mu_max(0.6), 6)
    0.020003
    """
    an_instance(cage, Cage, "cage", "; icage.plan makes one")
    largest = checked_mu(largest, "largest")
    if largest == 0.0:
        raise InputError("largest is 0; a curve needs a positive coefficient of friction")
    chosen = JamTolerance() if tolerance is None else tolerance
    work = work_of(cage)
    start = FrictionLevel(0.0, cage.sigma_first, None, chosen, cage)
    found = {0.0: start}
    search = None if work is None else JamSearch(cage, work)

    def computed(mu: float, smaller: FrictionLevel) -> FrictionLevel:
        level = replace(smaller, mu=mu)
        found[mu] = level if search is None else limited(search, level)
        return found[mu]

    waiting = [_fall(start, computed(largest, start), math.inf)]
    jumps: list[tuple[FrictionLevel, FrictionLevel]] = []
    while waiting:
        fall, low, high, before = heapq.heappop(waiting)
        size = -fall
        if size <= _FLAT:
            continue
        a, b = found[low], found[high]
        if high - low <= _NARROW or len(found) >= _MOST:
            if size > _SMALL:
                jumps.append((a, b))
            continue
        middle = computed(0.5 * (low + high), a)
        straight = 0.5 * (_level(a) + _level(b))
        off = abs(_level(middle) - straight) if math.isfinite(straight) else math.inf
        if off <= _STRAIGHT * (_level(a) - _level(b)) and before <= 10.0 * _STRAIGHT:
            continue
        if size <= _SMALL and off <= _SMALL * _level(b):
            continue
        bent = off / max(_level(a) - _level(b), 1e-300)
        for one, two in ((a, middle), (middle, b)):
            heapq.heappush(waiting, _fall(one, two, bent))
    mus = sorted(found)
    levels = _never_rising([found[mu] for mu in mus])
    jumps.sort(key=lambda pair: pair[0].mu)
    return FrictionCurve(
        np.array(mus), np.array([_level(one) for one in levels]),
        tuple(Jump(a.mu, b.mu, _level(a), _level(b), b.jam) for a, b in jumps),
        chosen, levels, cage,
    )  # fmt: skip


def _never_rising(found: list[FrictionLevel]) -> tuple[FrictionLevel, ...]:
    """The levels by mu, without the rounding of searches that were bounded by others."""
    kept = found[:1]
    for level in found[1:]:
        last = kept[-1]
        rises = _level(level) > _level(last)
        kept.append(replace(level, sigma_first=last.sigma_first) if rises else level)
    return tuple(kept)


def _fall(a: FrictionLevel, b: FrictionLevel, bent: float) -> tuple[float, float, float, float]:
    """An interval to look into: how far the level falls (negative, relative), its ends, and how
    bent the interval was that it is half of.
    """
    low, high = _level(b), _level(a)
    size = 0.0 if low == high else 1.0 if math.isinf(high) else 1.0 - low / high
    return -size, a.mu, b.mu, bent


def _level(level: FrictionLevel) -> float:
    return math.inf if level.sigma_first is None else level.sigma_first
