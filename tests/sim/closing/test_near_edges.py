"""Depths from the edges that can be nearest are those from all edges, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import icage
from icage.arrays import FloatArray
from sim.closing.near_edges import MANY, NearEdges, depth_near, near_edges
from sim.world.hand_in_object import depth_at

RADIUS = 0.03


def outline(name: str) -> FloatArray:
    """In diameters."""
    if name == "spikes":  # acute corners, inwards and outwards, and a slit
        turn = np.arange(24) * np.pi / 12.0
        size = np.where(np.arange(24) % 2 == 0, 0.5, 0.05)
        return np.column_stack([size * np.cos(turn), size * np.sin(turn)])
    if name == "many edges":  # lists that would be long in the middle
        turn = np.arange(300) * np.pi / 150.0
        return 0.5 * np.column_stack([np.cos(turn), np.sin(turn)])
    case = icage.load(name)
    return case.outline.vertices / case.outline.diameter


def points_about(vertices: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Over the whole grid and beyond it, on vertices and edges, a disc's radius off, hardly off."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    anywhere = rng.uniform(low - 0.1, high + 0.1, (3000, 2))
    following = np.roll(vertices, -1, axis=0)
    k = rng.integers(len(vertices), size=3000)
    on = vertices[k] + rng.random((3000, 1)) * (following - vertices)[k]
    off = RADIUS * rng.choice([0.0, 1e-9, 0.5, 1.0, 1.0001], (3000, 1)) * rng.normal(size=(3000, 2))
    lost = np.array([[np.nan, 0.0], [np.inf, 0.0], [0.0, -1e300]])
    return np.concatenate([anywhere, vertices, on, on + off, lost])


def differing(vertices: FloatArray, near: NearEdges) -> int:
    """At how many points a depth is not the same; every point is asked twice."""
    points = points_about(vertices, np.random.default_rng(5))
    pairs = [
        (depth_at(vertices, x, y, RADIUS), depth_near(vertices, x, y, RADIUS, near))
        for _ in range(2)
        for x, y in points.tolist()
    ]
    true, found = np.array(pairs).T
    return int((true.view(np.int64) != found.view(np.int64)).sum())


@pytest.mark.parametrize("name", ["pliers", "saw", "wrench", "spikes", "many edges"])
def test_depths_are_the_same_to_the_last_bit(name: str) -> None:
    vertices = outline(name)
    near = near_edges(vertices, RADIUS, MANY)
    assert differing(vertices, near) == 0
    listed = np.abs(near.edges[:, :, 0])
    assert ((listed > 0) & (listed < 4)).sum() > 100  # there are short lists to be wrong


def test_without_many_closings_there_is_no_grid() -> None:
    vertices = outline("pliers")
    near = near_edges(vertices, RADIUS, MANY - 1)
    assert near.edges.size == 0
    assert differing(vertices, near) == 0


@pytest.mark.parametrize("name", ["pliers", "spikes"])
def test_cells_taken_too_narrow_are_seen(name: str) -> None:
    vertices = outline(name)
    near = near_edges(vertices, RADIUS, MANY)
    assert differing(vertices, near._replace(half=0.1 * near.half)) > 0
