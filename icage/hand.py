"""The hand: three fingers on a triangle of fixed shape and variable size. [Bunis2018, Sec. II]

Complex numbers make it linear: finger k stands at ``d + w z_k`` with d the position of finger 1,
``w = sigma e^{i theta}`` and the unit hand ``z = (0, 1, z_3)``. Fingers are 1..3 in prose and
0..2 in arrays.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from numbers import Complex

import numpy as np

from icage.arrays import ComplexArray, FloatArray, read_only, real_numbers
from icage.checks import a_number
from icage.errors import HandError, PlacementError

_NO_LENGTH = 1e-300
"""[unit^2] Square of the length of a step that is none: keeps 0 from being divided by 0."""

_FLATTEST = 1e-6
"""[1] Least height over the longest side, as a part of that side, that we accept as a triangle: of
the triangle alone, whichever finger is called the first."""


@dataclass(frozen=True, slots=True)
class HandShape:
    """The shape of the triangle of fingers, given by finger 3 of the unit hand.

    Parameters
    ----------
    z_3:
        Finger 3 in the frame whose origin is finger 1 and whose unit x axis ends at finger 2.

    Raises
    ------
    HandError:
        The fingers are clockwise, collinear, coincident or not finite.

    Examples
    --------
    >>> HandShape.from_angles_deg(60.0, 120.0).z.round(6).tolist()
    [0j, (1+0j), (0.5+0.866025j)]
    """

    z_3: complex
    z: ComplexArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not isinstance(self.z_3, Complex):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise HandError(f"z_3 is {self.z_3!r}; a complex number is needed")
        z_3 = complex(self.z_3)
        if not cmath.isfinite(z_3):
            raise HandError(f"the hand's third finger is {z_3}; finite coordinates are needed")
        longest = max(1.0, abs(z_3), abs(z_3 - 1.0))
        height = z_3.imag / longest / longest  # twice the area, for a side 1-2 of length 1
        if height < -_FLATTEST:
            raise HandError(
                "the fingers 1, 2, 3 are clockwise; give them counterclockwise (swap two of them)"
            )
        if height <= _FLATTEST:
            raise HandError(
                "the three fingers are collinear or coincident "
                f"(height over longest side {height:.3g}; above {_FLATTEST:g} needed)"
            )
        object.__setattr__(self, "z_3", z_3)
        z = np.array([0.0, 1.0, z_3], dtype=np.complex128)
        object.__setattr__(self, "z", read_only(z))

    @classmethod
    def from_contacts(cls, contacts: FloatArray) -> HandShape:
        """Shape of the triangle on three points, (3, 2), fingers 1, 2, 3 counterclockwise."""
        try:
            points = real_numbers(contacts)
        except (TypeError, ValueError) as error:
            found = type(contacts).__name__
            raise HandError(f"three finite points (x, y) are needed, found a {found}") from error
        if points.shape != (3, 2) or not np.isfinite(points).all():
            raise HandError(f"three finite points (x, y) are needed, found shape {points.shape}")
        side_12 = complex(*(points[1] - points[0]))
        side_13 = complex(*(points[2] - points[0]))
        side_23 = complex(*(points[2] - points[1]))
        longest = max(abs(side_12), abs(side_13), abs(side_23))
        if min(abs(side_12), abs(side_13), abs(side_23)) <= 1e-9 * longest or longest == 0.0:
            raise HandError("two of the three fingers coincide")
        return cls(side_13 / side_12)

    @classmethod
    def from_angles(cls, phi_1: float, phi_2: float) -> HandShape:
        """Shape from the directions from fingers 1 and 2 to finger 3, [rad], both against that from
        finger 1 to finger 2: phi_2 is an outer angle of the triangle. [Bunis2018, Def. 1, Eq. (1)]

        The paper asks for 0 < phi_1, phi_2 < pi; Eq. (1) also needs phi_3 = phi_2 - phi_1 > 0.
        """
        a_number(phi_1, "phi_1", HandError)
        a_number(phi_2, "phi_2", HandError)
        if not (0.0 < phi_1 < phi_2 < math.pi):
            if max(phi_1, phi_2) > 2.0 * math.pi:
                raise HandError(
                    f"phi = ({phi_1:.6g}, {phi_2:.6g}) radians; from_angles_deg takes degrees"
                )
            raise HandError(
                f"phi = ({math.degrees(phi_1):.6g}, {math.degrees(phi_2):.6g}) degrees; "
                "0 < phi_1 < phi_2 < 180 is needed (phi_2 is measured outside the triangle: an "
                "equilateral hand is (60, 120))"
            )
        return cls(cmath.rect(math.sin(phi_2) / math.sin(phi_2 - phi_1), phi_1))

    @classmethod
    def from_angles_deg(cls, phi_1: float, phi_2: float) -> HandShape:
        """``from_angles`` in degrees; the equilateral hand is (60, 120)."""
        first, second = (a_number(phi, "phi", HandError) for phi in (phi_1, phi_2))
        return cls.from_angles(math.radians(first), math.radians(second))

    @property
    def phi(self) -> tuple[float, float]:
        """(phi_1, phi_2), [rad]. [Bunis2018, Def. 1]

        Directions from fingers 1 and 2 to finger 3, against that from finger 1 to finger 2.
        """
        return cmath.phase(self.z_3), cmath.phase(self.z_3 - 1.0)

    @property
    def phi_deg(self) -> tuple[float, float]:
        """(phi_1, phi_2), [deg]."""
        phi_1, phi_2 = self.phi
        return math.degrees(phi_1), math.degrees(phi_2)

    @property
    def unit_fingers(self) -> FloatArray:
        """Fingers at sigma = 1 in the palm frame, (3, 2)."""
        return np.column_stack([self.z.real, self.z.imag])

    def least_gap(self, corners: list[complex]) -> float:
        """Least distance of two fingers along the polyline of w with these corners."""
        way: ComplexArray = np.array(corners, dtype=np.complex128)
        side = way[1:] - way[:-1]
        # least |w| on each segment; one of no length is its first corner
        along = -np.real(way[:-1] * np.conj(side)) / np.maximum(np.abs(side) ** 2, _NO_LENGTH)
        nearest = way[:-1] + np.clip(along, 0.0, 1.0) * side
        least = float(np.abs(nearest).min(initial=abs(corners[0])))
        return least * min(1.0, abs(self.z_3), abs(self.z_3 - 1.0))

    def relabelled(self, first: int) -> HandShape:
        """The same hand with finger ``first`` (0, 1, 2) called finger 1, still counterclockwise."""
        a, b, c = (self.z[(first + k) % 3] for k in range(3))
        return HandShape(complex((c - a) / (b - a)))

    def fingers(self, placements: FloatArray) -> FloatArray:
        """Finger positions (..., 3, 2) of placements (..., 4) = (x, y, theta, sigma)."""
        rows = np.asarray(placements, dtype=np.float64)
        d = rows[..., 0] + 1j * rows[..., 1]
        w = rows[..., 3] * np.exp(1j * rows[..., 2])
        f = d[..., None] + w[..., None] * self.z
        return np.stack([f.real, f.imag], axis=-1)


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the hand stands: finger 1 at (x, y), finger 2 at distance sigma in direction theta.

    Lengths in the object's unit, theta in [rad], all in the object's frame B.
    """

    x: float
    y: float
    theta: float
    sigma: float

    def __post_init__(self) -> None:
        for name in ("x", "y", "theta", "sigma"):
            value = a_number(getattr(self, name), f"{name} of a placement", PlacementError)
            object.__setattr__(self, name, value)
        if self.sigma < 0.0:
            raise PlacementError(f"placement with sigma = {self.sigma}; sigma >= 0 is needed")

    @classmethod
    def from_contacts(cls, contacts: FloatArray) -> Placement:
        """The placement whose fingers 1 and 2 are the first two of the points (3, 2)."""
        side = complex(*(np.asarray(contacts[1]) - np.asarray(contacts[0])))
        return cls(float(contacts[0][0]), float(contacts[0][1]), cmath.phase(side), abs(side))

    def as_array(self) -> FloatArray:
        """(4,) = x, y, theta, sigma."""
        return np.array([self.x, self.y, self.theta, self.sigma])
