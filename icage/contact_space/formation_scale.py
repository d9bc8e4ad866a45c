"""The formation scale sigma as a function of two contacts. [Bunis2018, Eq. (1), Def. 4]"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary
from icage.hand import HandShape


def sines(hand: HandShape) -> FloatArray:
    """Sin phi_1, sin phi_2, sin phi_3 with phi_3 = phi_2 - phi_1, (3,).

    d_12 / sin phi_3 = d_23 / sin phi_1 = d_31 / sin phi_2: d_{i,i+1} goes with sin phi_{i+2}.
    [Bunis2018, Eq. (1)]
    """
    phi_1, phi_2 = hand.phi
    return np.sin([phi_1, phi_2, phi_2 - phi_1])


def rho(hand: HandShape, pair: int) -> float:
    """Sigma per distance of a pair: sin phi_3 / sin phi_{i+2}. [Bunis2018, Def. 4]"""
    sin = sines(hand)
    return float(sin[2] / sin[(pair + 2) % 3])


def formation_scale(
    boundary: Boundary, hand: HandShape, pair: int, s_i: FloatArray, s_j: FloatArray
) -> FloatArray:
    """Sigma = rho |p(s_i) - p(s_{i+1})| for arclengths of one shape, [unit]. [Bunis2018, Def. 4]

    Zero on the diagonal, convex in every rectangle.
    """
    gap = boundary.at(s_i) - boundary.at(s_j)
    return rho(hand, pair) * np.hypot(gap[..., 0], gap[..., 1])


class ScaleForm(NamedTuple):
    """Sigma = rho |A s + b| in one rectangle, s = (s_i, s_{i+1}). [Bunis2018, Sec. V-A]

    A (2, 2) = [t_i, -t_{i+1}]; b (2,) = p_i^0 - p_{i+1}^0 - A s^0, [unit].
    """

    rho: float
    a: FloatArray
    b: FloatArray

    @classmethod
    def of(cls, boundary: Boundary, hand: HandShape, pair: int, j: int, k: int) -> ScaleForm:
        """The form of rectangle R_jk of a pair."""
        a = np.column_stack([boundary.tangent[j], -boundary.tangent[k]])
        b = boundary.start[j] - boundary.start[k] - a @ boundary.s_0[[j, k]]
        return cls(rho(hand, pair), a, b)

    def __call__(self, s: FloatArray) -> FloatArray:
        """Sigma at points (..., 2), [unit]."""
        gap = np.asarray(s) @ self.a.T + self.b
        return self.rho * np.hypot(gap[..., 0], gap[..., 1])
