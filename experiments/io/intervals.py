"""Intervals for rates: Wilson's, how often they hold the true rate, and when to stop counting.

Two-sided intervals are Wilson's; the one-sided bound of ``rate_upper``, on what was hardly ever or
never seen, is the exact one of Clopper and Pearson. Whatever prints one says which it is.

Everything here counts successes in independent trials of one rate. With q the rate seen, n the
trials and z the normal quantile, Wilson's bounds [Wilson1927] are

    (q + z^2 / 2n -+ z sqrt(q (1 - q) / n + z^2 / 4n^2)) / (1 + z^2 / n)

the rates p with |q - p| <= z sqrt(p (1 - p) / n).
"""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np
from scipy.special import betaincinv, ndtri
from scipy.stats import binom

from icage.arrays import BoolArray, FloatArray, IntArray

CONFIDENCE: Final = 0.95
"""[1] Of every two-sided interval that is printed."""

LOOK_EVERY: Final = 500
"""[trials] between two looks of a study that stops by itself."""

AT_LEAST: Final = 500
"""[trials] before the first look."""

Counts: TypeAlias = IntArray | int


def wilson(successes: int, trials: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Two-sided Wilson score interval of a rate; (0, 1) without trials.

    >>> tuple(round(end, 4) for end in wilson(180, 200)), wilson(0, 0)
    ((0.8506, 0.9343), (0.0, 1.0))
    """
    low, high = wilson_bounds(successes, trials, confidence)
    return float(low), float(high)


def wilson_bounds(
    successes: Counts, trials: Counts, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """Lower and upper ends of Wilson's interval, in the shape the counts broadcast to.

    >>> low, high = wilson_bounds(np.array([0, 5, 10]), 10)
    >>> low.round(3).tolist(), high.round(3).tolist()
    ([0.0, 0.237, 0.722], [0.278, 0.763, 1.0])
    """
    successes, trials = np.broadcast_arrays(successes, trials)
    z = float(ndtri(0.5 + 0.5 * confidence))
    n = np.maximum(trials, 1)
    rate = successes / n
    middle = rate + z * z / (2.0 * n)
    half = z * np.sqrt(rate * (1.0 - rate) / n + z * z / (4.0 * n * n))
    scale = 1.0 + z * z / n
    low = np.where(successes == 0, 0.0, (middle - half) / scale)
    high = np.where(successes == trials, 1.0, (middle + half) / scale)
    return np.maximum(low, 0.0), np.minimum(high, 1.0)


def rate_upper(successes: int, trials: int) -> float:
    """Upper end of the exact one-sided 95 % bound on a rate, at most 1. [Clopper1934]

    At this rate so few successes have probability 0.05. What is promised of escapes and failures is
    this bound: Wilson's, which is shorter, says 0.0133 of 0 in 200, and 0 in 200 still happens in
    6.8 % of runs at that rate.

    >>> round(rate_upper(0, 200), 4), rate_upper(0, 0)
    (0.0149, 1.0)
    """
    if successes >= trials:
        return 1.0
    return float(betaincinv(successes + 1, trials - successes, CONFIDENCE))


def half_width(successes: Counts, trials: Counts) -> FloatArray:
    """Half the length of the 95 % interval, in the shape the counts broadcast to.

    >>> round(float(half_width(180, 200)), 4), float(half_width(0, 0))
    (0.0419, 0.5)
    """
    low, high = wilson_bounds(successes, trials)
    return 0.5 * (high - low)


def exact_coverage(rate: float, trials: int, confidence: float = CONFIDENCE) -> float:
    """Probability that Wilson's interval of ``trials`` trials holds their true rate.

    The sum of the binomial probabilities of all counts whose interval holds it: no simulation. It
    jumps with rate and trials about the confidence, never settling on it.

    >>> round(exact_coverage(0.9, 200), 4)
    0.9561
    """
    counts = np.arange(trials + 1)
    low, high = wilson_bounds(counts, trials, confidence)
    return float(binom.pmf(counts[(low <= rate) & (rate <= high)], trials, rate).sum())


def stopped_at(
    successes: BoolArray,
    wanted: float,
    look_every: int = LOOK_EVERY,
    at_least: int = AT_LEAST,
) -> int | None:
    """[trials] at the first look at which the half width is at most ``wanted``; None if none is.

    Looks come after ``at_least`` trials (1 or more) and after every ``look_every`` more, over
    ``successes`` (n,) in trial order: which trial ran first on the clock changes nothing.

    A run that stops where it looks good is not the fixed number of trials that an interval is
    made for. With the constants above, half widths of 0.005 to 0.02 and rates of 0.5 to 0.99, the
    interval at the stop still holds the rate in 0.947 to 0.968 of all runs. At 0.999 it is 0.910
    to 0.929, which is Wilson's own at so few trials (500 fixed: 0.910), not the stopping's.
    [benchmarks/coverage.py]

    >>> stopped_at(np.ones(2000, dtype=bool), wanted=0.003)
    1000
    """
    looks = np.arange(at_least, len(successes) + 1, look_every)
    seen = np.cumsum(successes, dtype=np.int64)[looks - 1]
    enough = np.flatnonzero(half_width(seen, looks) <= wanted)
    return int(looks[enough[0]]) if len(enough) else None
