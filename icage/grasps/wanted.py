"""Which grasps are looked for, for which hands, and a grasp that was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, TypeAlias

from icage.arrays import FloatArray
from icage.checks import a_number, one_of
from icage.errors import InputError

Aim: TypeAlias = Literal["first", "cage", "friction"]
"""What is ranked: sigma_first / sigma_0, sigma_max / sigma_0, or sigma_first(mu) / sigma_0."""

AIMS: Final[tuple[Aim, ...]] = ("first", "cage", "friction")

Stretch: TypeAlias = tuple[float, float]
"""From one arclength of the outline to another, counterclockwise from its first vertex, [unit]."""

LEAST_ANGLE: Final = math.radians(15.0)
"""[rad] Flatter hands are hard to build: their middle finger stands between the others."""

LEAST_GAP: Final = 0.02
"""[diameter] Fingers have to be somewhere: the free gap between two, where none is asked for."""


@dataclass(frozen=True, slots=True)
class HandLimits:
    """What a real hand can be. Sigma is measured between the two fingers that are furthest apart
    (where a shape is wanted: between its fingers 1 and 2).

    Attributes
    ----------
    least_angle:
        [rad] The least angle of its triangle.
    least_gap:
        [unit] The least free gap between two fingers on the target; None: 2 % of the object's
        diameter.
    sigma_least:
        [unit] As far as the hand closes: the target must not need less.
    sigma_most:
        [unit] As far as the hand opens: the target must need less, and a cage counts up to there.

    Raises
    ------
    InputError:
        A limit that no hand can meet.

    Examples
    --------
    >>> HandLimits(least_angle=0.3, least_gap=5.0).sigma_most
    inf
    """

    least_angle: float = LEAST_ANGLE
    least_gap: float | None = None
    sigma_least: float = 0.0
    sigma_most: float = math.inf

    def __post_init__(self) -> None:
        a_number(self.least_angle, "least_angle")
        if not 0.0 <= self.least_angle < math.pi / 3.0:
            raise InputError(
                f"least_angle = {self.least_angle:g} rad is {math.degrees(self.least_angle):g} "
                "degrees; a triangle has an angle of at most 60, and less than that is needed"
            )
        if self.least_gap is not None:
            a_number(self.least_gap, "least_gap")
            if self.least_gap < 0.0:
                raise InputError(f"least_gap = {self.least_gap:g}; 0 or more is needed")
        a_number(self.sigma_least, "sigma_least")
        if self.sigma_most != math.inf:
            a_number(self.sigma_most, "sigma_most")
        if not 0.0 <= self.sigma_least < self.sigma_most:
            raise InputError(
                f"sigma from {self.sigma_least:g} to {self.sigma_most:g}: 0 <= least < most is "
                "needed"
            )


ANY_HAND: Final = HandLimits(least_angle=0.0, least_gap=0.0)
"""No limits but those of the search itself: hands too long or flat for any use."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which grasps are looked for.

    Attributes
    ----------
    aim:
        What is ranked.
    corners:
        The least number of fingers in concave corners (three straight edges are of second-order
        immobility only).
    near:
        (phi_1, phi_2, within), [rad]: keeps to hands of about one shape, read from any finger.
    limits:
        Of the hand.
    avoid:
        Stretches of the outline that no finger may touch on the target.
    tolerance:
        [unit] How wrong the outline may be: fingers must be ten times further apart, and the cage
        must be that deep.
    mu:
        [1] Coefficient of friction at the fingers, where aim is "friction"; else None.

    Raises
    ------
    InputError:
        There is no such aim, the tolerance is negative, or mu is given without the aim "friction",
        missing with it, or not positive.
    """

    aim: Aim = "first"
    corners: int = 0
    near: tuple[float, float, float] | None = None
    limits: HandLimits = field(default_factory=HandLimits)
    avoid: tuple[Stretch, ...] = ()
    tolerance: float = 0.0
    mu: float | None = None

    def __post_init__(self) -> None:
        one_of(self.aim, AIMS, "aim")
        if self.mu is None:
            if self.aim == "friction":
                raise InputError("aim 'friction' needs mu, the coefficient of friction")
        elif self.aim != "friction":
            raise InputError(f"mu goes with the aim 'friction' only; the aim is {self.aim!r}")
        elif a_number(self.mu, "mu") <= 0.0:
            raise InputError(f"mu = {self.mu:g}; more than 0 is needed")
        a_number(self.tolerance, "tolerance")
        if self.tolerance < 0.0:
            raise InputError(f"tolerance = {self.tolerance:g}; 0 or more is needed")


def as_stretches(avoid: Sequence[Sequence[float]]) -> tuple[Stretch, ...]:
    """Pairs of arclengths.

    Raises
    ------
    InputError:
        One of them is something else.

    >>> as_stretches([[0, 2]])
    ((0.0, 2.0),)
    """
    found: list[Stretch] = []
    for pair in avoid:
        try:
            numbers = [a_number(value, "avoid") for value in pair]
        except TypeError as error:
            raise InputError(f"avoid holds {pair!r}; pairs of arclengths are needed") from error
        if len(numbers) != _ENDS:
            raise InputError(f"avoid holds {len(numbers)} numbers; pairs of arclengths are needed")
        found.append((numbers[0], numbers[1]))
    return tuple(found)


_ENDS: Final = 2


@dataclass(frozen=True, slots=True)
class Candidate:
    """A grasp as found on the polygon that was searched.

    Attributes
    ----------
    contacts:
        (3, 2) [unit], counterclockwise.
    triple:
        Contact features (see Features), in the order of the contacts.
    sigma_0, level:
        [unit] Of the target, and the one that is ranked: sigma_first, sigma_first(mu), sigma_max,
        or the largest sigma of a hand that never escapes; never more than the hand can open.
    score:
        level / sigma_0.
    """

    contacts: FloatArray
    triple: tuple[int, int, int]
    sigma_0: float
    level: float
    score: float
