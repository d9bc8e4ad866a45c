"""Escape paths checked against the object itself with shapely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from tests.oracles.geometry import Floats, Ring, fingers_of

TOUCH = 1e-9
"""[diameter] A finger may be this deep inside: touching is free, and rounding touches deeper."""


@dataclass(frozen=True, slots=True)
class PathFacts:
    """What a path of placements (k, 4) does. Lengths in the object's unit."""

    depth: float
    """How deep the fingers' straight ways go into the object (0: they touch at most)."""
    sigma_max: float
    sigma_end: float
    start_gap: float
    """Largest distance of a finger at the start from the contact it should be on."""
    finger_gap: float
    """Least distance between two fingers' ways before the last segment."""


def segment_is_free(
    ring: Ring, hand: NDArray[np.complex128], a: Floats, b: Floats, radius: float = 0.0
) -> bool:
    """Whether no finger enters the object while (d, w) moves in a straight line from a to b."""
    ways = np.stack([fingers_of(a, hand), fingers_of(b, hand)], axis=1)
    return depth_of_ways(ring, ways, radius) <= TOUCH * ring.diameter


def depth_of_ways(ring: Ring, ways: Floats, radius: float = 0.0) -> float:
    """How deep straight finger ways (m, 2 ends, 2) go into the object, at most; at least 0.

    For points: the part of each way inside the object, its farthest point from the boundary
    (distances are largest at an end of the part or halfway to the boundary: sampled at its ends,
    its middle and 14 points between). For discs: radius minus the distance of the way.
    """
    lines = shapely.linestrings(ways)
    if radius > 0.0:
        clear = shapely.distance(lines, ring.polygon)
        return float(max(0.0, (radius - clear).max()))
    deepest = 0.0
    border = ring.polygon.exterior
    for line in lines[shapely.intersects(lines, ring.polygon)]:
        inside = shapely.intersection(line, ring.polygon)
        for part in shapely.get_parts(inside):
            if part.geom_type != "LineString":
                continue  # it touches in a point
            spots = shapely.line_interpolate_point(part, np.linspace(0.0, 1.0, 17), normalized=True)
            deepest = max(deepest, float(shapely.distance(spots, border).max()))
    return deepest


def path_facts(
    ring: Ring, hand: NDArray[np.complex128], path: Floats, contacts: Floats, radius: float = 0.0
) -> PathFacts:
    """Facts of a path of placements (k, 4) = x, y, theta, sigma of the given hand.

    Between neighbours every finger moves in a straight line: so does (d, w), and sigma = |w| is
    largest at an end.
    """
    w = path[:, 3] * np.exp(1j * path[:, 2])
    q = np.column_stack([path[:, :2], w.real, w.imag])
    fingers = np.array([fingers_of(row, hand) for row in q])
    ways = np.stack([fingers[:-1], fingers[1:]], axis=2).reshape(-1, 2, 2)
    nearest = np.inf
    for i in range(len(q) - 2):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            gap = _least(*(fingers[k, a] - fingers[k, b] for k in (i, i + 1)))
            nearest = min(nearest, gap)
    return PathFacts(
        depth=depth_of_ways(ring, ways, radius),
        sigma_max=float(path[:, 3].max()),
        sigma_end=float(path[-1, 3]),
        start_gap=float(np.linalg.norm(fingers[0] - contacts, axis=1).max()),
        finger_gap=nearest,
    )


def _least(a: Floats, b: Floats) -> float:
    """Least length of a vector that moves straight from a to b."""
    side = b - a
    square = float(side @ side)
    t = 0.0 if square == 0.0 else min(1.0, max(0.0, -float(a @ side) / square))
    return float(np.hypot(*(a + t * side)))
