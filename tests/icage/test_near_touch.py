"""Outlines that all but touch themselves are refused; short edges and flat corners are not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.errors import OutlineError
from icage.near_touch import NEAREST, near_touch
from icage.outline import Outline
from tests.oracles.geometry import Floats
from tests.oracles.polygons import FAMILIES, rotated


def slotted(gap: float) -> Floats:
    """A square with a slot of this width, down to its middle."""
    half = 0.5 * gap
    return np.array([
        [-1, -1], [1, -1], [1, 1], [half, 1], [half, 0], [-half, 0], [-half, 1], [-1, 1]
    ])  # fmt: skip


def necked(gap: float) -> Floats:
    """Two triangles that hang together by a neck of this width."""
    half = 0.5 * gap
    return np.array([[-1, -1], [0, -half], [1, -1], [1, 1], [0, half], [-1, 1]])


@pytest.mark.parametrize("make", [slotted, necked])
@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_the_width_of_slots_and_necks_decides(make: object, size: float, angle: float) -> None:
    diameter = 2.0 * 2.0**0.5
    for gap in (1e-12, 1e-10, 0.9 * NEAREST):
        with pytest.raises(OutlineError, match="nearly touches itself: its vertex") as told:
            Outline(size * rotated(make(gap * diameter), angle))  # type: ignore[operator]
        assert "\n" not in str(told.value)
    Outline(size * rotated(make(1.1 * NEAREST * diameter), angle))  # type: ignore[operator]


@settings(max_examples=60)
@given(
    st.integers(0, 10_000),
    st.sampled_from(sorted(FAMILIES)),
    st.floats(-17, -3),
    st.floats(-17, -3),
)
def test_short_edges_and_nearly_straight_corners_are_no_near_touch(
    seed: int, family: str, short: float, bump: float
) -> None:
    rng = np.random.default_rng(seed)
    ring = FAMILIES[family](rng)
    way = np.roll(ring, -1, axis=0) - ring
    across = np.column_stack([-way[:, 1], way[:, 0]])
    beside = ring + 10.0**short * way
    middle = ring + 0.5 * way + 10.0 ** min(bump, -4.0) * across
    more = np.stack([ring, beside, middle], axis=1).reshape(-1, 2)
    assert near_touch(ring, Outline(ring).diameter) is None
    assert near_touch(more, Outline(ring).diameter) is None


def test_what_we_compute_ourselves_may_touch() -> None:
    """Offsets of a slot as wide as two fingers do."""
    assert len(Outline.computed(slotted(1e-12))) == 8
