"""A random object for the tests of the contact space's kernels."""

from __future__ import annotations

import numpy as np
import shapely

from icage.contact_space.kernels.rectangle import (
    MOST_CORNERS,
    finger_at,
    region_corners,
    third_finger,
)
from tests.icage.contact_space.test_equations import setting
from tests.oracles.geometry import Floats


class Setting:
    """A random object with its surroundings, as shapely's shapes."""

    def __init__(self, seed: int) -> None:
        plane, _, self.rng = setting(seed, 14)
        self.space = s = plane.space
        self.size = plane.outline.diameter
        self.z = np.asarray(plane.hand.z)
        self.n, self.m = len(s.edge_x), len(s.ptr) - 1
        self.ring = np.column_stack([s.edge_x, s.edge_y])
        self.solid = shapely.Polygon(self.ring)
        self.shapes = [
            shapely.Polygon(np.column_stack([s.slot_x[a:b], s.slot_y[a:b]]))
            for a, b in zip(s.ptr[:-1], s.ptr[1:], strict=True)
        ]

    def fingers(self, i: int, j: int, k: int, s: float, u: float) -> Floats:
        """The three fingers (3,) complex, of pair i on edges j and k, in their own order."""
        pair = [complex(*finger_at(self.space, j, s)), complex(*finger_at(self.space, k, u))]
        third = complex(*third_finger(self.space, i, j, k, s, u))
        return np.roll([*pair, third], i)

    def region(self, i: int, j: int, k: int, c: int) -> Floats:
        corners, spare = np.empty((MOST_CORNERS, 2)), np.empty((MOST_CORNERS, 2))
        return corners[: region_corners(self.space, i, j, k, c, corners, spare)].copy()

    def regions(self, count: int) -> list[tuple[int, int, int, int]]:
        """Regions with an area, at random."""
        found = []
        for _ in range(4000):
            at = tuple(int(v) for v in self.rng.integers([3, self.n, self.n, self.m]))
            corners = self.region(*at)
            if len(corners) >= 3 and shapely.Polygon(corners).area > 1e-4 * self.size**2:
                found.append(at)
            if len(found) == count:
                break
        return found
