"""What must not change the answer: motion, scale, labels, the start vertex, subdivided edges."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from icage.arrays import FloatArray
from icage.cage import Cage
from icage.outline import Outline
from icage.planner import plan
from models import CASES

FILES = [
    path
    for path in sorted(CASES.glob("*.json"))
    if json.loads(path.read_text())["expected"]["verdict"] != "not_a_cage"
]
EXACT = 1e-9


def data_of(path: Path) -> tuple[FloatArray, FloatArray, float]:
    data = json.loads(path.read_text())
    return (
        np.array(data["outline"]["vertices"]),
        np.array(data["grasp"]["contacts"]),
        data["finger_radius"],
    )


def ratios(cage: Cage) -> list[float]:
    levels = (cage.sigma_first, cage.sigma_max, cage.sigma_largest)
    return [np.inf if level is None else level / cage.sigma_0 for level in levels]


def rigid(angle: float, shift: FloatArray) -> Callable[[FloatArray], FloatArray]:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return lambda points: points @ turn.T + shift


def check(path: Path, moved: Cage, within: float = EXACT) -> None:
    vertices, contacts, radius = data_of(path)
    base = plan(Outline(vertices), contacts, radius)
    assert moved.status == base.status
    assert len(moved.grasps) == len(base.grasps)
    for a, b in zip(ratios(moved), ratios(base), strict=True):
        assert a == b or abs(a / b - 1.0) <= within


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_rigid_motion(path: Path) -> None:
    vertices, contacts, radius = data_of(path)
    rng = np.random.default_rng(3)
    for _ in range(3):
        move = rigid(rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-3.0, 3.0, 2))
        check(path, plan(Outline(move(vertices)), move(contacts), radius))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
@pytest.mark.parametrize("factor", [1e-3, 0.1, 1e3])
def test_scale(path: Path, factor: float) -> None:
    vertices, contacts, radius = data_of(path)
    check(path, plan(Outline(factor * vertices), factor * contacts, factor * radius))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_start_vertex(path: Path) -> None:
    vertices, contacts, radius = data_of(path)
    for shift in (1, len(vertices) // 2):
        check(path, plan(Outline(np.roll(vertices, shift, axis=0)), contacts, radius))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_edge_subdivision(path: Path) -> None:
    vertices, contacts, radius = data_of(path)
    after = np.roll(vertices, -1, axis=0)
    finer = np.stack([vertices, vertices + 0.37 * (after - vertices)], axis=1).reshape(-1, 2)
    check(path, plan(Outline(finer), contacts, radius))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_cyclic_relabelling(path: Path) -> None:
    """sigma then measures another side; its ratios stay."""
    vertices, contacts, radius = data_of(path)
    for shift in (1, 2):
        check(path, plan(Outline(vertices), np.roll(contacts, shift, axis=0), radius))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_reflection(path: Path) -> None:
    """Mirrored points and fingers 1 and 2 swapped: phi -> (pi - phi_2, pi - phi_1)."""
    vertices, contacts, radius = data_of(path)
    mirror = np.array([-1.0, 1.0])
    moved = plan(Outline(mirror * vertices), (mirror * contacts)[[1, 0, 2]], radius)
    check(path, moved)
    phi_1, phi_2 = plan(Outline(vertices), contacts, radius).hand.phi_deg
    assert moved.hand.phi_deg == pytest.approx((180.0 - phi_2, 180.0 - phi_1), abs=1e-6)


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_far_from_the_origin(path: Path) -> None:
    """A million diameters away a coordinate keeps about ten digits of the object."""
    vertices, contacts, radius = data_of(path)
    far = 1e6 * Outline(vertices).diameter * np.array([0.8, -0.6])
    check(path, plan(Outline(vertices + far), contacts + far, radius), within=1e-6)


def test_a_planted_change_is_seen() -> None:
    """The comparison itself can fail: an arm of the L longer by a thousandth."""
    path = next(p for p in FILES if p.stem == "L_best")
    vertices, contacts, radius = data_of(path)
    other = vertices.copy()
    other[[1, 2], 0] *= 1.001
    other[[4, 5], 1] *= 1.001
    with pytest.raises(AssertionError):
        check(path, plan(Outline(other), contacts, radius))
