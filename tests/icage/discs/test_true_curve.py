"""Minima on the true curve next to given contacts."""

from __future__ import annotations

import numpy as np
import pytest

from icage.discs.true_curve import refine
from icage.hand import HandShape
from icage.outline import Outline

HOUR_GLASS = Outline(
    np.array([[0, 0], [1, 0], [2, 1], [3, 0], [4, 0], [4, 3], [3, 3], [2, 2], [1, 3], [0, 3.0]])
)


@pytest.mark.parametrize("off", [0.0, 1e-6, 1e-3])
def test_a_finger_of_a_minimum_may_be_free(off: float) -> None:
    """Fingers 1 and 2 in the two notches, finger 3 beside the object."""
    radius = 0.1
    deep = radius * np.sqrt(2.0)
    at = np.array([[2.0, 1.0 - deep], [2.0, 2.0 + deep], [-1.0, 1.5]])
    hand = HandShape.from_contacts(at)
    found = refine(HOUR_GLASS, hand, radius, at + off * np.array([0.3, -0.5]))
    assert found is not None
    np.testing.assert_allclose(found, at, rtol=0.0, atol=1e-12)


def test_one_finger_holds_nothing() -> None:
    at = np.array([[2.0, 0.9], [2.0, 5.0], [-1.0, 1.5]])
    assert refine(HOUR_GLASS, HandShape.from_contacts(at), 0.1, at) is None
