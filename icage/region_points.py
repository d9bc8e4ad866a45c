"""Points drawn uniformly from a region, holes and all: from its triangles. Our own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from icage.arrays import FloatArray
from icage.errors import GeometryError

Region = shapely.Polygon | shapely.MultiPolygon

_FILLED = 1e-9
"""[1] The triangles of a region fill it to this share of its area: the rounding of many sums."""

_BEFORE = 1.0 - 1e-12
"""[1] Of a share of an area: the search begins before it for certain, whatever the rounding."""

_STEPS = 4
"""Triangles gone through before the rest is found by bisection."""


@dataclass(frozen=True, slots=True)
class Uniform:
    """Numbers in [0, 1) for points of a region: ``triangle`` (n,) says which, ``within`` (2, n)
    where in it.
    """

    triangle: FloatArray
    within: FloatArray

    @classmethod
    def of_size(cls, rng: np.random.Generator, count: int) -> Uniform:
        """Draw them for ``count`` points."""
        return cls(rng.random(count), rng.random((2, count)))

    def part(self, here: slice) -> Uniform:
        """Those of some of the points."""
        return Uniform(self.triangle[here], self.within[:, here])


@dataclass(frozen=True, slots=True)
class Area:
    """A region cut into triangles, to draw points from.

    ``corner`` and ``sides`` (2, m) each are a triangle's first corner and the ways to the others;
    ``guide`` (m + 1,) says which triangle the search for a share k / m of the area begins at.
    """

    corner: FloatArray
    sides: tuple[FloatArray, FloatArray]
    cumulative: FloatArray
    guide: NDArray[np.int64]

    @classmethod
    def of(cls, region: Region) -> Area:
        """Cut a region, holes and all."""
        cut = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
        areas = shapely.area(cut)
        if not abs(areas.sum() - region.area) <= _FILLED * region.area:
            raise GeometryError("the triangles of a caging region do not fill it")
        rings = shapely.get_coordinates(cut).reshape(-1, 4, 2)[:, :3]
        a, b, c = np.ascontiguousarray(rings.transpose(1, 2, 0))
        cumulative = np.cumsum(areas)
        shares = np.arange(len(cumulative) + 1) / len(cumulative)
        guide = np.searchsorted(cumulative, _BEFORE * shares * cumulative[-1], "right")
        return cls(a, (b - a, c - a), cumulative, guide)

    def points(self, uniform: Uniform) -> NDArray[np.complex128]:
        """Points (n,), uniform over the region."""
        at = self._triangles(uniform.triangle)
        u, v = np.array(uniform.within)
        over = u + v > 1.0
        np.subtract(1.0, u, out=u, where=over)
        np.subtract(1.0, v, out=v, where=over)
        points = np.empty(len(at), dtype=np.complex128)
        to_b, to_c = self.sides
        points.real = self.corner[0][at] + u * to_b[0][at] + v * to_c[0][at]
        points.imag = self.corner[1][at] + u * to_b[1][at] + v * to_c[1][at]
        return points

    def _triangles(self, share: FloatArray) -> NDArray[np.int64]:
        """The first triangles (n,) up to which there is more than ``share`` (n,) of the area.

        What a bisection would find: most are found at the guide's first word, all but a few after
        some steps.
        """
        last = len(self.cumulative) - 1
        area = share * self.cumulative[-1]
        at = np.minimum(self.guide[(share * (last + 1)).astype(np.int64)], last)
        behind = np.flatnonzero(self.cumulative[at] <= area)
        for _ in range(_STEPS):
            if not len(behind):
                return at
            behind = behind[at[behind] < last]
            at[behind] += 1
            behind = behind[self.cumulative[at[behind]] <= area[behind]]
        found = np.searchsorted(self.cumulative, area[behind], "right")
        at[behind] = np.minimum(found, last)
        return at


def region_points(region: Region, rng: np.random.Generator, count: int) -> NDArray[np.complex128]:
    """Points (count,), uniform over a region."""
    return Area.of(region).points(Uniform.of_size(rng, count))
