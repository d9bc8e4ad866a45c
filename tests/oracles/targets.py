"""Random immobilizing grasps on a polygon, for point and for disc fingers.

Fingers stand on edges, in concave corners or (discs) on the arc around a convex vertex; a grasp
is kept if sigma has a strict local minimum there (statics.py). Corners make wide cages, so they
are drawn often. [Bunis2018, Sec. VII-A] names the same grasps; the sampling is our own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from tests.oracles.geometry import Floats, Ring
from tests.oracles.polygons import FAMILIES
from tests.oracles.statics import is_strict_minimum, opening_direction

CORNER_COUNTS = (0.25, 0.3, 0.35, 0.1)
"""Chances of 0, 1, 2, 3 fingers in concave corners."""

LONGEST_STEP = 1e3
"""[1] How far w must go for the fingers to be clear by one unit: more is as good as isolated."""

FLATTEST = 0.02
"""[1] Smallest height over longest side of a hand we draw."""


@dataclass(frozen=True, slots=True)
class Target:
    """A drawn grasp: the polygon's family, its vertices (n, 2), contacts (3, 2) and radius."""

    family: str
    vertices: Floats
    contacts: Floats
    radius: float


def random_target(
    rng: Generator, family: str | None = None, radius: float = 0.0, tries: int = 4000
) -> Target:
    """A target on a fresh polygon; ``radius`` is in diameters. Polygons without one are redrawn."""
    names = list(FAMILIES)
    for _ in range(50):
        name = names[int(rng.integers(len(names)))] if family is None else family
        ring = Ring.of(FAMILIES[name](rng))
        contacts = grasp_on(ring, rng, radius * ring.diameter, tries // 10)
        if contacts is not None:
            return Target(name, ring.vertices, contacts, radius * ring.diameter)
    raise RuntimeError("no immobilizing grasp on 50 polygons")


def grasp_on(
    ring: Ring, rng: Generator, radius: float = 0.0, tries: int = 400, corners: int | None = None
) -> Floats | None:
    """Contacts (3, 2), counterclockwise, of a random strict minimum, or None after ``tries``."""
    spots = offset_corners(ring, radius) if radius > 0.0 else ring.vertices[ring.concave]
    for _ in range(tries):
        wanted = int(rng.choice(4, p=CORNER_COUNTS)) if corners is None else corners
        if wanted > len(spots):
            continue
        chosen = (
            spots[rng.choice(len(spots), wanted, replace=False)] if wanted else np.zeros((0, 2))
        )
        points = _completed(ring, rng, chosen, radius)
        if points is None:
            continue
        points = np.roll(_counterclockwise(points), int(rng.integers(3)), axis=0)
        if not (_fat_enough(points, radius) and is_strict_minimum(ring, points, radius)):
            continue
        step = opening_direction(ring, points, radius)
        if step is not None and np.hypot(*step[2:]) < LONGEST_STEP:
            return points
    return None


def offset_corners(ring: Ring, radius: float) -> Floats:
    """Centres that touch two edges or vertices at once, (m, 2): concave corners of the offset."""
    shifted = ring.starts + radius * ring.normals
    found: list[Floats] = []
    n = len(ring)
    for i in range(n):
        for j in range(i + 1, n):
            found += _line_line(shifted, ring.tangents, i, j)
            found += _circle_circle(ring.vertices[i], ring.vertices[j], radius)
        for v in range(n):
            found += _line_circle(shifted[i], ring.tangents[i], ring.vertices[v], radius)
    spots: list[Floats] = []
    for point in found:
        feet, distance = ring.nearest_on_edges(point)
        touching = distance <= radius + 1e-10 * ring.diameter
        if abs(ring.depth(point, radius)) > 1e-10 * ring.diameter:
            continue
        spread = np.ptp(feet[touching], axis=0).max()
        if spread > 1e-3 * radius and all(np.hypot(*(point - s)) > 1e-7 for s in spots):
            spots.append(point)
    return np.array(spots).reshape(-1, 2)


def _completed(ring: Ring, rng: Generator, chosen: Floats, radius: float) -> Floats | None:
    """Add edge or arc contacts to the chosen corners until there are three."""
    points = list(chosen)
    normals: list[Floats] = []
    while len(points) < 2 or (len(points) < 3 and len(chosen) > 0):
        point, normal = _smooth_contact(ring, rng, radius)
        points.append(point)
        normals.append(normal)
    if len(points) < 3:
        third = _concurrent_contact(ring, rng, points, normals, radius)
        if third is None:
            return None
        points.append(third)
    return np.array(points)


def _smooth_contact(ring: Ring, rng: Generator, radius: float) -> tuple[Floats, Floats]:
    """A random point of an edge or, for a disc, now and then of a convex vertex's arc."""
    if radius > 0.0 and rng.random() < 0.25 and not ring.concave.all():
        v = int(rng.choice(np.flatnonzero(~ring.concave)))
        a, b = ring.normals[v - 1], ring.normals[v]
        share = rng.random()
        turn = math.atan2(a[0] * b[1] - a[1] * b[0], float(a @ b)) * share
        c, s = math.cos(turn), math.sin(turn)
        normal = np.array([c * a[0] - s * a[1], s * a[0] + c * a[1]])
        return ring.vertices[v] + radius * normal, normal
    q = int(rng.choice(len(ring), p=ring.lengths / ring.lengths.sum()))
    foot = ring.starts[q] + rng.uniform(0.02, 0.98) * ring.lengths[q] * ring.tangents[q]
    return foot + radius * ring.normals[q], ring.normals[q]


def _concurrent_contact(
    ring: Ring, rng: Generator, points: list[Floats], normals: list[Floats], radius: float
) -> Floats | None:
    """Third contact whose normal meets the other two normals in one point."""
    (p, q), (m, n) = points, normals
    cross = m[0] * n[1] - m[1] * n[0]
    if abs(cross) < 1e-3:
        return None
    r = q - p
    centre = p + m * (r[0] * n[1] - r[1] * n[0]) / cross
    along = ((centre - ring.starts) * ring.tangents).sum(1)
    inside = np.flatnonzero((along > 0.01 * ring.lengths) & (along < 0.99 * ring.lengths))
    options = [
        ring.starts[e] + along[e] * ring.tangents[e] + radius * ring.normals[e] for e in inside
    ]
    if radius > 0.0:
        for v in np.flatnonzero(~ring.concave):
            way = ring.vertices[v] - centre
            if np.hypot(*way) > radius:
                way = radius * way / np.hypot(*way)
                options += [ring.vertices[v] - way, ring.vertices[v] + way]
    if not options:
        return None
    return options[int(rng.integers(len(options)))]


def _counterclockwise(points: Floats) -> Floats:
    (ax, ay), (bx, by) = points[1] - points[0], points[2] - points[0]
    return points if ax * by - ay * bx > 0.0 else points[::-1]


def _fat_enough(points: Floats, radius: float) -> bool:
    sides = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    (ax, ay), (bx, by) = points[1] - points[0], points[2] - points[0]
    if sides.min() < max(2.001 * radius, 1e-2 * sides.max()):
        return False
    return abs(ax * by - ay * bx) > FLATTEST * sides.max() ** 2


def _line_line(starts: Floats, ways: Floats, i: int, j: int) -> list[Floats]:
    cross = ways[i, 0] * ways[j, 1] - ways[i, 1] * ways[j, 0]
    if abs(cross) < 1e-9:
        return []
    r = starts[j] - starts[i]
    return [starts[i] + ways[i] * (r[0] * ways[j, 1] - r[1] * ways[j, 0]) / cross]


def _line_circle(start: Floats, way: Floats, centre: Floats, radius: float) -> list[Floats]:
    along = float((centre - start) @ way)
    off = centre - start - along * way
    square = radius**2 - float(off @ off)
    if square <= 1e-9 * radius**2:
        return []
    return [start + (along + s * math.sqrt(square)) * way for s in (-1.0, 1.0)]


def _circle_circle(a: Floats, b: Floats, radius: float) -> list[Floats]:
    way = b - a
    length = float(np.hypot(*way))
    square = radius**2 - length**2 / 4.0
    if square <= 1e-9 * radius**2 or length == 0.0:
        return []
    side = math.sqrt(square) * np.array([-way[1], way[0]]) / length
    return [(a + b) / 2.0 + side, (a + b) / 2.0 - side]
