"""A frame near the object, parallel to its own, in which nothing is lost far from the origin.

A drawing may lie many diameters from its origin, and there its coordinates have few digits to
spare: an offset built among them has corners between two floats, and a union of such polygons
fails. The planner therefore works in this frame and its answers are moved back. Going there and
back is exact for the outline, so that it is the same object bit for bit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from icage.arrays import FloatArray, read_only
from icage.cage import Cage
from icage.outline import Outline

_FAR = 0.5
"""[diameter] An axis is moved if every vertex lies at least this far from 0 on it.

Then all coordinates are within a factor two of the middle one, and their difference is exact
(Sterbenz's lemma). An outline nearer to its origin stays where it is, digits that small coordinates
have beyond the others included; it reaches no further than one and a half diameters."""


@dataclass(frozen=True, slots=True)
class NearFrame:
    """The object's frame moved to ``origin`` (2,), [unit]; a function of the outline alone."""

    origin: FloatArray

    @classmethod
    def of(cls, outline: Outline) -> NearFrame:
        """The frame for an outline; the object's own unless the object lies far from it."""
        low, high = outline.vertices.min(axis=0), outline.vertices.max(axis=0)
        far = np.maximum(low, -high) >= _FAR * outline.diameter
        return cls(read_only(np.where(far, low + 0.5 * (high - low), 0.0)))

    @property
    def moved(self) -> bool:
        """Whether it is another frame than the object's own."""
        return bool(self.origin.any())

    def into(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) of the object's frame in this one."""
        return np.asarray(points, dtype=np.float64) - self.origin

    def back(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) of this frame in the object's own."""
        return points + self.origin

    def outline_into(self, outline: Outline) -> Outline:
        """The very same object in this frame."""
        return Outline.computed(self.into(outline.vertices)) if self.moved else outline

    def rows_into(self, placements: FloatArray) -> FloatArray:
        """Placements (..., 4) = x, y, theta, sigma of the object's frame in this one."""
        return np.asarray(placements, dtype=np.float64) - np.append(self.origin, [0.0, 0.0])

    def rows_back(self, placements: FloatArray) -> FloatArray:
        """Placements (..., 4) of this frame in the object's own."""
        return placements + np.append(self.origin, [0.0, 0.0])

    def cage_back(self, cage: Cage, outline: Outline) -> Cage:
        """The answer in the object's frame; its ``work`` stays in this one."""
        if not self.moved:
            return cage
        path = cage.escape_path
        return replace(
            cage,
            outline=outline,
            contacts=self.back(cage.contacts),
            punctures=tuple(replace(p, contacts=self.back(p.contacts)) for p in cage.punctures),
            grasps=tuple(
                replace(
                    g,
                    contacts=self.back(g.contacts),
                    plateau=None if g.plateau is None else self._both_back(*g.plateau),
                )
                for g in cage.grasps
            ),
            escape_path=None if path is None else self.rows_back(path),
        )

    def _both_back(self, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self.back(a), self.back(b)
