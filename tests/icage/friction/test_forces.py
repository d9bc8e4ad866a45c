"""The forces that hold a jam: inside their cones, in balance, and of a hand that squeezes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from icage import plan
from icage.friction.forces import jam_forces
from icage.friction.levels import Jam, friction_levels
from icage.outline import Outline
from tests.icage.friction.beside_sampling import drawn

SEEDS = range(40)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_limiting_jam_is_held(seed: int) -> None:
    target, mu = drawn(seed)
    cage = plan(Outline(target.vertices), target.contacts)
    (level,) = friction_levels(cage, (mu,))
    if level.jam is None:
        pytest.skip("the frictionless level is the limit")
    held = jam_forces(cage, level.jam, mu)
    assert held.residual < 1e-7
    force = np.array([c.force for c in held.contacts])
    at = np.array([c.at for c in held.contacts])
    size = cage.outline.diameter
    total = np.hypot(*force.T).sum()
    assert np.hypot(*force.sum(axis=0)) < 1e-7 * total
    moment = np.sum(at[:, 0] * force[:, 1] - at[:, 1] * force[:, 0])
    assert abs(moment) < 1e-6 * total * size
    centre = np.array([level.jam.contacts[c.finger - 1] for c in held.contacts])
    assert np.sum(centre * force) / level.jam.sigma == pytest.approx(-1.0, abs=1e-6)
    for contact in held.contacts:
        assert contact.finger in level.jam.fingers
        right, left = contact.cone
        assert right[0] * left[1] - right[1] * left[0] == pytest.approx(
            math.sin(2.0 * math.atan(mu)), rel=1e-9
        )
        # inside the cone: left of its right edge, right of its left one
        slack = 1e-9 * max(1.0, total)
        f = contact.force
        assert right[0] * f[1] - right[1] * f[0] >= -slack
        assert f[0] * left[1] - f[1] * left[0] >= -slack


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_what_a_finger_touches_does_not_hang_on_the_unit(unit: float) -> None:
    """Fingers 1 and 2 in the middles of two sides, each with one side to push on."""
    at = unit * np.array([[0.5, 0.0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])
    cage = plan(unit * np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]]), at)
    held = jam_forces(cage, Jam((1, 2), at, 0.5 * unit), 1.0)
    assert [c.finger for c in held.contacts] == [1, 2]
    assert np.array([c.at for c in held.contacts]) == pytest.approx(at[:2], rel=1e-9, abs=1e-9)


def test_less_friction_does_not_hold_what_more_does() -> None:
    """Fingers 1 and 2 on two sides of a regular triangle: their line is 30 degrees off both
    normals, so they hold from mu = tan 30 degrees on."""
    at = np.array([[0.5, 0.0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])
    cage = plan([[0, 0], [1, 0], [0.5, 0.75**0.5]], at)
    jam, edge = Jam((1, 2), at, 0.5), math.tan(math.pi / 6.0)
    assert jam_forces(cage, jam, 1.001 * edge).residual < 1e-9
    assert jam_forces(cage, jam, 0.99 * edge).residual > 1e-4
