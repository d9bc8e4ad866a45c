"""Every uncertain input of a study: what it means, its unit, its nominal value and its bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from experiments.study.distributions import Distribution, DistributionError, parse_distribution
from icage.errors import InputError

Measure = Literal["length", "angle", "ratio"]

GROUPS: Final = ("placement", "contact", "table", "object", "shape", "hand")

_LENGTHS: Final = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
_ANGLES: Final = {"": 1.0, "rad": 1.0, "deg": math.pi / 180.0}


@dataclass(frozen=True, slots=True)
class Variable:
    """One uncertain input. Lengths in the case's unit, angles in [rad], ratios in [1].

    Attributes
    ----------
    low, high:
        Physical range; a distribution must lie in it.
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
    geometry: bool = False


_ANY = (-math.inf, math.inf)

VARIABLES: Final = {
    one.name: one
    for one in (
        Variable("place_x", "placement", "length", 0.0, *_ANY,
                 "the hand stands off its place by this, along the object's x axis"),
        Variable("place_y", "placement", "length", 0.0, *_ANY, "... along the object's y axis"),
        Variable("place_theta", "placement", "angle", 0.0, *_ANY,
                 "the hand is turned by this about the middle of its fingers"),
        Variable("place_sigma", "placement", "length", 0.0, *_ANY,
                 "the hand is open wider by this, its middle kept"),
        Variable("bias_x", "placement", "length", 0.0, *_ANY,
                 "the sensor sees the object off by this, along its x axis"),
        Variable("bias_y", "placement", "length", 0.0, *_ANY, "... along its y axis"),
        Variable("bias_theta", "placement", "angle", 0.0, *_ANY,
                 "... turned by this about its centroid"),
        Variable("friction", "contact", "ratio", 0.0, 0.0, 5.0,
                 "Coulomb coefficient between fingers and object"),
        Variable("softness", "contact", "ratio", 1.0, 1.0, 200.0,
                 "time constant of a contact over its usual one"),
        Variable("table_friction", "table", "ratio", 0.0, 0.0, 1.0,
                 "largest friction force of the table on the object, per axis, over the closing "
                 "force"),
        Variable("tilt", "table", "angle", 0.0, 0.0, 0.5 * math.pi, "of the table"),
        Variable("tilt_direction", "table", "angle", -0.5 * math.pi, *_ANY,
                 "downhill, from the object's x axis as it lies at the start"),
        Variable("weight", "table", "ratio", 0.2, 0.0, 10.0,
                 "of the object over the closing force; matters on a tilted table"),
        Variable("mass", "object", "ratio", 1.0, 0.01, 100.0, "over the usual one; weight goes "
                 "with it"),
        Variable("inertia", "object", "ratio", 1.0, 0.01, 100.0,
                 "moment of inertia over that of an even plate of this mass"),
        Variable("com_x", "object", "length", 0.0, *_ANY,
                 "centre of mass off the area centroid, along the object's x axis"),
        Variable("com_y", "object", "length", 0.0, *_ANY, "... along its y axis"),
        Variable("outline_scale", "shape", "ratio", 1.0, 0.5, 2.0,
                 "true size of the object over the planned one, about its centroid", True),
        Variable("outline_noise", "shape", "length", 0.0, 0.0, math.inf,
                 "root mean square of a smooth displacement of the boundary", True),
        Variable("finger_radius", "hand", "length", 0.0, *_ANY,
                 "error of the finger radius", True),
        Variable("phi_1", "hand", "angle", 0.0, *_ANY,
                 "error of the hand's angle at finger 1", True),
        Variable("phi_2", "hand", "angle", 0.0, *_ANY,
                 "error of the hand's angle at finger 2", True),
        Variable("linkage_play", "hand", "length", 0.0, 0.0, math.inf,
                 "how far a finger yields under the closing force", True),
        Variable("speed", "hand", "ratio", 1.0, 0.02, 50.0, "closing speed over the usual one"),
        Variable("force", "hand", "ratio", 1.0, 0.02, 50.0, "of the motor over the usual one"),
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
    if not (one.low <= found.low and found.high <= one.high):
        outside = (
            "a normal distribution has no bounds; use truncated:MEAN:SD:LOW:HIGH"
            if found.kind == "normal"
            else f"found {found.low:g} to {found.high:g}"
        )
        raise VariableError(
            f"vary.{name}: {outside}; {_allowed(one)} [{own_unit(one, unit)}] is allowed"
        )
    return {name: found}


def own_unit(one: Variable, unit: str) -> str:
    """Unit in which values of a variable are kept."""
    return {"length": unit, "angle": "rad", "ratio": "1"}[one.measure]


def _allowed(one: Variable) -> str:
    if math.isinf(one.high):
        return f"{one.low:g} or more"
    return f"{one.low:g} to {one.high:g}"


def _converted(one: Variable, number: float, suffix: str, unit: str, diameter: float) -> float:
    """A number with a unit in the variable's own; % of the diameter, or of 1."""
    if one.measure == "length":
        if suffix == "%":
            return 0.01 * number * diameter
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
            return number * (0.01 if suffix else 1.0)
        allowed = "none or %"
    raise DistributionError(f"unit {suffix!r} after {number:g}; {allowed} is allowed")


def listing() -> list[str]:
    """All variables, a line each, for ``icage study --variables``."""
    lines: list[str] = []
    for group in GROUPS:
        lines.append(f"{group}:")
        for one in (v for v in VARIABLES.values() if v.group == group):
            unit = own_unit(one, "length")
            lines.append(f"  {one.name:<16} [{unit}] {one.help} (nominal {one.nominal:.4g})")
    lines.append(f"pairs: {', '.join(f'{k} = {a}, {b}' for k, (a, b) in PAIRS.items())}")
    lines.append("a distribution is VALUE, LOW:HIGH, normal:SD, normal:MEAN:SD,")
    lines.append("truncated:MEAN:SD:LOW:HIGH, grid:A,B,C or grid:LOW:HIGH:COUNT; numbers may carry")
    lines.append("mm, cm, m (or % of the diameter), deg, rad, % (of 1)")
    return lines
