"""What every method is asked: fingers at the corners of a similar triangle round one polygon.

The hand is told about a point of its own, its *reference*: at pose (x, y, turn) and size sigma,
finger k stands at ``x + iy + sigma exp(i turn) arms[k]``. The reference is chosen so that the
target opens straight away from it; so the opened hand at the target's own pose touches nothing, and
a method that looks at poses one by one has a start.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from icage.case import Case

ARC = 32
"""Segments of a quarter circle where disc fingers make the object grow; inside the true arc."""
_AHEAD = 0.02
"""[sigma_0] How far the target is opened to choose the reference."""
_AROUND = 41
"""References tried along each axis."""


@dataclass(frozen=True)
class Question:
    """An obstacle for point fingers, the hand's arms and its target pose, turn 0."""

    obstacle: shapely.Polygon
    arms: np.ndarray
    """(k,) complex, at sigma = 1."""
    reference: complex
    """Where the reference is in the target."""
    sigma_0: float
    diameter: float

    @classmethod
    def of(cls, case: Case) -> Question:
        """The question of a case. ValueError if its target opens away from no point at all."""
        obstacle = shapely.Polygon(case.outline.vertices)
        if case.finger_radius > 0.0:  # holes that the growing closes cannot be left: filled
            grown = obstacle.buffer(case.finger_radius, quad_segs=ARC)
            obstacle = shapely.Polygon(grown.exterior)
        shapely.prepare(obstacle)
        fingers = case.contacts @ np.array([1.0, 1.0j])
        middle, reach = fingers.mean(), np.abs(fingers - fingers.mean()).max()
        along = np.linspace(-1.0, 1.0, _AROUND) * reach
        tried = middle + (along[:, None] + 1j * along).ravel()
        opened = tried[:, None] + (1.0 + _AHEAD) * (fingers - tried[:, None])
        least = clearance(obstacle, opened).min(axis=1)
        best = int(np.argmax(least))
        if least[best] <= 0.0:
            raise ValueError(f"{case.name}: the target does not open straight away from a point")
        sigma_0 = float(np.abs(fingers[1] - fingers[0]))
        arms = (fingers - tried[best]) / sigma_0
        return cls(obstacle, arms, complex(tried[best]), sigma_0, case.outline.diameter)

    @property
    def largest(self) -> float:
        """Size from which any two fingers are a diameter apart: surely no cage."""
        gaps = np.abs(self.arms[:, None] - self.arms) + np.diag(np.full(len(self.arms), np.inf))
        low_x, low_y, high_x, high_y = self.obstacle.bounds
        return float(np.hypot(high_x - low_x, high_y - low_y) / gaps.min())

    def fingers(self, poses: np.ndarray, sigma: float) -> np.ndarray:
        """(..., k) complex, of poses (..., 3)."""
        at, turn = poses[..., 0] + 1j * poses[..., 1], np.exp(1j * poses[..., 2])
        return at[..., None] + sigma * turn[..., None] * self.arms

    def clearance(self, poses: np.ndarray, sigma: float) -> np.ndarray:
        """Least distance of a finger from the obstacle, less than 0 inside, of poses (..., 3)."""
        return clearance(self.obstacle, self.fingers(poses, sigma)).min(axis=-1)


def clearance(obstacle: shapely.Polygon, points: np.ndarray) -> np.ndarray:
    """Distance of complex points from the boundary, less than 0 inside."""
    placed = shapely.points(points.real, points.imag)
    inside = shapely.contains_xy(obstacle, points.real, points.imag)
    return shapely.distance(obstacle.exterior, placed) * np.where(inside, -1.0, 1.0)
