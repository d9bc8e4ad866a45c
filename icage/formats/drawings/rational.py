"""Rational Bezier curves: the pieces of the splines that CAD calls NURBS."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray
from icage.formats.drawings.curves import Bezier


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
        """Extrema of x and y between 64 samples a degree, each found by trisection.

        The zeros of p' have too few digits in powers of t, where weights differ by far.
        """
        near_end = np.geomspace(1e-7, 1e-3, 9)  # an extremum beside an end lies between no samples
        even = np.linspace(0.0, 1.0, 64 * len(self.weights) + 1)
        t = np.unique(np.concatenate([even, near_end, 1.0 - near_end]))
        zeros: list[float] = []
        for axis, values in enumerate(self.at(t).T):
            rising = np.diff(values) > 0.0
            middle = np.flatnonzero(rising[1:] != rising[:-1]) + 1
            if not len(middle):
                continue
            low, high = t[middle - 1], t[middle + 1]
            sign = np.where(rising[middle - 1], 1.0, -1.0)
            for _ in range(60):
                left, right = (2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0
                keep_left = sign * self.at(left)[:, axis] > sign * self.at(right)[:, axis]
                low, high = np.where(keep_left, low, left), np.where(keep_left, right, high)
            zeros += ((low + high) / 2.0).tolist()
        return [zero for zero in zeros if 0.0 < zero < 1.0]


def _longest(vectors: FloatArray) -> float:
    return float(np.hypot(vectors[:, 0], vectors[:, 1]).max(initial=0.0))
