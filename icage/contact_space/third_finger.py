"""Where the third finger goes when two walk along their edges. [Bunis2018, Sec. IV-B]

X_{i+2} = p(s_i) + R_{i,i+1} (p(s_{i+1}) - p(s_i)): over a rectangle a parallelogram, T = [v w] its
matrix. T is singular where v and w are parallel (as on parallel edges with a hand to match): then
Eq. (4) has no inverse, but a half plane of the third finger is still a half plane of
(s_i, s_{i+1}), and clipping by it needs no inverse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from icage.arrays import FloatArray
from icage.contact_space.boundary import Boundary
from icage.contact_space.formation_scale import sines
from icage.errors import GeometryError
from icage.hand import HandShape

_SINGULAR = 1e-12
"""[1] |det T| / (|v| |w|) below which Eq. (4) is not evaluated."""

_ON_LINE = 1e-13
"""[1] A corner this close to a line, over the rectangle's size as seen by the third finger, is on
it: as in the compiled clip."""


def turn(hand: HandShape, pair: int) -> FloatArray:
    """R_{i,i+1} (2, 2) = sin phi_{i+1} / sin phi_{i+2} times a rotation. [Bunis2018, Sec. IV-B]

    It turns counterclockwise by phi_i for i = 1, 3 and by pi - phi_2 for i = 2.
    """
    phi_1, phi_2 = hand.phi
    angle = (phi_1, np.pi - phi_2, phi_2 - phi_1)[pair]
    sin = sines(hand)
    c, s = np.cos(angle), np.sin(angle)
    return sin[(pair + 1) % 3] / sin[(pair + 2) % 3] * np.array([[c, -s], [s, c]])


class Parallelogram(NamedTuple):
    """X = u + (s_i - s_i^0) v + (s_{i+1} - s_{i+1}^0) w over R_jk. [Bunis2018, Eq. (3)]

    ``u`` (2,) in [unit], ``v`` and ``w`` (2,) in [1]; ``s_0`` (2,) the lower corner of R_jk and
    ``size`` (2,) = L_i, L_{i+1}, [unit].
    """

    u: FloatArray
    v: FloatArray
    w: FloatArray
    s_0: FloatArray
    size: FloatArray

    @classmethod
    def over(cls, boundary: Boundary, hand: HandShape, pair: int, j: int, k: int) -> Parallelogram:
        """The parallelogram of fingers i, i + 1 (``pair`` = i, 0..2) on edges j and k."""
        r = turn(hand, pair)
        p, q = boundary.start[j], boundary.start[k]
        return cls(
            u=p + r @ (q - p),
            v=(np.eye(2) - r) @ boundary.tangent[j],
            w=r @ boundary.tangent[k],
            s_0=boundary.s_0[[j, k]],
            size=boundary.length[[j, k]],
        )

    @property
    def t(self) -> FloatArray:
        """T = [v w], (2, 2). [Bunis2018, Sec. IV-B]"""
        return np.column_stack([self.v, self.w])

    @property
    def singular(self) -> bool:
        """Whether v and w are parallel, so that T has no inverse."""
        (a, b), (c, d) = self.v, self.w
        return bool(abs(a * d - b * c) <= _SINGULAR * np.hypot(a, b) * np.hypot(c, d))

    def at(self, s: FloatArray) -> FloatArray:
        """Third finger (..., 2) for points (..., 2) = s_i, s_{i+1}. [Bunis2018, Eq. (3)]"""
        return self.u + (np.asarray(s) - self.s_0) @ self.t.T

    @property
    def rectangle(self) -> FloatArray:
        """Corners (4, 2) of R_jk, counterclockwise."""
        return self.s_0 + self.size * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])

    @property
    def corners(self) -> FloatArray:
        """Corners (4, 2) of the parallelogram: u, u + L_i v, u + L_i v + L_{i+1} w, u + L_{i+1} w.

        [Bunis2018, Sec. IV-B]
        """
        return self.at(self.rectangle)

    def pull_back(self, x: FloatArray) -> FloatArray:
        """(s_i, s_{i+1}) (..., 2) of third finger positions (..., 2). [Bunis2018, Eq. (4)]

        Raises
        ------
        GeometryError:
            T is singular; use ``clipped``.
        """
        if self.singular:
            raise GeometryError("T is singular: its parallelogram is a segment")
        return self.s_0 + (np.asarray(x) - self.u) @ np.linalg.inv(self.t).T

    def half_plane(self, point: FloatArray, normal: FloatArray) -> FloatArray:
        """(3,) = h_0, h_i, h_{i+1} with N . (X - point) = h_0 + h_i s_i + h_{i+1} s_{i+1}.

        Eq. (4) for a line instead of a point: T maps lines to lines both ways, singular or not.
        """
        slope = normal @ self.t
        return np.array([normal @ (self.u - point) - slope @ self.s_0, *slope])

    def clipped(self, ring: FloatArray) -> FloatArray:
        """Part (m, 2) of R_jk where the third finger is in a convex polygon (k, 2).

        ``ring`` runs counterclockwise. Empty, a point or a segment where they only touch.
        """
        part = self.rectangle
        tolerance = _ON_LINE * float(np.abs(self.corners - self.u).max() + self.size.max())
        side = np.roll(ring, -1, axis=0) - ring
        inward = np.column_stack([-side[:, 1], side[:, 0]]) / np.hypot(*side.T)[:, None]
        for point, normal in zip(ring, inward, strict=True):
            h = self.half_plane(point, normal)
            part = _cut(part, h[0] + part @ h[1:], tolerance)
            if not len(part):
                break
        return part


def _cut(part: FloatArray, height: FloatArray, tolerance: float) -> FloatArray:
    """Corners of a convex polygon where a linear function, given at its corners, is not below 0."""
    if (height >= -tolerance).all():
        return part
    kept: list[FloatArray] = []
    for a in range(len(part)):
        b = a - 1
        low, high = sorted((height[a], height[b]))
        if low < -tolerance and high > tolerance:
            kept.append(part[b] + height[b] / (height[b] - height[a]) * (part[a] - part[b]))
        if height[a] >= -tolerance:
            kept.append(part[a])
    return np.array(kept).reshape(-1, 2)
