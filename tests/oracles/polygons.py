"""Seeded random polygons: random, star, comb, spiral, integer grid, lattice, tool-like.

Each generator takes a numpy Generator and returns (n, 2), counterclockwise, simple, about one
unit across unless it lives on the integer grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely
from numpy.random import Generator

from tests.oracles.geometry import Floats

NARROWEST = 2e-3
"""[diameter] No vertex of a generated polygon comes closer to an edge that is not its own."""

TRIES = 200


def random_polygon(rng: Generator, corners: int | None = None) -> Floats:
    """Random points joined by a tour, crossings removed by reversing pieces of it (2-opt)."""
    n = int(rng.integers(6, 17)) if corners is None else corners
    return _first_simple(lambda: _uncrossed(rng.random((n, 2)), rng))


def star_polygon(rng: Generator) -> Floats:
    """Sorted angles, independent radii between 0.3 and 1."""

    def draw() -> Floats:
        n = int(rng.integers(5, 15))
        angle = (np.arange(n) + 0.8 * rng.random(n)) * 2.0 * math.pi / n
        radius = rng.uniform(0.3, 1.0, n)
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])

    return _first_simple(draw)


def comb_polygon(rng: Generator) -> Floats:
    """A bar with 2 to 5 slightly leaning teeth."""

    def draw() -> Floats:
        teeth = int(rng.integers(2, 6))
        knots = np.cumsum(rng.uniform(0.5, 1.5, 2 * teeth - 1))
        knots = np.concatenate([[0.0], knots])
        upper = []
        for i, x in enumerate(knots):
            top, bottom = rng.uniform(1.0, 3.0), rng.uniform(0.4, 0.8)
            ends = [(x, bottom), (x + rng.normal(0.0, 0.05), top)]
            upper += ends if i % 2 == 0 else ends[::-1]
        upper = upper[1:] if len(knots) % 2 else upper[1:-1] + [upper[-1]]
        right = upper[-1][0]
        ring = [(0.0, 0.0), (right, rng.normal(0.0, 0.05)), *reversed(upper)]
        return np.array(ring) / max(right, 3.0)

    return _first_simple(draw)


def spiral_polygon(rng: Generator) -> Floats:
    """An arm of changing width wound once round or a little more."""

    def draw() -> Floats:
        k = int(rng.integers(5, 10))
        angle = rng.uniform(0, 2 * math.pi) + np.linspace(0.0, rng.uniform(3.5, 8.5), k)
        middle = np.linspace(rng.uniform(0.2, 0.35), 1.0, k) * rng.uniform(0.97, 1.03, k)
        half = rng.uniform(0.03, 0.08, k)
        ray = np.column_stack([np.cos(angle), np.sin(angle)])
        return np.vstack([ray * (middle + half)[:, None], (ray * (middle - half)[:, None])[::-1]])

    return _first_simple(draw)


def rectilinear_polygon(rng: Generator) -> Floats:
    """A random polyomino without holes: parallel edges, equal lengths, ties everywhere."""

    def draw() -> Floats:
        cells = {(0, 0)}
        for _ in range(int(rng.integers(3, 11))):
            x, y = sorted(cells)[int(rng.integers(len(cells)))]
            step = [(1, 0), (-1, 0), (0, 1), (0, -1)][int(rng.integers(4))]
            cells.add((x + step[0], y + step[1]))
        union = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in cells])
        if union.geom_type != "Polygon" or len(union.interiors):
            return np.zeros((3, 2))
        return np.array(union.simplify(0.0).exterior.coords)[:-1]

    return _first_simple(draw)


def lattice_polygon(rng: Generator) -> Floats:
    """Random polygon with integer corners on a small grid: collinear and parallel by accident."""

    def draw() -> Floats:
        n, side = int(rng.integers(6, 13)), int(rng.integers(5, 9))
        spots = rng.choice(side * side, n, replace=False)
        return _uncrossed(np.column_stack([spots % side, spots // side]).astype(np.float64), rng)

    return _first_simple(draw)


def tool_polygon(rng: Generator) -> Floats:
    """A handle with a head: hammer, open-ended wrench or hook, dimensions drawn."""

    def draw() -> Floats:
        half, length = rng.uniform(0.06, 0.12), rng.uniform(1.0, 1.6)
        wide, high = rng.uniform(0.25, 0.5), rng.uniform(0.25, 0.5)
        slot, deep = rng.uniform(0.08, 0.2), rng.uniform(0.1, 0.22)
        top = length + high
        hammer = [
            (-half, 0), (half, 0), (half, length), (wide, length), (wide, top),
            (-wide, top), (-wide, length), (-half, length),
        ]  # fmt: skip
        wrench = [
            (-half, 0), (half, 0), (half, length), (wide, length + 0.4 * high), (wide, top),
            (slot, top), (slot, top - deep), (-slot, top - deep), (-slot, top), (-wide, top),
            (-wide, length + 0.4 * high), (-half, length),
        ]  # fmt: skip
        hook = [
            (-half, 0), (half, 0), (half, length), (wide, length), (wide, length - high),
            (wide + 2 * half, length - high), (wide + 2 * half, length + 2 * half),
            (-half, length + 2 * half),
        ]  # fmt: skip
        ring = np.array([hammer, wrench, hook][int(rng.integers(3))], dtype=np.float64)
        return ring + rng.normal(0.0, 0.012, ring.shape)

    return _first_simple(draw)


FAMILIES: dict[str, Callable[[Generator], Floats]] = {
    "random": random_polygon,
    "star": star_polygon,
    "comb": comb_polygon,
    "spiral": spiral_polygon,
    "rectilinear": rectilinear_polygon,
    "lattice": lattice_polygon,
    "tool": tool_polygon,
}


def rotated(points: Floats, angle: float, shift: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """Points (..., 2) turned about the origin by ``angle`` [rad], then shifted."""
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]]) + np.array(shift)


def _first_simple(draw: Callable[[], Floats]) -> Floats:
    """First drawn ring that is simple, has an area and no crack narrower than NARROWEST."""
    for _ in range(TRIES):
        ring = draw()
        polygon = shapely.Polygon(ring)
        if not polygon.is_valid or polygon.area < 1e-3 * polygon.convex_hull.area:
            continue
        if not polygon.exterior.is_ccw:
            ring = ring[::-1].copy()
        if _narrowest(ring) > NARROWEST:
            return ring
    raise RuntimeError(f"no simple polygon in {TRIES} tries")


def _narrowest(ring: Floats) -> float:
    """Smallest distance from a vertex to an edge not its own, and shortest edge, [diameter]."""
    n = len(ring)
    ends = np.roll(ring, -1, axis=0)
    edge = ends - ring
    square = (edge**2).sum(1)
    if square.min() == 0.0:
        return 0.0
    along = ((ring[:, None] - ring[None]) * edge[None]).sum(-1) / square[None]
    foot = ring[None] + np.clip(along, 0.0, 1.0)[..., None] * edge[None]
    distance = np.linalg.norm(ring[:, None] - foot, axis=-1)
    own = np.eye(n, dtype=bool) | np.roll(np.eye(n, dtype=bool), -1, axis=1)
    distance[own] = np.inf
    diameter = np.linalg.norm(ring[:, None] - ring[None], axis=-1).max()
    return float(min(distance.min(), np.sqrt(square.min())) / diameter)


def _uncrossed(points: Floats, rng: Generator) -> Floats:
    """2-opt: reverse the piece between two crossing edges until none cross."""
    order = list(rng.permutation(len(points)))
    for _ in range(400):
        crossing = _first_crossing(points[order])
        if crossing is None:
            return points[order]
        i, j = crossing
        order[i + 1 : j + 1] = order[i + 1 : j + 1][::-1]
    return np.zeros((3, 2))


def _first_crossing(ring: Floats) -> tuple[int, int] | None:
    n = len(ring)
    a, b = ring, np.roll(ring, -1, axis=0)

    def side(p: Floats, q: Floats, r: Floats) -> Floats:
        return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (
            r[..., 0] - p[..., 0]
        )

    ai, bi, aj, bj = a[:, None], b[:, None], a[None], b[None]
    first = side(ai, bi, aj) * side(ai, bi, bj) < 0.0
    second = side(aj, bj, ai) * side(aj, bj, bi) < 0.0
    hits = np.argwhere(np.triu(first & second, 1))
    if len(hits) == 0:
        return None
    i, j = hits[0]
    return (int(i), int(j)) if (j - i) % n != 0 else None
