"""Where the escape path lets the object go, and how its last segment pinches the hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from icage.cage import Cage
from icage.contact_space.method import CONTACT_SPACE
from icage.geometry.way_out import corners_before_pinch, free_from
from icage.planner import plan
from models import CASES
from tests.icage.cells.wandering import solved
from tests.oracles.path_check import path_facts

NAMES = sorted(path.stem for path in Path(CASES).glob("*.json"))
FINE = 720
"""Directions tried by the oracle, besides those to the vertices."""


def test_corners_before_the_pinch():
    assert corners_before_pinch([2.0 + 0j, 1.0 + 0j], 1.0) == 2
    assert corners_before_pinch([2.0 + 0j, 1.0 + 0j, 1e-16 + 0j, 0j], 1.0) == 2
    assert corners_before_pinch([0j], 1.0) == 1


@pytest.mark.parametrize("name", NAMES)
def test_the_path_is_pinched_once_and_its_gap_is_that_before(name: str):
    case = solved(name)
    if case.cage.status != "cage":
        assert case.cage.escape_free_at is None
        return
    cages = [case.cage]
    if not case.cage.finger_radius:
        cages.append(plan(case.cage.outline, case.cage.contacts, method=CONTACT_SPACE))
    for cage in cages:
        path = cage.escape_path
        assert path is not None
        assert cage.min_finger_gap is not None
        assert path[-2, 3] > 1e-9 * case.ring.diameter
        facts = path_facts(case.ring, case.hand, path, cage.contacts, cage.finger_radius)
        assert cage.min_finger_gap == pytest.approx(facts.finger_gap, abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_the_object_is_free_there_and_not_before(name: str):
    cage = solved(name).cage
    path, row = cage.escape_path, cage.escape_free_at
    if path is None or row is None or cage.sigma_max is None:
        assert path is row is None
        return
    assert 0 < row <= len(path) - 2
    assert is_free(cage, path[row], path[-1, :2], 1e-7)
    held = [k for k in range(row) if is_free(cage, path[k], path[-1, :2], -1e-7)]
    assert held == []
    assert path[: row + 1, 3].max() >= cage.sigma_max * (1.0 - 1e-9)  # below it none is free


def test_a_hand_beside_the_object_is_free_at_once():
    cage = solved("rectangle_notcage").cage
    outline, hand = cage.outline, cage.hand
    x, y = outline.vertices.max(axis=0) + outline.diameter
    outside = np.array([[x, y, 0.0, 1e-3], [x, y, 0.0, 1e-3], [x, y, 0.0, 0.0]])
    assert free_from(outline, hand, 0.0, outside) == 0
    assert free_from(outline, hand, 0.01 * outline.diameter, outside) == 0


def is_free(cage: Cage, row: np.ndarray, end: np.ndarray, give: float) -> bool:
    """By shapely: some straight ways are clear. A positive ``give`` [diameter] forgives contact,
    a negative one asks for clearance."""
    size, body = cage.outline.diameter, cage.outline.polygon
    fingers = cage.hand.fingers(row)
    near = cage.finger_radius - give * size
    grown = (
        body.buffer(near, quad_segs=256) if near > 0.0 else body.buffer(near, join_style="mitre")
    )
    shapely.prepare(grown)
    angles = np.linspace(0.0, 2.0 * np.pi, FINE, endpoint=False)
    for finger in fingers:
        off = cage.outline.vertices - finger
        off = off[np.hypot(*off.T) > 1e-9 * size]
        graze = np.arcsin(np.clip(cage.finger_radius / np.hypot(*off.T), 0.0, 1.0))
        to = np.arctan2(off[:, 1], off[:, 0])
        angles = np.concatenate([angles, to - graze, to + graze, to])
    far = 4.0 * size * np.column_stack([np.cos(angles), np.sin(angles)])
    rays = [[[f, f + way] for f in fingers] for way in far]
    shrinking = [[[f, to] for f in fingers] for to in [*fingers, end]]
    for ways in (rays, shrinking):
        lines = shapely.linestrings(np.array(ways))
        if bool((~shapely.intersects(grown, lines)).all(axis=1).any()):
            return True
    return False
