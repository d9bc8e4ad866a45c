"""Gaps of features as functions of the hand, and the forces that balance there."""

from __future__ import annotations

import numpy as np
import pytest

from icage.discs.balance import free_directions, pushing, slope_of_half_square
from icage.discs.features import Features
from icage.hand import HandShape
from icage.outline import Outline
from tests.oracles.geometry import Ring
from tests.oracles.targets import Target, random_target

STEP = 1e-6
"""[diameter] Of the finite differences."""


def drawn(number: int) -> tuple[Target, Features]:
    rng = np.random.default_rng([3, number])
    target = random_target(rng, radius=float(rng.uniform(0.01, 0.08)))
    hand = HandShape.from_contacts(target.contacts)
    return target, Features(Outline(target.vertices), target.radius, hand)


@pytest.mark.parametrize("number", range(6))
def test_slopes_and_curvature_are_derivatives(number: int) -> None:
    target, features = drawn(number)
    v = features.as_hand(target.contacts)
    near = features.near(v, 1e-3)
    assert len({f.finger for f in near}) == len(target.contacts)
    force = np.linspace(0.3, 1.0, len(near))

    def gradient(u: np.ndarray) -> np.ndarray:
        return slope_of_half_square(u) - force @ features.gaps(u, near).slope

    gaps = features.gaps(v, near)
    steps = STEP * np.eye(4)
    rise = [features.gaps(v + s, near).value - features.gaps(v - s, near).value for s in steps]
    slope = np.array(rise).T / (2.0 * STEP)
    assert slope == pytest.approx(gaps.slope, abs=1e-8)
    bend = np.array([gradient(v + s) - gradient(v - s) for s in steps]) / (2.0 * STEP)
    assert bend == pytest.approx(
        features.curvature(features.chosen(near), gaps, force), rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize("number", range(6))
def test_a_touched_feature_has_no_gap_and_a_finger_inside_is_found(number: int) -> None:
    target, features = drawn(number)
    v = features.as_hand(target.contacts)
    assert features.as_contacts(v) == pytest.approx(target.contacts, abs=1e-12)
    near = features.near(v, 1e-9)
    gaps = features.gaps(v, near)
    assert np.abs(gaps.value).max() <= 1e-9
    assert features.deepest(v, 1e-8) is None
    for k, f in enumerate(near):
        into = v.copy()
        into[:2] -= 1e-4 * gaps.normal[k]  # the whole hand
        ring = Ring.of(target.vertices)
        depths = [ring.depth(p, target.radius) for p in features.as_contacts(into)]
        deepest = features.deepest(into, 1e-8)
        assert deepest is not None
        assert deepest.finger == int(np.argmax(depths))
        if deepest.finger == f.finger:
            assert deepest in features.near(into, 1e-3)


def test_nothing_that_pushes_leaves_every_direction_free() -> None:
    along = free_directions(np.zeros((0, 4)))
    assert along @ along.T == pytest.approx(np.eye(4))
    force, miss = pushing(np.zeros((4, 0)), np.array([0.0, 0.0, 3.0, 4.0]))
    assert len(force) == 0
    assert miss == pytest.approx(5.0)
