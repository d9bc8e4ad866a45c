"""Every uncertain input of a study, one row each: all that anything else knows of it is here.

What is read from a user, listed, drawn, written and shown follows from the rows; so does what an
input does, since a row names the field that it sets. An input is added here, and nowhere else where
such a field is there already. docs/formats.md has the rows as a table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, TypeVar

Measure = Literal["length", "angle", "ratio"]

Group = Literal["placement", "contact", "table", "object", "shape", "hand"]

GROUPS: Final[tuple[Group, ...]] = ("placement", "contact", "table", "object", "shape", "hand")

PLACEMENT: Final[Group] = "placement"
"""Saltelli's design exchanges these together, and the drawn start with them."""

Part = Literal["hand", "seen", "world", "slope", "shape"]
"""Of a trial, what inputs set: ``HandError`` and ``SeenError`` of ``study.inputs.placements``,
``Worlds`` of ``sim.closing.varied``, ``Slope`` of ``study.run.worlds`` (from which gravity follows)
and ``ShapeError`` of ``study.inputs.variants``."""

PERCENT: Final = 0.01

DEGREE: Final = math.pi / 180.0
"""[rad]"""

_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class Variable:
    """One uncertain input. Nominal values of lengths are 0, angles in [rad], ratios in [1].

    Attributes
    ----------
    low, high:
        Physical range, lengths in [diameter]; a distribution must lie in it.
    part, field:
        What it sets: a field of the value that makes this part of a trial.
    label:
        What figures and pages call it, in a few words.
    tails:
        Whether a normal distribution may vary it: what lies beyond four standard deviations may
        then be out of range.
    pair:
        One word for two independent inputs with the same distribution; "" if there is none.
    """

    name: str
    group: Group
    measure: Measure
    nominal: float
    low: float
    high: float
    part: Part
    field: str
    label: str
    help: str
    tails: bool = False
    pair: str = ""

    @property
    def geometry(self) -> bool:
        """Whether it changes what is compiled: outline, discs or linkage."""
        return self.part == "shape"

    def range_in(self, diameter: float) -> tuple[float, float]:
        """The range in the unit of the diameter, [rad] or [1]."""
        scale = diameter if self.measure == "length" else 1.0
        return scale * self.low, scale * self.high

    @property
    def written_range(self) -> str:
        """The allowed range as numbers of a distribution."""
        if self.measure == "length":
            return f"{self.low / PERCENT:g}% to {self.high / PERCENT:g}%"
        if self.measure == "ratio":
            return f"{self.low:g} to {self.high:g}"
        return " to ".join(_written_angle(end) for end in (self.low, self.high))

    @property
    def written_nominal(self) -> str:
        """Its nominal value as a number of a distribution."""
        return _written_angle(self.nominal) if self.nominal < 0.0 else f"{self.nominal:g}"


def _written_angle(value: float) -> str:
    degrees = value / DEGREE
    return f"{degrees:g}deg" if degrees == round(degrees) else f"{value:g}rad"


_FAR = (-10.0, 10.0)
_TURN = (-2.0 * math.pi, 2.0 * math.pi)

VARIABLES: Final = {
    one.name: one
    for one in (
        Variable("place_x", "placement", "length", 0.0, *_FAR,
                 "hand", "x", "hand off its place, along x",
                 "the hand stands off its place by this, along the object's x axis",
                 tails=True, pair="place_xy"),
        Variable("place_y", "placement", "length", 0.0, *_FAR,
                 "hand", "y", "hand off its place, along y",
                 "the hand stands off its place by this, along the object's y axis",
                 tails=True, pair="place_xy"),
        Variable("place_theta", "placement", "angle", 0.0, *_TURN,
                 "hand", "theta", "hand turned",
                 "the hand is turned by this about the middle of its fingers", tails=True),
        Variable("place_sigma", "placement", "length", 0.0, *_FAR,
                 "hand", "sigma", "hand open wider",
                 "the hand is open wider by this, its middle kept", tails=True),
        Variable("bias_x", "placement", "length", 0.0, *_FAR,
                 "seen", "x", "object seen off, along x",
                 "the sensor sees the object off by this, along its x axis",
                 tails=True, pair="bias_xy"),
        Variable("bias_y", "placement", "length", 0.0, *_FAR,
                 "seen", "y", "object seen off, along y",
                 "the sensor sees the object off by this, along its y axis",
                 tails=True, pair="bias_xy"),
        Variable("bias_theta", "placement", "angle", 0.0, *_TURN,
                 "seen", "theta", "object seen turned",
                 "the sensor sees the object turned by this about its centroid", tails=True),
        Variable("friction", "contact", "ratio", 0.0, 0.0, 5.0,
                 "world", "friction", "friction of the fingers",
                 "Coulomb coefficient between fingers and object"),
        Variable("softness", "contact", "ratio", 1.0, 1.0, 200.0,
                 "world", "softness", "softness of contacts / usual",
                 "time constant of a contact over its usual one"),
        Variable("table_friction", "table", "ratio", 0.0, 0.0, 1.0,
                 "world", "table_friction", "table friction / closing force",
                 "largest friction force of the table on the object, per axis, over the closing "
                 "force"),
        Variable("tilt", "table", "angle", 0.0, 0.0, 0.5 * math.pi,
                 "slope", "tilt", "tilt of the table",
                 "slope of the table"),
        Variable("tilt_direction", "table", "angle", -0.5 * math.pi, *_TURN,
                 "slope", "direction", "direction of the tilt",
                 "direction of downhill, from the object's x axis as it lies at the start",
                 tails=True),
        Variable("weight", "table", "ratio", 0.2, 0.0, 10.0,
                 "slope", "weight", "weight / closing force",
                 "weight of the object over the closing force; matters on a tilted table"),
        Variable("mass", "object", "ratio", 1.0, 0.01, 100.0,
                 "world", "mass", "mass / usual",
                 "mass of the object over the usual one; its weight goes with it"),
        Variable("inertia", "object", "ratio", 1.0, 0.01, 100.0,
                 "world", "inertia", "inertia / even plate",
                 "moment of inertia of the object over that of an even plate of its mass"),
        Variable("com_x", "object", "length", 0.0, -1.0, 1.0,
                 "world", "com_x", "centre of mass off, along x",
                 "centre of mass off the area centroid, along the object's x axis", tails=True),
        Variable("com_y", "object", "length", 0.0, -1.0, 1.0,
                 "world", "com_y", "centre of mass off, along y",
                 "centre of mass off the area centroid, along the object's y axis", tails=True),
        Variable("outline_scale", "shape", "ratio", 1.0, 0.5, 2.0,
                 "shape", "scale", "object's size / planned",
                 "true size of the object over the planned one, about its centroid"),
        Variable("outline_noise", "shape", "length", 0.0, 0.0, 0.05,
                 "shape", "noise", "displaced boundary, RMS",
                 "root mean square of a smooth displacement of the boundary"),
        Variable("finger_radius", "hand", "length", 0.0, -1.0, 1.0,
                 "shape", "finger_radius", "error of the finger radius",
                 "error of the finger radius; a disc must be left", tails=True),
        Variable("phi_1", "hand", "angle", 0.0, -0.5, 0.5,
                 "shape", "phi_1", "error of phi_1",
                 "error of phi_1, the direction from finger 1 to finger 3 against that from finger "
                 "1 to finger 2; a triangle must be left", tails=True),
        Variable("phi_2", "hand", "angle", 0.0, -0.5, 0.5,
                 "shape", "phi_2", "error of phi_2",
                 "error of phi_2, the direction from finger 2 to finger 3 against that from finger "
                 "1 to finger 2 (outside the triangle); a triangle must be left", tails=True),
        Variable("linkage_play", "hand", "length", 0.0, 0.0, 0.1,
                 "shape", "play", "play of the linkage",
                 "how far a finger yields under the closing force"),
        Variable("speed", "hand", "ratio", 1.0, 0.02, 50.0,
                 "world", "speed", "closing speed / usual",
                 "closing speed over the usual one"),
        Variable("force", "hand", "ratio", 1.0, 0.02, 50.0,
                 "world", "force", "motor force / usual",
                 "force of the motor over the usual one"),
    )
}  # fmt: skip

PAIRS: Final = {
    pair: tuple(one.name for one in VARIABLES.values() if one.pair == pair)
    for pair in dict.fromkeys(one.pair for one in VARIABLES.values() if one.pair)
}
"""Word of a pair to its inputs."""


def own_unit(one: Variable, unit: str) -> str:
    """Unit in which values of a variable are kept."""
    return {"length": unit, "angle": "rad", "ratio": "1"}[one.measure]


def label(name: str) -> str:
    """What figures and pages call an input, or a group of Saltelli's design."""
    return "placement of the hand" if name == PLACEMENT else VARIABLES[name].label


def input_of(part: Part, field: str) -> Variable:
    """The input that sets this field."""
    return next(v for v in VARIABLES.values() if (v.part, v.field) == (part, field))


def fields_of(part: Part, values: Mapping[str, _Value]) -> dict[str, _Value]:
    """Field to value, of those that make one part of a trial; ``values`` are by input."""
    return {v.field: values[v.name] for v in VARIABLES.values() if v.part == part}


def is_placement(name: str) -> bool:
    """Whether an input is about where the hand stands."""
    return VARIABLES[name].group == PLACEMENT
