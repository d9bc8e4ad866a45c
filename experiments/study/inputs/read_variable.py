"""Read one line of a study: an input's name and distribution, with units, checked."""

from __future__ import annotations

from typing import Final

from experiments.study.inputs.distributions import (
    Distribution,
    DistributionError,
    parse_distribution,
)
from experiments.study.inputs.variables import DEGREE, PAIRS, PERCENT, VARIABLES, Variable, own_unit
from icage.errors import InputError
from icage.units import METRES

_ANGLES: Final = {"": 1.0, "rad": 1.0, "deg": DEGREE}

_ROUNDING: Final = 1e-12
"""[1] A bound in diameters, converted, may be off by this."""


class VariableError(InputError):
    """An unknown variable, or values that it cannot have."""


def read_variable(name: str, given: object, unit: str, diameter: float) -> dict[str, Distribution]:
    """Name to distribution of one line of a study; two for a pair.

    Raises
    ------
    VariableError:
        Names the variable, what was found and what is allowed.
    """
    if name in PAIRS:
        parts = (read_variable(part, given, unit, diameter) for part in PAIRS[name])
        return {key: value for part in parts for key, value in part.items()}
    if name not in VARIABLES:
        known = ", ".join([*VARIABLES, *PAIRS])
        raise VariableError(f"vary.{name}: no such variable; known are {known}")
    one = VARIABLES[name]

    def convert(number: float, suffix: str) -> float:
        return _converted(one, number, suffix, unit, diameter)

    try:
        found = parse_distribution(given, one.nominal, convert)
    except DistributionError as error:
        raise VariableError(f"vary.{name}: {error}") from error
    check_range(one, found, unit, diameter)
    return {name: found}


def check_range(one: Variable, found: Distribution, unit: str, diameter: float) -> None:
    """Refuse values that no hand, object or table has.

    Raises
    ------
    VariableError:
        Names the variable, what was found and what is allowed.
    """
    low, high = one.range_in(diameter)
    least, most = found.reach if one.tails else (found.low, found.high)
    slack = _ROUNDING * diameter if one.measure == "length" else 0.0
    if low - slack <= least and most <= high + slack:
        return
    if found.kind != "normal":
        outside = f"found {least:g} to {most:g}"
    elif one.tails:
        outside = f"its mean and four standard deviations reach from {least:g} to {most:g}"
    else:
        outside = "a normal distribution has no bounds; use truncated:MEAN:SD:LOW:HIGH"
    share = f" ({one.written_range} of the diameter)" if one.measure == "length" else ""
    raise VariableError(
        f"vary.{one.name}: {outside}; {low:g} to {high:g} [{own_unit(one, unit)}]{share} is allowed"
    )


def _converted(one: Variable, number: float, suffix: str, unit: str, diameter: float) -> float:
    """A number with a unit in the variable's own; % of the diameter, or of 1."""
    if one.measure == "length":
        if suffix == "%":
            return PERCENT * number * diameter
        if suffix == "":
            return number
        if suffix in METRES:
            return number * METRES[suffix] / METRES[unit]
        allowed = "mm, cm, m or % (of the diameter)"
    elif one.measure == "angle":
        if suffix in _ANGLES:
            return number * _ANGLES[suffix]
        allowed = "deg or rad"
    else:
        if suffix in ("", "%"):
            return number * (PERCENT if suffix else 1.0)
        allowed = "none or %"
    raise DistributionError(f"unit {suffix!r} after {number:g}; {allowed} is allowed")
