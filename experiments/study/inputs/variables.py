"""Every uncertain input of a study: what it means, its unit, its nominal value and its bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from experiments.study.inputs.distributions import (
    Distribution,
    DistributionError,
    parse_distribution,
)
from icage.errors import InputError

Measure = Literal["length", "angle", "ratio"]

GROUPS: Final = ("placement", "contact", "table", "object", "shape", "hand")

PERCENT: Final = 0.01

DEGREE: Final = math.pi / 180.0
"""[rad]"""

_LENGTHS: Final = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
_ANGLES: Final = {"": 1.0, "rad": 1.0, "deg": DEGREE}

_ROUNDING: Final = 1e-12
"""[1] A bound in diameters, converted, may be off by this."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One uncertain input. Nominal values of lengths are 0, angles in [rad], ratios in [1].

    Attributes
    ----------
    low, high:
        Physical range, lengths in [diameter]; a distribution must lie in it.
    tails:
        Whether a normal distribution may vary it: what lies beyond four standard deviations may
        then be out of range.
    geometry:
        Whether it changes what is compiled: outline, discs or linkage.
    """

    name: str
    group: str
    measure: Measure
    nominal: float
    low: float
    high: float
    help: str
    tails: bool = False
    geometry: bool = False

    def range_in(self, diameter: float) -> tuple[float, float]:
        """The range in the unit of the diameter, [rad] or [1]."""
        scale = diameter if self.measure == "length" else 1.0
        return scale * self.low, scale * self.high


_FAR = (-10.0, 10.0)
_TURN = (-2.0 * math.pi, 2.0 * math.pi)

VARIABLES: Final = {
    one.name: one
    for one in (
        Variable("place_x", "placement", "length", 0.0, *_FAR,
                 "the hand stands off its place by this, along the object's x axis", True),
        Variable("place_y", "placement", "length", 0.0, *_FAR,
                 "the hand stands off its place by this, along the object's y axis", True),
        Variable("place_theta", "placement", "angle", 0.0, *_TURN,
                 "the hand is turned by this about the middle of its fingers", True),
        Variable("place_sigma", "placement", "length", 0.0, *_FAR,
                 "the hand is open wider by this, its middle kept", True),
        Variable("bias_x", "placement", "length", 0.0, *_FAR,
                 "the sensor sees the object off by this, along its x axis", True),
        Variable("bias_y", "placement", "length", 0.0, *_FAR,
                 "the sensor sees the object off by this, along its y axis", True),
        Variable("bias_theta", "placement", "angle", 0.0, *_TURN,
                 "the sensor sees the object turned by this about its centroid", True),
        Variable("friction", "contact", "ratio", 0.0, 0.0, 5.0,
                 "Coulomb coefficient between fingers and object"),
        Variable("softness", "contact", "ratio", 1.0, 1.0, 200.0,
                 "time constant of a contact over its usual one"),
        Variable("table_friction", "table", "ratio", 0.0, 0.0, 1.0,
                 "largest friction force of the table on the object, per axis, over the closing "
                 "force"),
        Variable("tilt", "table", "angle", 0.0, 0.0, 0.5 * math.pi, "slope of the table"),
        Variable("tilt_direction", "table", "angle", -0.5 * math.pi, *_TURN,
                 "direction of downhill, from the object's x axis as it lies at the start", True),
        Variable("weight", "table", "ratio", 0.2, 0.0, 10.0,
                 "weight of the object over the closing force; matters on a tilted table"),
        Variable("mass", "object", "ratio", 1.0, 0.01, 100.0,
                 "mass of the object over the usual one; its weight goes with it"),
        Variable("inertia", "object", "ratio", 1.0, 0.01, 100.0,
                 "moment of inertia of the object over that of an even plate of its mass"),
        Variable("com_x", "object", "length", 0.0, -1.0, 1.0,
                 "centre of mass off the area centroid, along the object's x axis", True),
        Variable("com_y", "object", "length", 0.0, -1.0, 1.0,
                 "centre of mass off the area centroid, along the object's y axis", True),
        Variable("outline_scale", "shape", "ratio", 1.0, 0.5, 2.0,
                 "true size of the object over the planned one, about its centroid",
                 geometry=True),
        Variable("outline_noise", "shape", "length", 0.0, 0.0, 0.05,
                 "root mean square of a smooth displacement of the boundary", geometry=True),
        Variable("finger_radius", "hand", "length", 0.0, -1.0, 1.0,
                 "error of the finger radius; a disc must be left", True, geometry=True),
        Variable("phi_1", "hand", "angle", 0.0, -0.5, 0.5,
                 "error of phi_1, the direction from finger 1 to finger 3 against that from finger "
                 "1 to finger 2; a triangle must be left", True, geometry=True),
        Variable("phi_2", "hand", "angle", 0.0, -0.5, 0.5,
                 "error of phi_2, the direction from finger 2 to finger 3 against that from finger "
                 "1 to finger 2 (outside the triangle); a triangle must be left", True,
                 geometry=True),
        Variable("linkage_play", "hand", "length", 0.0, 0.0, 0.1,
                 "how far a finger yields under the closing force", geometry=True),
        Variable("speed", "hand", "ratio", 1.0, 0.02, 50.0, "closing speed over the usual one"),
        Variable("force", "hand", "ratio", 1.0, 0.02, 50.0,
                 "force of the motor over the usual one"),
    )
}  # fmt: skip

PAIRS: Final = {"place_xy": ("place_x", "place_y"), "bias_xy": ("bias_x", "bias_y")}
"""One word for two independent inputs with the same distribution."""


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
    _check_range(one, found, unit, diameter)
    return {name: found}


def _check_range(one: Variable, found: Distribution, unit: str, diameter: float) -> None:
    """Refuse values that no hand, object or table has."""
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
    share = f" ({_written_range(one)} of the diameter)" if one.measure == "length" else ""
    raise VariableError(
        f"vary.{one.name}: {outside}; {low:g} to {high:g} [{own_unit(one, unit)}]{share} is allowed"
    )


def own_unit(one: Variable, unit: str) -> str:
    """Unit in which values of a variable are kept."""
    return {"length": unit, "angle": "rad", "ratio": "1"}[one.measure]


def _written_range(one: Variable) -> str:
    """The allowed range as numbers of a distribution."""
    if one.measure == "length":
        return f"{one.low / PERCENT:g}% to {one.high / PERCENT:g}%"
    if one.measure == "ratio":
        return f"{one.low:g} to {one.high:g}"
    return " to ".join(_written_angle(end) for end in (one.low, one.high))


def _written_angle(value: float) -> str:
    degrees = value / DEGREE
    return f"{degrees:g}deg" if degrees == round(degrees) else f"{value:g}rad"


def _converted(one: Variable, number: float, suffix: str, unit: str, diameter: float) -> float:
    """A number with a unit in the variable's own; % of the diameter, or of 1."""
    if one.measure == "length":
        if suffix == "%":
            return PERCENT * number * diameter
        if suffix == "":
            return number
        if suffix in _LENGTHS:
            return number * _LENGTHS[suffix] / _LENGTHS[unit]
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


def listing() -> list[str]:
    """All variables, a line each, for ``icage study --variables``."""
    lines: list[str] = []
    for group in GROUPS:
        lines.append(f"{group}:")
        for one in (v for v in VARIABLES.values() if v.group == group):
            unit = own_unit(one, "length")
            usual = _written_angle(one.nominal) if one.nominal < 0.0 else f"{one.nominal:g}"
            allowed = f"nominal {usual}, allowed {_written_range(one)}"
            lines.append(f"  {one.name:<16} [{unit}] {one.help} ({allowed})")
    lines.append(f"pairs: {', '.join(f'{k} = {a}, {b}' for k, (a, b) in PAIRS.items())}")
    lines.append("a distribution is VALUE, LOW:HIGH, normal:SD, normal:MEAN:SD,")
    lines.append("truncated:MEAN:SD:LOW:HIGH, grid:A,B,C or grid:LOW:HIGH:COUNT; numbers may carry")
    lines.append("mm, cm, m (or % of the diameter), deg, rad, % (of 1). normal is for what may be")
    lines.append("negative: its mean and four standard deviations must lie in the range")
    return lines
