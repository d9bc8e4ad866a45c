"""Plane curves as polylines that stay within a given distance.

A chord over a parameter step h leaves its curve by at most h^2 max|p''| / 8, at equal parameters;
so the distance holds in both directions. The points where x or y turns are kept, so that curve and
polyline have the same bounding box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from icage.arrays import FloatArray
from icage.errors import FormatError

MAX_CHORDS = 20_000
"""Of one curve; a circle flattened to 1e-8 of its size has 11,000."""


_NEARLY_REAL = 4e-12
"""Square of twice the imaginary part that a zero may have."""


class Curve(Protocol):
    """A smooth curve over t in [0, 1]."""

    def at(self, t: FloatArray) -> FloatArray:
        """Points (k, 2) at parameters (k,)."""
        ...

    def bend(self) -> float:
        """An upper bound of |p''(t)|."""
        ...

    def turns(self) -> list[float]:
        """Parameters strictly inside (0, 1) where x or y may have an extremum."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Bezier:
    """A Bezier curve of any degree by its control points (degree + 1, 2)."""

    control: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Points (k, 2), by de Casteljau's steps; the ends are the end points exactly."""
        rows = [np.broadcast_to(point, (len(t), 2)) for point in self.control]
        while len(rows) > 1:
            rows = [(1.0 - t[:, None]) * a + t[:, None] * b for a, b in pairwise(rows)]
        return np.array(rows[0])

    def bend(self) -> float:
        """Degree (degree - 1) times the largest second difference of the control points."""
        degree = len(self.control) - 1
        if degree < 2:
            return 0.0
        second = np.diff(self.control, 2, axis=0)
        return degree * (degree - 1) * float(np.hypot(second[:, 0], second[:, 1]).max())

    def turns(self) -> list[float]:
        """Zeros of x' and y'."""
        if len(self.control) < 3:
            return []
        zeros: list[float] = []
        for column in np.diff(self.control, axis=0).T.tolist():
            if len(column) == 2:
                zeros += _zeros(0.0, column[1] - column[0], column[0])
            elif len(column) == 3:
                a, b, c = column
                zeros += _zeros(a - 2.0 * b + c, 2.0 * (b - a), a)
            else:
                powers = powers_of(np.array(column))[::-1]
                scale = float(np.abs(powers).max())
                if scale > 0.0:
                    roots = np.roots(powers / scale)
                    zeros += [float(root.real) for root in roots if abs(root.imag) < 1e-6]
        return [zero for zero in zeros if 0.0 < zero < 1.0]


def _zeros(a: float, b: float, c: float) -> list[float]:
    """Real zeros of a t^2 + b t + c, also those that rounding has just made complex."""
    scale = max(abs(a), abs(b), abs(c))
    if scale == 0.0:
        return []
    a, b, c = a / scale, b / scale, c / scale
    square = b * b - 4.0 * a * c
    if square < -_NEARLY_REAL * a * a:
        return []
    far = -(b + math.copysign(math.sqrt(max(square, 0.0)), b)) / 2.0
    return [p / q for p, q in ((far, a), (c, far)) if q != 0.0]


@dataclass(frozen=True, slots=True, eq=False)
class EllipseArc:
    """p = centre + cos(u) a + sin(u) b, u = start + t sweep: an affine image of a circle's arc."""

    centre: FloatArray
    a: FloatArray
    b: FloatArray
    start: float
    sweep: float

    def at(self, t: FloatArray) -> FloatArray:
        """Points (k, 2)."""
        u = self.start + t * self.sweep
        return self.centre + np.cos(u)[:, None] * self.a + np.sin(u)[:, None] * self.b

    def bend(self) -> float:
        """sweep^2 times a bound of the longer half axis."""
        return self.sweep**2 * math.hypot(*self.a.tolist(), *self.b.tolist())

    def turns(self) -> list[float]:
        """Where -sin(u) a + cos(u) b has a zero coordinate."""
        if self.sweep == 0.0:
            return []
        zeros: list[float] = []
        for a, b in zip(self.a.tolist(), self.b.tolist(), strict=True):
            u = math.atan2(b, a)
            first = math.ceil((min(self.start, self.start + self.sweep) - u) / math.pi)
            zeros += [(u + (first + k) * math.pi - self.start) / self.sweep for k in range(3)]
        return [zero for zero in zeros if 0.0 < zero < 1.0]


@dataclass(frozen=True, slots=True, eq=False)
class Polyline:
    """Straight edges through points (k, 2), k at least 2: what meshes, images and maps hold."""

    points: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Points (k, 2), every edge in an equal share of the parameter."""
        place = np.asarray(t) * (len(self.points) - 1)
        before = np.clip(place.astype(np.int64), 0, len(self.points) - 2)
        share = (place - before)[:, None]
        return (1.0 - share) * self.points[before] + share * self.points[before + 1]

    def bend(self) -> float:
        """None between its points, and they are all kept."""
        return 0.0

    def turns(self) -> list[float]:
        """The parameters of all points between the ends."""
        return (np.arange(1, len(self.points) - 1) / (len(self.points) - 1)).tolist()


def powers_of(bernstein: FloatArray) -> FloatArray:
    """(n + 1,) = coefficients of 1, t, ..., t^n of a polynomial by its Bernstein coefficients.

    >>> powers_of(np.array([0.0, 0.5, 1.0])).tolist()
    [0.0, 1.0, 0.0]
    """
    n = len(bernstein) - 1
    differences = [bernstein]
    while len(differences) <= n:
        differences.append(np.diff(differences[-1]))
    return np.array([math.comb(n, k) * row[0] for k, row in enumerate(differences)])


def flatten(curve: Curve, within: float) -> FloatArray:
    """Points (k, 2) of a polyline at most ``within`` from the curve, both ends included.

    Raises
    ------
    FormatError:
        The curve would need more than ``MAX_CHORDS`` chords.

    Examples
    --------
    >>> arc = EllipseArc(np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0]), 0.0, 2 * math.pi)
    >>> middles = np.diff(flatten(arc, 1e-3), axis=0) / 2 + flatten(arc, 1e-3)[:-1]
    >>> bool(1 - np.hypot(*middles.T).min() <= 1e-3)
    True
    """
    if isinstance(curve, Polyline):
        return curve.points
    bend = curve.bend()
    chords = math.ceil(math.sqrt(bend / (8.0 * within))) if bend > 0.0 else 1
    if chords > MAX_CHORDS:
        raise FormatError(
            f"a curve would need {chords:.3g} chords, at most {MAX_CHORDS} are allowed; "
            "give a larger tolerance"
        )
    t = np.union1d(np.linspace(0.0, 1.0, max(chords, 1) + 1), curve.turns())
    return curve.at(t)
