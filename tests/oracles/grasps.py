"""Immobilizing grasps of a small polygon, by a dense grid of where the lines of force meet.

For every point P of a grid all edges and concave vertices through which a force can run to or from
P are met; every three of them are a grasp if the forces hold (statics.py). Forces that are parallel
meet nowhere: two fingers on one edge and the third in a concave vertex are listed apart. Our own.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from tests.oracles.geometry import Floats, Ring
from tests.oracles.statics import is_strict_minimum

WIDEST = 8.0
"""[1] Longest over shortest side of the hands that are looked at."""

FLATTEST = 0.05
"""[1] ... and their least height over their longest side."""

APART = 1e-3
"""[diameter] ... and the least distance of two fingers."""

Feature = tuple[str, int]


def carriers(ring: Ring, p: Floats) -> list[tuple[Feature, Floats]]:
    """Edges and concave vertices that can push along a line through P, and where."""
    found: list[tuple[Feature, Floats]] = []
    along = ((p - ring.starts) * ring.tangents).sum(1)
    for e in np.flatnonzero((along > 0.0) & (along < ring.lengths)).tolist():
        found.append((("edge", e), ring.starts[e] + along[e] * ring.tangents[e]))
    for v in np.flatnonzero(ring.concave).tolist():
        normals = np.array([ring.normals[v - 1], ring.normals[v]])
        shares = np.linalg.solve(normals.T, p - ring.vertices[v])
        if (shares > 0.0).all() or (shares < 0.0).all():
            found.append((("vertex", v), ring.vertices[v]))
    return found


def is_fair_hand(contacts: Floats, diameter: float) -> bool:
    """Whether the hand is one of those that are looked at; contacts counterclockwise."""
    sides = np.linalg.norm(contacts - np.roll(contacts, 1, axis=0), axis=1)
    (ax, ay), (bx, by) = contacts[1] - contacts[0], contacts[2] - contacts[0]
    high = (ax * by - ay * bx) / sides.max()
    return bool(
        sides.min() >= APART * diameter
        and sides.max() <= WIDEST * sides.min()
        and high >= FLATTEST * sides.max()
    )


def counterclockwise(contacts: Floats) -> Floats:
    """The same three points in counterclockwise order."""
    (ax, ay), (bx, by) = contacts[1] - contacts[0], contacts[2] - contacts[0]
    return contacts if ax * by - ay * bx > 0.0 else contacts[::-1].copy()


def grid_grasps(
    ring: Ring, side: int, reach: float = 1.0
) -> Iterator[tuple[frozenset[Feature], Floats]]:
    """Grasps with forces that meet on a ``side`` x ``side`` grid, with their features.

    The grid spans ``reach`` [diameter] beyond the box round the polygon. Three concave vertices
    are one grasp wherever the forces meet: it comes once.
    """
    low = ring.vertices.min(0) - reach * ring.diameter
    high = ring.vertices.max(0) + reach * ring.diameter
    # off the lattice of an outline with round coordinates
    steps = (np.arange(side) + 0.4717) / side
    fixed: set[frozenset[Feature]] = set()
    for x in low[0] + steps * (high[0] - low[0]):
        for y in low[1] + steps * (high[1] - low[1]):
            for three in combinations(carriers(ring, np.array([x, y])), 3):
                features = frozenset(f for f, _ in three)
                if features in fixed:
                    continue
                if all(kind == "vertex" for kind, _ in features):
                    fixed.add(features)
                contacts = counterclockwise(np.array([c for _, c in three]))
                if is_fair_hand(contacts, ring.diameter) and is_strict_minimum(ring, contacts):
                    yield features, contacts


def one_edge_grasps(ring: Ring, side: int) -> Iterator[Floats]:
    """Grasps with two fingers on one edge and the third in a concave vertex, forces parallel."""
    for e in range(len(ring)):
        for v in np.flatnonzero(ring.concave).tolist():
            steps = ring.lengths[e] * (np.arange(side) + 0.5) / side
            for a, b in combinations(steps, 2):
                on = ring.starts[e] + np.array([[a], [b]]) * ring.tangents[e]
                contacts = counterclockwise(np.vstack([on, ring.vertices[v]]))
                if is_fair_hand(contacts, ring.diameter) and is_strict_minimum(ring, contacts):
                    yield contacts
