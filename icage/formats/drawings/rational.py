"""Rational Bezier curves: the pieces of the splines that CAD calls NURBS."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial import polynomial

from icage.arrays import FloatArray
from icage.formats.drawings.curves import Bezier, powers_of


_NEARLY_REAL: Final = 1e-2


@dataclass(frozen=True, slots=True, eq=False)
class RationalBezier:
    """p = N / w, where N and w are Bezier polynomials: control points times weights, weights.

    Attributes
    ----------
    control:
        (degree + 1, 2) control points.
    weights:
        (degree + 1,) all above 0.
    """

    control: FloatArray
    weights: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Points (k, 2)."""
        numerator = Bezier(self.control * self.weights[:, None]).at(t)
        return numerator / Bezier(np.column_stack([self.weights, self.weights])).at(t)

    def bend(self) -> float:
        """From p' = (N' - w' p) / w and p'' = (N'' - 2 w' p' - w'' p) / w, each factor bounded.

        The origin is put into the middle of the control points, which bound p as they bound N / w.
        """
        degree = len(self.weights) - 1
        own = self.control - self.control.mean(axis=0)
        numerator = own * self.weights[:, None]
        furthest = _longest(own)
        first, second = degree, degree * (degree - 1)
        dw = first * float(np.abs(np.diff(self.weights)).max(initial=0.0))
        ddw = second * float(np.abs(np.diff(self.weights, 2)).max(initial=0.0))
        dn = first * _longest(np.diff(numerator, axis=0))
        ddn = second * _longest(np.diff(numerator, 2, axis=0))
        least = float(self.weights.min())
        slope = (dn + dw * furthest) / least
        return (ddn + 2.0 * dw * slope + ddw * furthest) / least

    def turns(self) -> list[float]:
        """Zeros of N' w - N w', for x and y."""
        w = powers_of(self.weights)
        zeros: list[float] = []
        for column in (self.control * self.weights[:, None]).T:
            n = powers_of(column)
            slope = polynomial.polysub(
                polynomial.polymul(polynomial.polyder(n), w),
                polynomial.polymul(n, polynomial.polyder(w)),
            )
            scale = float(np.abs(slope).max())
            if scale > 0.0:
                roots = np.roots(slope[::-1] / scale)
                near = roots.real[np.abs(roots.imag) < _NEARLY_REAL]
                zeros += _polished(slope / scale, near).tolist()
        return [zero for zero in zeros if 0.0 < zero < 1.0]


def _polished(powers: FloatArray, zeros: FloatArray) -> FloatArray:
    """Newton's steps: the roots of a high degree come with few digits. One too many is harmless."""
    slope = polynomial.polyder(powers)
    for _ in range(4):
        with np.errstate(all="ignore"):
            step = polynomial.polyval(zeros, powers) / polynomial.polyval(zeros, slope)
        zeros = zeros - np.where(np.abs(step) < _NEARLY_REAL, step, 0.0)
    return zeros


def _longest(vectors: FloatArray) -> float:
    return float(np.hypot(vectors[:, 0], vectors[:, 1]).max(initial=0.0))
