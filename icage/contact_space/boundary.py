"""The object's boundary by arclength, and the two-finger contact spaces over it.

[Bunis2018, Sec. IV-A]. Plain numpy, an equation each: the readable side of
``kernels/rectangle.py``. Pairs are numbered by their first finger, 0..2 in arrays: pair i is
fingers i and i + 1 (mod 3) of U_{i,i+1}.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from icage.arrays import FloatArray, IntArray
from icage.geometry.exterior import without_straight_vertices
from icage.outline import Outline


@dataclass(frozen=True, slots=True)
class Boundary:
    """Edges of the object, counterclockwise; [0, L] x [0, L] is U_{i,i+1}. [Bunis2018, Def. 3]

    Straight vertices are left out, so that edge numbers are those of the search.

    Attributes
    ----------
    start:
        (n, 2), p_i^0: initial vertex of each edge, [unit].
    tangent:
        (n, 2), t_i.
    length:
        (n,), L_i, [unit].
    s_0:
        (n + 1,), s_i^0: arclength of each initial vertex, and the perimeter L, [unit].
    """

    start: FloatArray
    tangent: FloatArray
    length: FloatArray
    s_0: FloatArray

    @classmethod
    def of(cls, outline: Outline) -> Boundary:
        """The boundary of an outline; s starts at its first vertex that is not straight."""
        origin = outline.vertices[0]
        ring = without_straight_vertices(outline.vertices - origin, outline.diameter) + origin
        side = np.roll(ring, -1, axis=0) - ring
        length = np.hypot(side[:, 0], side[:, 1])
        return cls(ring, side / length[:, None], length, np.concatenate([[0.0], length.cumsum()]))

    def __len__(self) -> int:
        return len(self.start)

    @property
    def perimeter(self) -> float:
        """L, [unit]."""
        return float(self.s_0[-1])

    def edge_at(self, s: FloatArray) -> IntArray:
        """Edge that holds arclength s (any shape, taken modulo L); at a vertex the one ahead."""
        return np.searchsorted(self.s_0[:-1], self._wrapped(s), "right") - 1

    def on_edge(self, edge: int | IntArray, s: FloatArray) -> FloatArray:
        """P(s) = p^0 + (s - s^0) t on a given edge, (..., 2). [Bunis2018, Eq. (2)]"""
        along = np.asarray(s, dtype=np.float64) - self.s_0[edge]
        return self.start[edge] + along[..., None] * self.tangent[edge]

    def at(self, s: FloatArray) -> FloatArray:
        """P(s) for arclengths of any shape, (..., 2). [Bunis2018, Eq. (2)]"""
        wrapped = self._wrapped(s)
        return self.on_edge(self.edge_at(wrapped), wrapped)

    def _wrapped(self, s: FloatArray) -> FloatArray:
        """S modulo L, in [0, L)."""
        wrapped = np.mod(np.asarray(s, dtype=np.float64), self.perimeter)
        return np.where(wrapped < self.perimeter, wrapped, 0.0)

    def nearest(self, point: FloatArray) -> tuple[int, float, float]:
        """Edge, arclength and distance [unit] of the boundary point nearest to a point (2,)."""
        off = np.asarray(point) - self.start
        along = np.clip((off * self.tangent).sum(axis=1), 0.0, self.length)
        gap = np.hypot(*(off - along[:, None] * self.tangent).T)
        edge = int(np.argmin(gap))
        return edge, float(self.s_0[edge] + along[edge]), float(gap[edge])

    def rectangle(self, j: int, k: int) -> FloatArray:
        """Corners (4, 2) of R_jk in (s_i, s_{i+1}), counterclockwise. [Bunis2018, Sec. IV-A]"""
        (a, b), (c, d) = self.s_0[j : j + 2], self.s_0[k : k + 2]
        return np.array([[a, c], [b, c], [b, d], [a, d]])
