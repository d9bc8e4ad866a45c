"""Coverage of the intervals of studies that stop by themselves, simulated and without chance."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from scipy.stats import binom

from experiments.io.intervals import AT_LEAST, LOOK_EVERY, half_width, wilson_bounds


def simulated_stops(
    rate: float, wanted: float, runs: int, rng: np.random.Generator
) -> tuple[float, float]:
    """Share of runs whose interval at the stop holds the rate, and their mean length [trials]."""
    held, spent = 0, 0
    seen = np.zeros(runs, dtype=np.int64)  # of the runs that go on
    for before, looked in looks():
        seen = seen + rng.binomial(looked - before, rate, len(seen))
        stops = half_width(seen, looked) <= wanted
        low, high = wilson_bounds(seen[stops], looked)
        held += int(((low <= rate) & (rate <= high)).sum())
        spent += looked * int(stops.sum())
        seen = seen[~stops]
        if not len(seen):
            break
    return held / runs, spent / runs


def exact_stops(rate: float, wanted: float) -> tuple[float, float]:
    """The same without chance: the count's distribution among runs that go on, look by look."""
    held, spent = 0.0, 0.0
    weight = np.ones(1)  # [probability] of every count
    for before, looked in looks():
        added = looked - before
        weight = np.convolve(weight, binom.pmf(np.arange(added + 1), added, rate))
        counts = np.arange(looked + 1)
        stops = half_width(counts, looked) <= wanted
        low, high = wilson_bounds(counts, looked)
        held += float(weight[stops & (low <= rate) & (rate <= high)].sum())
        spent += looked * float(weight[stops].sum())
        weight[stops] = 0.0
        if stops.all():  # any run has stopped, however it went
            break
    return held, spent


def looks() -> Iterator[tuple[int, int]]:
    """Trials at the look before and at this one; without an end: every run stops."""
    before = 0
    for looked in itertools.count(AT_LEAST, LOOK_EVERY):
        yield before, looked
        before = looked
