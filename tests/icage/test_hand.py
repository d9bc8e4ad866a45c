"""HandShape and Placement: laws, with hands drawn near the degenerate ones on purpose."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from icage.errors import HandError, InputError, PlacementError
from icage.hand import HandShape, Placement

EQUILATERAL = HandShape(complex(0.5, math.sqrt(0.75)))


def near(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers in (0, 1) times ``high``, uniform in their logarithm down to ``low``."""
    return st.floats(math.log(low), math.log(high)).map(math.exp)


heights = st.one_of(st.floats(0.05, 3.0), near(1e-5, 1e-2))
"""Finger 3 above the line through 1 and 2: ordinary hands and nearly flat ones."""
hands = st.builds(lambda x, y: HandShape(complex(x, y)), st.floats(-0.9, 1.9), heights)
ordinary = st.builds(
    lambda x, y: HandShape(complex(x, y)), st.floats(-0.9, 1.9), st.floats(0.05, 3.0)
)
turns = st.floats(-math.pi, math.pi)
corners = st.builds(complex, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))


@st.composite
def angle_pairs(draw: st.DrawFn) -> tuple[float, float]:
    """(phi_1, phi_2), [rad], some with a very small angle at one of the three fingers."""
    smallest = draw(st.one_of(st.floats(0.02, 1.0), near(1e-5, 0.02)))
    other = draw(st.floats(0.1, 1.0)) * (math.pi - smallest) * 0.95
    at_1, at_2, at_3 = draw(st.permutations([smallest, other, math.pi - smallest - other]))
    del at_3
    return at_1, math.pi - at_2


def triangle(hand: HandShape, d: complex, w: complex) -> np.ndarray:
    f = d + w * hand.z
    return np.column_stack([f.real, f.imag])


# ------------------------------------------------------------------ shapes


@given(hands, corners, near(1e-6, 1e6), turns)
def test_contacts_give_the_shape_back(
    hand: HandShape, d: complex, sigma: float, theta: float
) -> None:
    w = cmath.rect(sigma, theta)
    assume(abs(d) <= 1e3 * sigma)
    again = HandShape.from_contacts(triangle(hand, d, w))
    assert abs(again.z_3 - hand.z_3) <= 1e-12 * (1.0 + abs(d) / sigma) * (1.0 + abs(hand.z_3))


@given(angle_pairs())
def test_angles_round_trip(phi: tuple[float, float]) -> None:
    hand = HandShape.from_angles(*phi)
    assert hand.phi == pytest.approx(phi, rel=1e-9, abs=1e-15)
    in_degrees = HandShape.from_angles_deg(*(math.degrees(a) for a in phi))
    assert in_degrees.phi_deg == pytest.approx([math.degrees(a) for a in phi], rel=1e-9)


@given(angle_pairs())
def test_finger_3_obeys_the_law_of_sines(phi: tuple[float, float]) -> None:
    """|f_3 - f_1| / sin phi_2 = |f_2 - f_1| / sin(phi_2 - phi_1). [Bunis2018, Eq. (1)]"""
    hand = HandShape.from_angles(*phi)
    at_3 = phi[1] - phi[0]
    assert abs(hand.z_3) == pytest.approx(math.sin(phi[1]) / math.sin(at_3), rel=1e-9)
    assert abs(hand.z_3 - 1.0) == pytest.approx(math.sin(phi[0]) / math.sin(at_3), rel=1e-9)


def test_known_angles() -> None:
    assert EQUILATERAL.phi_deg == pytest.approx((60.0, 120.0), abs=1e-12)
    assert HandShape(1j).phi_deg == pytest.approx((90.0, 135.0), abs=1e-12)
    assert HandShape(1 + 1j).phi_deg == pytest.approx((45.0, 90.0), abs=1e-12)


@given(ordinary, st.integers(0, 2))
def test_relabelling_is_the_same_triangle(hand: HandShape, first: int) -> None:
    again = hand.relabelled(first)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        was = abs(hand.z[(first + i) % 3] - hand.z[(first + j) % 3])
        assert abs(again.z[i] - again.z[j]) * abs(
            hand.z[(first + 1) % 3] - hand.z[first]
        ) == pytest.approx(was, rel=1e-12)
    assert again.z_3.imag > 0.0


@given(ordinary, st.integers(0, 2), st.integers(0, 2))
def test_relabelling_adds_up(hand: HandShape, a: int, b: int) -> None:
    twice = hand.relabelled(a).relabelled(b)
    assert abs(twice.z_3 - hand.relabelled((a + b) % 3).z_3) <= 1e-9 * abs(twice.z_3)
    assert hand.relabelled(0) == hand


@given(ordinary, st.integers(0, 2), turns)
def test_relabelling_agrees_with_relabelled_contacts(
    hand: HandShape, first: int, theta: float
) -> None:
    points = triangle(hand, 0.3 - 0.2j, cmath.rect(1.7, theta))
    again = HandShape.from_contacts(np.roll(points, -first, axis=0))
    assert abs(again.z_3 - hand.relabelled(first).z_3) <= 1e-11 * abs(again.z_3) ** 2 + 1e-11


@pytest.mark.parametrize(
    ("z_3", "flat"),
    [(1000 + 0.002j, True), (1000 + 2.0j, False), (1e5 + 0.2j, True), (1e5 + 2e5j, False)],
)
def test_which_hands_are_flat_does_not_depend_on_the_labels(z_3: complex, flat: bool) -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [z_3.real, z_3.imag]])
    for first in range(len(points)):
        if flat:
            with pytest.raises(HandError, match=r"collinear .* longest side [0-9.]+e-(09|11)"):
                HandShape.from_contacts(np.roll(points, -first, axis=0))
        else:
            assert HandShape(z_3).relabelled(first).z_3.imag > 0.0


@given(st.floats(-2.0, 3.0), near(1e-7, 1e-4))
def test_the_bound_of_flatness_is_that_of_the_triangle(x: float, y: float) -> None:
    """Twice the area, y, over the square of the longest side, whichever finger comes first."""
    c = max(1.0, math.hypot(x, y), math.hypot(x - 1.0, y))
    assume(abs(y / c**2 / 1e-6 - 1.0) > 1e-9)
    flat = y / c**2 <= 1e-6
    points = np.array([[0.0, 0.0], [1.0, 0.0], [x, y]])
    for first in range(len(points)):
        rolled = np.roll(points, -first, axis=0)
        if flat:
            with pytest.raises(HandError):
                HandShape.from_contacts(rolled)
        else:
            assert HandShape.from_contacts(rolled).z_3.imag > 0.0


def test_unit_fingers_are_finger_1_at_the_origin_and_2_at_one() -> None:
    assert EQUILATERAL.unit_fingers.tolist() == [[0, 0], [1, 0], [0.5, math.sqrt(0.75)]]
    with pytest.raises(ValueError, match="read-only"):
        EQUILATERAL.z[2] = 1j


def test_equal_shapes_are_equal() -> None:
    assert HandShape(0.5 + 1j) == HandShape(0.5 + 1j)
    assert HandShape(0.5 + 1j) != HandShape(0.5 + 1.1j)
    assert len({HandShape(0.5 + 1j), HandShape(0.5 + 1j), HandShape(1j)}) == 2


# ------------------------------------------------------------------ fingers


@given(hands, corners, st.floats(0.0, 1e3), turns)
def test_fingers_stand_at_d_plus_w_z(
    hand: HandShape, d: complex, sigma: float, theta: float
) -> None:
    fingers = hand.fingers(np.array([d.real, d.imag, theta, sigma]))
    assert fingers.shape == (3, 2)
    c, s = math.cos(theta), math.sin(theta)
    turn = np.array([[c, -s], [s, c]])
    wanted = [d.real, d.imag] + sigma * hand.unit_fingers @ turn.T
    assert fingers == pytest.approx(wanted, abs=1e-12 * (3.0 + sigma * (1.0 + abs(hand.z_3))))


def test_fingers_of_many_placements_at_once() -> None:
    rows = np.random.default_rng(0).normal(size=(4, 5, 4))
    many = EQUILATERAL.fingers(rows)
    assert many.shape == (4, 5, 3, 2)
    assert (many[2, 3] == EQUILATERAL.fingers(rows[2, 3])).all()
    assert EQUILATERAL.fingers(np.zeros((0, 4))).shape == (0, 3, 2)


@given(hands, corners, near(1e-3, 1e3), turns)
def test_a_placement_and_its_contacts(
    hand: HandShape, d: complex, sigma: float, theta: float
) -> None:
    points = triangle(hand, d, cmath.rect(sigma, theta))
    placement = Placement.from_contacts(points)
    assert placement.sigma == pytest.approx(sigma, rel=1e-9, abs=1e-12 * abs(d))
    slack = 1e-11 * (abs(d) + sigma * (1.0 + abs(hand.z_3)))
    assert hand.fingers(placement.as_array()) == pytest.approx(points, abs=slack)


@given(ordinary, st.lists(corners, min_size=1, max_size=5))
def test_least_gap_against_many_hands_on_the_way(hand: HandShape, way: list[complex]) -> None:
    """Never above what samples of the polyline show, and not more than their step below it."""
    steps = np.linspace(0.0, 1.0, 201)
    w = np.array(way[:1])
    for a, b in pairwise(way):
        w = np.concatenate([w, a + steps * (b - a)])
    sides = np.abs([hand.z[1] - hand.z[0], hand.z[2] - hand.z[1], hand.z[0] - hand.z[2]])
    sampled = float((np.abs(w)[:, None] * sides).min())
    longest = max([abs(b - a) for a, b in pairwise(way)], default=0.0)
    least = hand.least_gap(way)
    assert least <= sampled * (1.0 + 1e-12) + 1e-15
    assert least >= sampled - longest / 200 * float(sides.min()) - 1e-12


def test_least_gap_on_a_way_through_nothing() -> None:
    assert EQUILATERAL.least_gap([1 + 0j, -1 + 0j]) == pytest.approx(0.0, abs=1e-15)
    assert EQUILATERAL.least_gap([1 + 1j, 1 - 1j]) == pytest.approx(1.0)
    assert HandShape(0.25j).least_gap([2 + 0j, 2 + 0j]) == pytest.approx(0.5)


# ------------------------------------------------------------------ what is refused


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        ([[0, 0], [0, 1], [1, 0]], "clockwise; give them counterclockwise"),
        ([[0, 0], [1, 0], [2, 0]], r"collinear or coincident \(height over longest side 0; above"),
        ([[0, 0], [1, 0], [0.5, 1e-7]], r"height over longest side 1e-07; above 1e-06 needed"),
        ([[0, 0], [0, 0], [1, 0]], "two of the three fingers coincide"),
        ([[0, 0], [1, 0], [1, 1e-12]], "two of the three fingers coincide"),
        ([[1, 1]] * 3, "two of the three fingers coincide"),
        ([[0, 0], [1, 0]], r"three finite points \(x, y\) are needed, found shape \(2, 2\)"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], r"three finite points .* \(3, 3\)"),
        ([[0, 0], [1, 0], [math.nan, 1]], "three finite points"),
        ([[0, 0], [1, 0], [math.inf, 1]], "three finite points"),
        (-1, r"three finite points .* found shape \(\)"),
    ],
)
def test_refused_contacts(contacts: object, message: str) -> None:
    with pytest.raises(HandError, match=message):
        HandShape.from_contacts(contacts)  # type: ignore[arg-type]
    assert issubclass(HandError, InputError)


@pytest.mark.parametrize(
    "contacts",
    [
        [[0, 0], [1], [0, 1]],
        [["left", "down"]] * 3,
        [["0", "0"], ["1", "0"], ["0", "1"]],
        [[0, 0], [1, 0], [0, 1j]],
    ],
)
def test_what_is_no_array_of_numbers_is_refused(contacts: object) -> None:
    with pytest.raises(HandError):
        HandShape.from_contacts(contacts)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "phi",
    [(0, 90), (90, 90), (90, 80), (90, 180), (-30, 60), (math.nan, 90), (30, math.inf)],
)
def test_refused_angles(phi: tuple[float, float]) -> None:
    with pytest.raises(
        HandError, match=r"0 < phi_1 < phi_2 < 180 is needed|finite number is needed"
    ):
        HandShape.from_angles_deg(*phi)


@pytest.mark.parametrize("z_3", [complex(math.nan, 1), complex(0, math.inf)])
def test_refused_shapes_that_are_not_finite(z_3: complex) -> None:
    with pytest.raises(HandError, match="finite coordinates are needed"):
        HandShape(z_3)


@given(st.floats(-2.0, 3.0), near(1e-8, 1e-4), st.booleans())
def test_nearly_flat_hands_are_accepted_or_refused_for_what_they_are(
    x: float, y: float, below: bool
) -> None:
    """Flat within the bound: collinear, on either side of the line. Beyond it: a hand or turned."""
    longest = max(1.0, abs(complex(x, y)), abs(complex(x - 1.0, y)))
    z_3 = complex(x, -y if below else y)
    height = y / longest / longest
    if height <= 1e-6:
        with pytest.raises(HandError, match="collinear"):
            HandShape(z_3)
    elif below:
        with pytest.raises(HandError, match="clockwise"):
            HandShape(z_3)
    else:
        assert HandShape(z_3).z_3 == z_3


# ------------------------------------------------------------------ placements


def test_a_placement_is_its_four_numbers() -> None:
    placement = Placement(1.0, 2.0, -0.5, 3.0)
    assert placement.as_array().tolist() == [1.0, 2.0, -0.5, 3.0]
    assert placement == Placement(1.0, 2.0, -0.5, 3.0)
    assert Placement(0.0, 0.0, 0.0, 0.0).sigma == 0.0
    with pytest.raises(AttributeError):
        placement.x = 2.0  # type: ignore[misc]


def test_theta_is_the_direction_from_finger_1_to_2() -> None:
    placement = Placement.from_contacts(np.array([[1.0, 1.0], [1.0, 3.0], [0.0, 2.0]]))
    assert placement.as_array().tolist() == pytest.approx([1.0, 1.0, math.pi / 2, 2.0])


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ((0.0, 0.0, 0.0, -1e-300), r"sigma = -1e-300; sigma >= 0 is needed"),
        ((math.nan, 0.0, 0.0, 1.0), "x of a placement is nan"),
        ((0.0, math.inf, 0.0, 1.0), "a finite number is needed"),
        ((0.0, 0.0, math.nan, 1.0), "a finite number is needed"),
        ((0.0, 0.0, 0.0, math.inf), "a finite number is needed"),
    ],
)
def test_refused_placements(row: tuple[float, float, float, float], message: str) -> None:
    with pytest.raises(PlacementError, match=message):
        Placement(*row)
    assert issubclass(PlacementError, InputError)
