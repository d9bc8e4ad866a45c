"""What the pictures of a study share: names in words, units, numbers, and few enough bins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from experiments.io.intervals import wilson
from experiments.study.inputs.variables import Variable, own_unit

_COUNTS: Final = ("trials", "closed", "target", "near_target")
"""Of a bin; documents of earlier versions lack the last."""


def display(one: Variable, unit: str) -> tuple[float, str]:
    """Factor from the unit in which a variable is kept to the one it is shown in, and that unit.

    Angles are shown in degrees; a ratio has no unit.
    """
    if one.measure == "angle":
        return 180.0 / math.pi, "°"
    return 1.0, "" if one.measure == "ratio" else own_unit(one, unit)


def number(value: float, digits: int = 4) -> str:
    """A number with a few digits, never "-0".

    >>> number(0.30000000000000004), number(-1e-17 * 0), number(1234567.0)
    ('0.3', '0', '1.235e+06')
    """
    return f"{value + 0.0:.{digits}g}"


def percent(rate: float) -> str:
    """A rate in percent: 0 and 100 only if it is; one decimal, or more near the ends.

    >>> [percent(r) for r in (0.0, 1.0, 0.5, 0.8333, 0.99617, 0.00004, 0.999996)]
    ['0 %', '100 %', '50.0 %', '83.3 %', '99.62 %', '0.0040 %', '99.99960 %']
    """
    if rate in (0.0, 1.0):
        return f"{100 * rate:g} %"
    near = min(rate, 1.0 - rate)
    decimals = max(1, 1 - math.floor(math.log10(100.0 * near * (1.0 + 1e-9))))
    return f"{100.0 * rate:.{decimals}f} %"


def merged(bins: Sequence[Mapping[str, Any]], most: int) -> list[Mapping[str, Any]]:
    """At most ``most`` bins: neighbours made one where there are more."""
    if len(bins) <= most:
        return list(bins)
    groups: list[list[Mapping[str, Any]]] = [[] for _ in range(most)]
    for k, one in enumerate(bins):
        groups[k * most // len(bins)].append(one)
    return [_one(group) for group in groups]


def _one(bins: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    known = [key for key in _COUNTS if all(key in one for one in bins)]
    counts = {key: sum(one[key] for one in bins) for key in known}
    trials, closed, target = counts["trials"], counts["closed"], counts["target"]
    return {
        "low": bins[0]["low"],
        "high": bins[-1]["high"],
        "mean": sum(one["mean"] * one["trials"] for one in bins) / trials,
        **counts,
        "rate_95": list(wilson(target, closed)) if closed else None,
    }
