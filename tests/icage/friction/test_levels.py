"""sigma_first(mu): what must hold whatever the object, one closed form, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import icage
from icage.cage import Cage
from icage.errors import InputError, MethodError
from icage.friction.levels import FrictionLevel, JamTolerance, friction_levels
from icage.outline import Outline
from icage.planner import plan
from models import CASES
from tests.icage.friction.beside_sampling import drawn
from tests.oracles.geometry import Floats
from tests.oracles.polygons import rotated

MUS = (0.0, 0.01, 0.05, 0.15, 0.3, 0.6, 1.5, 20.0)
SEEDS = range(14)
TRIANGLE = np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]])
MIDDLES = np.array([[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])


def ratios(cage: Cage, found: tuple[FrictionLevel, ...]) -> Floats:
    return np.array(
        [np.inf if f.sigma_first is None else f.sigma_first / cage.sigma_0 for f in found]
    )


def of(vertices: Floats, contacts: Floats) -> Floats:
    cage = plan(Outline(vertices), contacts)
    return ratios(cage, friction_levels(cage, MUS))


def same(a: Floats, b: Floats) -> bool:
    finite = np.isfinite(a)
    return bool((finite == np.isfinite(b)).all()) and bool(
        (np.abs(a[finite] / b[finite] - 1.0) <= 1e-9).all()
    )


def test_without_friction_it_is_the_plans_own_and_more_friction_never_raises_it() -> None:
    for seed in SEEDS:
        target, _ = drawn(seed)
        cage = plan(Outline(target.vertices), target.contacts)
        found = friction_levels(cage, MUS)
        assert found[0].sigma_first == cage.sigma_first
        assert found[0].jam is None
        assert (np.diff(ratios(cage, found)[np.isfinite(ratios(cage, found))]) <= 0.0).all()
        assert [f.mu for f in found] == list(MUS)


def test_a_level_does_not_depend_on_what_else_is_asked() -> None:
    for seed in SEEDS:
        target, _ = drawn(seed)
        cage = plan(Outline(target.vertices), target.contacts)
        alone = tuple(friction_levels(cage, [mu])[0] for mu in MUS)
        assert same(ratios(cage, alone), ratios(cage, friction_levels(cage, MUS[::-1])[::-1]))


MOTIONS: dict[str, Callable[[Floats], Floats]] = {
    "turned": lambda points: rotated(points, 2.3, (0.7, -1.1)),
    "small": lambda points: 1e-3 * points,
    "large": lambda points: 1e3 * points,
    "away": lambda points: points + np.array([40.0, -30.0]),
}


@pytest.mark.parametrize("motion", MOTIONS)
def test_motion_and_scale(motion: str) -> None:
    for seed in SEEDS:
        target, _ = drawn(seed)
        move = MOTIONS[motion]
        moved = of(move(target.vertices), move(target.contacts))
        assert same(of(target.vertices, target.contacts), moved), seed


def test_labels_and_mirrors() -> None:
    mirror = np.array([-1.0, 1.0])
    for seed in SEEDS:
        target, _ = drawn(seed)
        base = of(target.vertices, target.contacts)
        for shift in (1, 2):
            assert same(base, of(target.vertices, np.roll(target.contacts, shift, axis=0))), seed
        assert same(base, of(mirror * target.vertices, (mirror * target.contacts)[[1, 0, 2]])), seed


def test_a_triangle_jams_at_the_edge_of_the_tolerance_once_friction_reaches_its_tangent() -> None:
    """Turned by a, each contact is off the foot of the middle by tan(a) times its distance."""
    cage = plan(TRIANGLE, MIDDLES)
    for angle in (0.02, 0.05):
        allowed = JamTolerance(angle=angle)
        below, above = friction_levels(
            cage, [math.tan(angle) * (1 - 1e-6), math.tan(angle) * (1 + 1e-6)], allowed
        )
        assert below.sigma_first == cage.sigma_first
        assert above.sigma_first == pytest.approx(cage.sigma_0 / math.cos(angle), rel=1e-9)


def test_a_jam_lies_outside_the_tolerance_and_is_as_wide_as_the_level() -> None:
    for seed in SEEDS:
        target, _ = drawn(seed)
        cage = plan(Outline(target.vertices), target.contacts)
        for allowed in (JamTolerance(), JamTolerance(0.03, 0.1), JamTolerance(0.0, 0.0)):
            for found in friction_levels(cage, MUS, allowed):
                if found.jam is None:
                    continue
                # the target itself, where nothing is allowed: a hair smaller, by thick features
                assert found.sigma_first == max(found.jam.sigma, cage.sigma_0)
                assert found.jam.sigma >= cage.sigma_0 * (1.0 - 1e-9)
                place = found.jam.placement
                assert place.sigma == pytest.approx(found.jam.sigma, rel=1e-12)
                shift = found.jam.contacts.mean(axis=0) - cage.contacts.mean(axis=0)
                turn = math.remainder(place.theta - cage.target_placement.theta, 2.0 * math.pi)
                moved = np.hypot(*shift) / cage.outline.diameter
                assert moved >= allowed.position * (1 - 1e-6) - 1e-12 or abs(turn) >= (
                    allowed.angle * (1 - 1e-6) - 1e-12
                )


def test_a_wider_tolerance_never_lowers_a_level() -> None:
    for seed in SEEDS:
        target, _ = drawn(seed)
        cage = plan(Outline(target.vertices), target.contacts)
        tight = ratios(cage, friction_levels(cage, MUS, JamTolerance(0.002, 0.01)))
        loose = ratios(cage, friction_levels(cage, MUS, JamTolerance(0.02, 0.05)))
        assert (tight <= loose * (1.0 + 1e-11)).all()


def test_a_hand_that_never_lets_go_may_have_no_level() -> None:
    cage = icage.plan(icage.load(CASES / "never_escapes_a.json"))
    none, some = friction_levels(cage, [0.01, 0.1])
    assert (none.sigma_first, none.jam) == (None, None)
    assert some.jam is not None
    assert cage.sigma_0 < (some.sigma_first or 0.0) < (cage.sigma_largest or 0.0)


def test_disc_fingers_have_a_curve_of_their_own() -> None:
    cage = icage.plan(icage.load(CASES / "disc_Y.json"))
    found = friction_levels(cage, MUS)
    assert found[0].sigma_first == cage.sigma_first
    assert found[-1].jam is not None
    levels = ratios(cage, found)
    assert (np.diff(levels) <= 0.0).all()
    assert levels[-1] < 0.995 * levels[0]


def test_the_contact_space_answers_no_friction() -> None:
    cage = icage.plan(icage.load(CASES / "T_best.json"), method="contact-space")
    with pytest.raises(MethodError, match="cells"):
        cage.friction(0.1)


@pytest.mark.parametrize("mu", [-0.1, math.nan, math.inf, "0.1", None, True])
def test_what_is_no_coefficient_is_refused(mu: float) -> None:
    with pytest.raises(InputError, match="mu"):
        plan(TRIANGLE, MIDDLES).friction(mu)


@pytest.mark.parametrize(("position", "angle"), [(-1.0, 0.1), (2.0, 0.1), (0.1, -0.1), (0.1, 2.0)])
def test_what_is_no_tolerance_is_refused(position: float, angle: float) -> None:
    with pytest.raises(InputError, match="tolerance"):
        JamTolerance(position, angle)


def test_the_method_of_a_cage() -> None:
    cage = plan(TRIANGLE, MIDDLES)
    assert cage.friction(0.3) == friction_levels(cage, [0.3])[0]
    wide = cage.friction(0.3, JamTolerance(angle=0.1))
    assert (wide.sigma_first or 0.0) > (cage.friction(0.3).sigma_first or 0.0)
    assert icage.friction_levels(cage, [0.3])[0] == cage.friction(0.3)


def test_contacts_that_hold_nothing_have_their_own_size() -> None:
    cage = icage.plan(icage.load(CASES / "rectangle_notcage.json"))
    assert cage.status == "not_a_cage"
    found = cage.friction(0.2)
    assert (found.sigma_first, found.jam) == (cage.sigma_first, None)
