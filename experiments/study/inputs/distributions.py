"""Distributions of uncertain inputs, and the words a user writes for them.

    0.3                     fixed (also fixed:0.3)
    0:0.8                   uniform (also uniform:0:0.8)
    normal:2mm              normal about the variable's nominal value
    normal:1:0.1            normal with mean and standard deviation
    truncated:0.3:0.1:0:1   normal, conditioned on an interval
    grid:0,0.1,0.2          each value as often as any other
    grid:0:1:11             11 values from 0 to 1

Every number may carry a unit (mm, cm, m; deg, rad; %). A distribution maps uniform numbers in
[0, 1) to values, so one design of experiments serves them all.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from scipy.special import ndtr, ndtri

from icage.arrays import FloatArray
from icage.errors import InputError

Kind = Literal["fixed", "uniform", "normal", "truncated", "grid"]

LONGEST_GRID: Final = 10_000

_COUNTS: Final = {"fixed": 1, "uniform": 2, "normal": 2, "truncated": 4}
"""Parameters of each kind but the grid."""

LARGEST: Final = 1e100
"""Of any number: its square is still one."""

_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-z%]*)")

Convert = Callable[[float, str], float]
"""A number with the unit written behind it ("" for none), in the variable's own unit."""


class DistributionError(InputError):
    """A distribution that cannot be read, or is none."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """Values of one uncertain input.

    Attributes
    ----------
    parameters:
        fixed: (value,); uniform: (low, high); normal: (mean, sd); truncated: (mean, sd, low,
        high); grid: the values.
    """

    kind: Kind
    parameters: tuple[float, ...]

    def __post_init__(self) -> None:
        p = self.parameters
        if len(p) != _COUNTS.get(self.kind, len(p)):
            raise DistributionError(f"{len(p)} numbers; {self.kind} has {_COUNTS[self.kind]}")
        if not all(abs(value) <= LARGEST for value in p):
            raise DistributionError(f"finite numbers, up to {LARGEST:g}, are needed")
        if self.kind == "uniform" and not p[0] < p[1]:
            raise DistributionError(
                f"the range {p[0]:g} to {p[1]:g} is empty; LOW < HIGH is needed"
            )
        if self.kind in ("normal", "truncated") and not p[1] > 0.0:
            raise DistributionError(
                f"a standard deviation of {p[1]:g}; a number above 0 is needed (or a fixed value)"
            )
        if self.kind == "truncated":
            if not p[2] < p[3]:
                raise DistributionError(
                    f"the range {p[2]:g} to {p[3]:g} is empty; LOW < HIGH is needed"
                )
            if self._mass() < 1e-9:
                raise DistributionError(
                    f"the range {p[2]:g} to {p[3]:g} holds none of a normal distribution with "
                    f"mean {p[0]:g} and standard deviation {p[1]:g}"
                )
        if self.kind == "grid" and not 1 <= len(p) <= LONGEST_GRID:
            raise DistributionError(f"{len(p)} values; 1 to {LONGEST_GRID} are allowed")

    @property
    def low(self) -> float:
        """Least value; -inf for a normal distribution."""
        if self.kind == "normal":
            return -math.inf
        return self.parameters[2] if self.kind == "truncated" else min(self.parameters)

    @property
    def high(self) -> float:
        """Largest value; inf for a normal distribution."""
        if self.kind == "normal":
            return math.inf
        return self.parameters[3] if self.kind == "truncated" else max(self.parameters)

    @property
    def reach(self) -> tuple[float, float]:
        """Least and largest value; of a normal distribution, four standard deviations each way."""
        if self.kind != "normal":
            return self.low, self.high
        mean, deviation = self.parameters
        return mean - 4.0 * deviation, mean + 4.0 * deviation

    @property
    def varies(self) -> bool:
        """Whether two trials may get different values."""
        return self.kind != "fixed" and not (self.kind == "grid" and len(self.parameters) == 1)

    def values(self, uniform: FloatArray) -> FloatArray:
        """Values (n,) at quantiles (n,) in [0, 1). Inverse of the distribution function."""
        p = self.parameters
        if self.kind == "fixed":
            return np.full(len(uniform), p[0])
        if self.kind == "uniform":
            return np.clip(p[0] + (p[1] - p[0]) * uniform, p[0], p[1])
        if self.kind == "grid":
            return np.array(p)[np.minimum((uniform * len(p)).astype(np.int64), len(p) - 1)]
        share = np.clip(uniform, 1e-16, 1.0 - 1e-16)  # 0 would be minus infinity
        if self.kind == "normal":
            return p[0] + p[1] * ndtri(share)
        least = ndtr((p[2] - p[0]) / p[1])
        return np.clip(p[0] + p[1] * ndtri(least + share * self._mass()), p[2], p[3])

    def _mass(self) -> float:
        mean, deviation, low, high = self.parameters
        return float(ndtr((high - mean) / deviation) - ndtr((low - mean) / deviation))


def parse_distribution(given: Any, nominal: float, convert: Convert) -> Distribution:
    """What a user wrote, a number or a string, as a distribution in the variable's own unit.

    Parameters
    ----------
    nominal:
        Mean of ``normal:SD``.

    Raises
    ------
    DistributionError:
        It cannot be read.
    """
    if isinstance(given, bool) or not isinstance(given, (int, float, str)):
        raise DistributionError(f"{given!r} is neither a number nor a distribution")
    if isinstance(given, int) and abs(given) > LARGEST:
        given = math.inf
    if not isinstance(given, str):
        return Distribution("fixed", (convert(float(given), ""),))
    head, _, rest = given.strip().partition(":")
    name = head.strip().lower()
    if name == "grid":
        return Distribution("grid", _grid(rest, convert))
    if name in ("fixed", "uniform", "normal", "truncated"):
        numbers = [_number(text, convert) for text in rest.split(":")]
        if name == "normal" and len(numbers) == 1:
            numbers.insert(0, nominal)
        wanted = {"fixed": 1, "uniform": 2, "normal": 2, "truncated": 4}[name]
        if len(numbers) != wanted:
            raise DistributionError(f"{given!r} has {len(numbers)} numbers; see `{_FORMS[name]}`")
        return Distribution(name, tuple(numbers))
    numbers = [_number(text, convert) for text in given.split(":")]
    if len(numbers) == 1:
        return Distribution("fixed", (numbers[0],))
    if len(numbers) == 2:
        return Distribution("uniform", (numbers[0], numbers[1]))
    raise DistributionError(f"{given!r} is no distribution; write {ALLOWED}")


_FORMS: Final = {
    "fixed": "fixed:VALUE",
    "uniform": "uniform:LOW:HIGH",
    "normal": "normal:SD or normal:MEAN:SD",
    "truncated": "truncated:MEAN:SD:LOW:HIGH",
    "grid": "grid:A,B,C or grid:LOW:HIGH:COUNT",
}

ALLOWED: Final = "VALUE, LOW:HIGH, normal:SD, normal:MEAN:SD, truncated:MEAN:SD:LOW:HIGH, " + (
    "grid:A,B,C or grid:LOW:HIGH:COUNT"
)


def _grid(text: str, convert: Convert) -> tuple[float, ...]:
    if ":" not in text:
        return tuple(_number(part, convert) for part in text.split(","))
    parts = text.split(":")
    if len(parts) != 3 or not (parts[2].strip().isdigit() and len(parts[2].strip()) <= 9):
        raise DistributionError(f"'grid:{text}' is no grid; see `{_FORMS['grid']}`")
    count = int(parts[2])
    if not 1 <= count <= LONGEST_GRID:
        raise DistributionError(f"{count} values; 1 to {LONGEST_GRID} are allowed")
    low, high = (_number(part, convert) for part in parts[:2])
    return tuple(np.linspace(low, high, count).tolist())


def _number(text: str, convert: Convert) -> float:
    found = _NUMBER.fullmatch(text.strip())
    if found is None:
        raise DistributionError(f"{text.strip()!r} is no number; write {ALLOWED}")
    return convert(float(found[1]), found[2])
