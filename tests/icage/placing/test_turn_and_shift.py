"""Turn and shift together: closed forms, and beside hands that are turned and shifted."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

import icage
from icage.placing.turn_and_shift import TurnAndShift
from tests.icage.placing.beside_sampling import clearances, drawn

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_a_square_beside_a_pair_of_fingers() -> None:
    """The pivot is (3, 0.5), an arm is 1.5: the finger turns past the square's side."""
    bears = TurnAndShift(SQUARE, np.array([[1.5, 0.5], [4.5, 0.5]]), 0.1)
    assert bears.pivot.tolist() == [3.0, 0.5]
    assert bears.shift == pytest.approx(0.4)
    assert bears.shift_at(math.pi) == pytest.approx(0.4)  # turning, it only gets further away
    assert bears.turn == math.pi
    assert bears.turn_at(0.41) == 0.0


def test_a_finger_that_turns_into_a_side() -> None:
    """Fingers at (2, 1.5) and (2, -0.5): one swings down to height 1 on the left, at 60 deg."""
    bears = TurnAndShift(SQUARE, np.array([[1.5, 1.5], [1.5, -0.5]]), 0.0)
    assert bears.shift == pytest.approx(math.hypot(0.5, 0.5))
    # the corner (1, 1) lies within the arc; the arc of radius 1 about (1.5, 0.5) meets y = 1
    assert bears.turn == pytest.approx(math.radians(60.0))
    assert bears.shift_at(math.radians(61.0)) == 0.0
    half = bears.turn_at(0.2)
    assert bears.shift_at(half) == pytest.approx(0.2)


def test_corners_on_the_arc() -> None:
    """A corner that a finger passes closest in the middle of its arc."""
    thin = np.array([[0.0, 0.0], [2.0, -0.01], [2.0, 0.01]])
    bears = TurnAndShift(thin, np.array([[-0.2, 0.4], [-4.2, -0.4]]), 0.0)
    arm = math.hypot(2.0, 0.4)
    assert bears.shift_at(0.5) == pytest.approx(2.2 - arm)
    assert bears.shift == pytest.approx(math.hypot(0.2, 0.4))


@pytest.mark.parametrize(("seed", "radius"), [(k, 0.0) for k in range(20)] + [(3, 0.03), (9, 0.03)])
def test_turned_and_shifted_hands_are_clear_and_no_more_is_borne(seed: int, radius: float) -> None:
    cage = drawn(seed, radius)
    assert cage.work is not None
    best = icage.place(cage)
    bears = best.turn_and_shift
    assert bears.shift == pytest.approx(best.clearance, rel=1e-9)
    curve = bears.curve(9)
    assert curve[0, 1] == pytest.approx(bears.shift)
    assert (np.diff(curve[:, 1]) <= 1e-12).all()
    for turn, shift in curve[1:-1].tolist():
        assert shift >= bears.within_tolerance(best.tolerance, turn) - 1e-9
        turns = np.linspace(-turn, turn, 4001)
        least = float(clearances(cage, _turned(cage, best, turns)).min())
        # dense turns come as near as they are dense
        step = 2.0 * turn / 4000 * float(np.abs(best.fingers - bears.pivot).max()) * 1.5
        assert least - step <= shift <= least + 1e-9
    if bears.turn < math.pi:
        beyond = _turned(cage, best, np.linspace(-1.0, 1.0, 20001) * (bears.turn + 1e-3))
        assert clearances(cage, beyond).min() < 1e-3 * cage.outline.diameter
        assert cage.query(_turned(cage, best, np.array([0.999 * bears.turn]))).in_cage.all()


def _turned(cage: icage.Cage, best: icage.BestPlacement, turns: np.ndarray) -> np.ndarray:
    at = best.placement
    w = at.sigma * np.exp(1j * (at.theta + turns))
    pivot = complex(*best.turn_and_shift.pivot)
    first = pivot - w * cage.hand.z.mean()
    return np.column_stack([first.real, first.imag, at.theta + turns, np.full(len(w), at.sigma)])


def test_the_distance_is_to_the_outline() -> None:
    """At no turn it is shapely's distance."""
    rng = np.random.default_rng(1)
    ring = shapely.Polygon(SQUARE)
    for _ in range(50):
        fingers = rng.uniform(-1.0, 2.0, (3, 2))
        if shapely.distance(shapely.points(fingers), ring).min() > 0.0:
            found = TurnAndShift(SQUARE, fingers, 0.0).shift
            assert found == pytest.approx(shapely.distance(shapely.points(fingers), ring).min())
