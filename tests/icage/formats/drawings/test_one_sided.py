"""One-sided outlines: on their side by exact arithmetic, near, and with few corners."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from icage.errors import FormatError
from icage.formats.drawings.one_sided import one_sided
from icage.formats.drawings.reading import SIDES, Side
from icage.formats.drawings.simplify import simplified

Point = tuple[Fraction, Fraction]


def exact(ring: np.ndarray) -> list[Point]:
    return [(Fraction(float(x)), Fraction(float(y))) for x, y in ring]


def turn(a: Point, b: Point, c: Point) -> Fraction:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def winding(p: Point, ring: list[Point]) -> int | None:
    """Winding number of a ring around a point; None on the ring. In fractions."""
    total = 0
    for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
        side = turn(a, b, p)
        on = min(a[0], b[0]) <= p[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= p[1] <= max(
            a[1], b[1]
        )
        if side == 0 and on:
            return None
        if a[1] <= p[1] < b[1] and side > 0:
            total += 1
        elif b[1] <= p[1] < a[1] and side < 0:
            total -= 1
    return total


def holds(outer: np.ndarray, inner: np.ndarray) -> bool:
    """No corner of either is on the wrong side and no two edges cross properly: exactly."""
    out, inn = exact(outer), exact(inner)
    if any(winding(p, out) == 0 for p in inn):
        return False
    if any(winding(p, inn) not in (0, None) for p in out):
        return False
    for a, b in zip(out, out[1:] + out[:1], strict=True):
        for c, d in zip(inn, inn[1:] + inn[:1], strict=True):
            if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
                return False
    return True


def flower(n: int, petals: int = 5) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    radius = 1.0 + 0.3 * np.sin(petals * angle)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("error", [0.0, 4e-4])
def test_a_curved_ring_keeps_its_side_and_loses_most_corners(side: Side, error: float):
    ring = flower(300)
    fewer = one_sided(ring, 0.02, side, error)
    assert holds(*((ring, fewer) if side == "inside" else (fewer, ring)))
    assert len(fewer) < 2 * len(simplified(ring, 0.02))
    assert shapely.hausdorff_distance(shapely.LinearRing(fewer), shapely.LinearRing(ring)) <= 0.02


@pytest.mark.parametrize("side", SIDES)
def test_the_error_of_the_ring_is_kept_as_a_distance(side: Side):
    ring = flower(300)
    fewer = one_sided(ring, 0.02, side, 1e-3)
    apart = shapely.LinearRing(fewer).distance(shapely.LinearRing(ring))
    assert apart >= 1e-3 * (1 - 1e-9)


@pytest.mark.parametrize("side", SIDES)
def test_straight_edges_that_are_all_needed_stay_bit_for_bit(side: Side):
    ring = np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], dtype=float)
    assert (one_sided(ring, 0.01, side, 0.0) == ring).all()


@pytest.mark.parametrize("side", SIDES)
def test_a_clockwise_ring_is_turned(side: Side):
    fewer = one_sided(flower(200)[::-1], 0.01, side, 1e-4)
    assert shapely.LinearRing(fewer).is_ccw


def test_a_neck_thinner_than_the_error_is_said():
    neck = 1e-3
    ring = np.array([
        [0, 0], [2, 0], [2, 1 - neck], [4, 1 - neck], [4, 0], [6, 0],
        [6, 2], [4, 2], [4, 1], [2, 1], [2, 2], [0, 2],
    ])  # fmt: skip
    assert len(one_sided(ring, 0.01, "outside", 1e-3)) >= 3
    with pytest.raises(FormatError, match="falls apart"):
        one_sided(ring, 0.01, "inside", 1e-3)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(0.2, 1.0), min_size=5, max_size=30), st.sampled_from(SIDES),
    st.floats(1e-4, 0.1), st.sampled_from([0.0, 1e-5]),
)  # fmt: skip
def test_random_stars_keep_their_side(radii: list[float], side: Side, within: float, error: float):
    angle = np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * np.array(radii)[:, None]
    fewer = one_sided(ring, within, side, error)
    assert shapely.Polygon(fewer).is_valid
    assert holds(*((ring, fewer) if side == "inside" else (fewer, ring)))
