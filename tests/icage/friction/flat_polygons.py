"""Flat polygons of hands as the kernels of friction have them, with coordinates in their plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.oracles.geometry import Floats

ROOM = 96


@dataclass(frozen=True)
class Flat:
    """A convex polygon (n, 2) in a plane, and that plane in R^4: middle (4,) and axes (2, 4)."""

    inside: Floats
    middle: Floats
    axes: Floats

    @classmethod
    def drawn(cls, rng: np.random.Generator, middle: Floats, size: float) -> Flat:
        """A triangle to octagon of about this size round a hand."""
        n = int(rng.integers(3, 9))
        angle = np.sort(2.0 * np.pi * (np.arange(n) + 0.8 * rng.random(n)) / n)
        ring = np.column_stack([np.cos(angle), np.sin(angle)])  # on a circle: convex
        return cls(ring, middle, size * rng.normal(size=(2, 4)) / 2.0)

    @property
    def corners(self) -> Floats:
        """(n, 4)."""
        return self.middle + self.inside @ self.axes

    def room(self) -> Floats:
        """Its corners with room for more."""
        room = np.full((ROOM, 4), np.nan)
        room[: len(self.inside)] = self.corners
        return room

    def hands(self, rng: np.random.Generator, count: int) -> Floats:
        """Hands (count, 4) of the polygon, a part of them on its sides."""
        share = rng.dirichlet(np.full(len(self.inside), 0.4), count)
        return share @ self.corners

    def holds(self, corners: Floats, hand: Floats, within: float = 1e-9) -> bool:
        """Whether a hand lies in a convex polygon (n, 4) of this plane, counterclockwise in it."""
        plane = np.linalg.pinv(self.axes)
        ring, at = (corners - self.middle) @ plane, (hand - self.middle) @ plane
        if np.abs(at @ self.axes - (hand - self.middle)).max() > within:
            return False
        side, to = np.roll(ring, -1, axis=0) - ring, at - ring
        return bool((side[:, 0] * to[:, 1] - side[:, 1] * to[:, 0] >= -within).all())


def fingers_of(hands: Floats, z: Floats) -> Floats:
    """Fingers (n, f) as complex numbers of hands (n, 4) with unit fingers (f, 2)."""
    d, w = hands[:, 0] + 1j * hands[:, 1], hands[:, 2] + 1j * hands[:, 3]
    return d[:, None] + w[:, None] * (z[:, 0] + 1j * z[:, 1])
