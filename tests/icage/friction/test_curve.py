"""The curve mu -> sigma_first, the ends of closings and the nearest jam, for points and discs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import icage
from icage.cage import Cage
from icage.errors import InputError, PlacementError
from icage.friction.curve import _fall
from icage.outline import Outline
from icage.planner import plan
from models import CASES
from tests.icage.friction.beside_sampling import drawn, drawn_disc
from tests.oracles import disc_jams
from tests.oracles.geometry import Ring
from tests.oracles.jams import residual

TRIANGLE = np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]])
SAME = 1e-7
"""[1] Levels of discs are lowered by what was not halved: that depends on what was known before."""

MIDDLES = np.array([[0.5, 0], [0.75, 0.1875**0.5], [0.25, 0.1875**0.5]])


def cages() -> list[Cage]:
    """Four targets of point fingers, three of discs."""
    found = [plan(Outline(t.vertices), t.contacts) for t, _ in map(drawn, (1, 2, 5, 8))]
    discs = [drawn_disc(seed)[0] for seed in (3, 8, 19)]
    return found + [plan(Outline(t.vertices), t.contacts, t.radius) for t in discs]


def level(found: icage.FrictionLevel) -> float:
    return math.inf if found.sigma_first is None else found.sigma_first


def test_a_curve_says_what_single_levels_say() -> None:
    rng = np.random.default_rng(0)
    for cage in cages():
        curve = icage.friction_curve(cage)
        assert (np.diff(curve.level[np.isfinite(curve.level)]) <= 0.0).all()
        assert (curve.mu[0], curve.mu[-1]) == (0.0, curve.largest)
        for mu in [0.0, 1.0, *rng.uniform(0.0, 1.0, 6)]:
            alone = level(cage.friction(mu))
            assert (curve.sigma_first(mu) or math.inf) == pytest.approx(alone, rel=SAME)


def test_jumps_are_narrow_and_lie_where_single_levels_jump() -> None:
    for cage in cages():
        curve = icage.friction_curve(cage)
        for jump in curve.breakpoints:
            assert 0.0 < jump.mu_above - jump.mu <= 1e-9
            assert level(cage.friction(jump.mu)) == pytest.approx(jump.before, rel=SAME)
            assert level(cage.friction(jump.mu_above)) == pytest.approx(jump.after, rel=SAME)
            assert jump.after < jump.before
        # all that is left between them is small steps
        falls = -np.diff(curve.level) / curve.level[1:]
        wide = np.diff(curve.mu) > 1e-9
        middles = 0.5 * (curve.mu[1:] + curve.mu[:-1])
        for k in np.flatnonzero(wide & (falls > 1e-3)):
            straight = 0.5 * (curve.level[k] + curve.level[k + 1])
            off = abs(level(cage.friction(middles[k])) - straight)
            assert off <= 0.01 * (curve.level[k] - curve.level[k + 1])


def test_mu_max_is_the_curve_read_the_other_way() -> None:
    for cage in cages():
        curve = icage.friction_curve(cage)
        for opening in cage.sigma_0 * np.array([1.0005, 1.01, 1.05, 1.2]):
            most = curve.mu_max(float(opening))
            if most is None:
                assert level(cage.friction(0.0)) <= opening
                continue
            assert level(cage.friction(most)) > opening * (1.0 - SAME)
            if most < curve.largest:
                assert level(cage.friction(most + 2e-9)) <= opening * (1.0 + SAME)


def test_the_fall_of_an_interval_is_a_share_of_its_higher_end() -> None:
    some = plan(TRIANGLE, MIDDLES).friction(0.0)

    def fall(before: float | None, after: float | None) -> float:
        a, b = replace(some, sigma_first=before), replace(some, mu=0.25, sigma_first=after)
        size, low, high, bent = _fall(a, b, 0.125)
        assert (low, high, bent) == (0.0, 0.25, 0.125)
        return -size

    assert fall(2.0, 1.5) == 0.25
    assert fall(2.0, 2.0) == fall(None, None) == 0.0
    assert fall(None, 1.5) == 1.0


def test_a_triangle_may_stop_turned_by_the_cone() -> None:
    cage = plan(TRIANGLE, MIDDLES)
    for mu in (0.005, 0.01, 0.019):
        ends = cage.friction(mu).ends
        assert ends.angle_max == pytest.approx(math.atan(mu), rel=0.0, abs=3e-6)
        assert 0.0 < ends.position_max <= 0.005
    assert cage.friction(0.0).ends == icage.JamEnds(0.0, 0.0)


def test_no_jam_below_the_level_is_beyond_the_ends() -> None:
    for cage in cages():
        for mu in (0.05, 0.4):
            found = cage.friction(mu)
            ends = found.ends
            assert 0.0 <= ends.position_max <= found.tolerance.position
            assert 0.0 <= ends.angle_max <= found.tolerance.angle
            wide = (ends.position_max + 1e-6, ends.angle_max + 1e-6)
            tighter = cage.friction(mu, icage.JamTolerance(*wide))
            assert level(tighter) >= level(found) * (1.0 - SAME)
            # and they are not larger than they have to be
            for position, angle in ((0.9, 1.0), (1.0, 0.9)):
                less = (position * ends.position_max, angle * ends.angle_max)
                lower = cage.friction(mu, icage.JamTolerance(*less))
                small = max(ends.position_max / 0.005, ends.angle_max / 0.02) < 1e-3
                assert small or level(lower) <= level(found) * (1.0 + SAME)


def test_the_nearest_jam_is_a_jam_and_as_far_as_it_says() -> None:
    rng = np.random.default_rng(1)
    for cage in cages():
        ring, radius = Ring.of(cage.outline.vertices), cage.finger_radius
        for _ in range(3):
            row = cage.target_placement.as_array()
            row = row + rng.normal(0.0, 0.01, 4) * [ring.diameter, ring.diameter, 1.0, row[3]]
            distance, jam = icage.nearest_jam(cage, 0.3, row)
            assert jam is not None
            fingers = cage.hand.fingers(row[None])[0]
            far = float(np.hypot(*(jam.contacts - fingers).T).max())
            assert distance == pytest.approx(far, abs=1e-8 * ring.diameter)
            at_target = float(np.hypot(*(cage.contacts - fingers).T).max())
            assert distance <= at_target + 1e-8 * ring.diameter
            if radius:
                left = disc_jams.residual(disc_jams.Curve.of(ring, radius), jam.contacts, 0.3)
            else:
                left = residual(ring, jam.contacts, 0.3, 1e-9 * ring.diameter)
            assert left <= 1e-6


def test_no_sampled_jam_is_nearer() -> None:
    cage = icage.plan(icage.load(CASES / "disc_hammer.json"))
    mu = 0.2
    curve = disc_jams.Curve.of(Ring.of(cage.outline.vertices), cage.finger_radius)
    every = curve.contacts(41, np.empty((0, 2)))
    hand = cage.hand.unit_fingers
    below = cage.sigma_first or math.inf
    hands = disc_jams.two_finger_jams(curve, hand, every, math.atan(mu), below)
    w = hands[:, 1] - hands[:, 0]
    rows = np.column_stack([hands[:, 0], np.arctan2(w[:, 1], w[:, 0]), np.hypot(*w.T)])
    hands = hands[cage.query(rows).verdict == 0]
    assert len(hands) > 40
    rng = np.random.default_rng(2)
    for start in rows[:: len(rows) // 9]:
        row = start + rng.normal(0.0, 0.02, 4)
        fingers = cage.hand.fingers(row[None])[0]
        sampled = np.hypot(*(hands - fingers).transpose(2, 0, 1)).max(axis=1).min()
        distance, _ = icage.nearest_jam(cage, mu, row)
        assert distance <= sampled * (1.0 + 1e-9)


def test_a_jam_is_nearest_to_itself() -> None:
    for cage in cages():
        jam = cage.friction(0.5).jam
        if jam is not None:
            distance, _ = icage.nearest_jam(cage, 0.5, jam.placement)
            assert distance <= 1e-7 * cage.outline.diameter


def test_what_is_no_question_is_refused() -> None:
    cage = plan(TRIANGLE, MIDDLES)
    curve = icage.friction_curve(cage, 0.1)
    with pytest.raises(InputError, match="0 to 0.1"):
        curve.sigma_first(0.2)
    with pytest.raises(InputError, match="opening"):
        curve.mu_max(math.nan)
    with pytest.raises(PlacementError):
        icage.nearest_jam(cage, 0.1, [0.0, 0.0, 0.0])
    assert curve.mu_max(2.0) is None
    assert icage.nearest_jam(cage, 0.0, cage.target_placement) == (math.inf, None)


@pytest.mark.parametrize("largest", [-1, 0, math.nan, "much"])
def test_a_largest_coefficient_is_refused_by_its_own_name(largest: object) -> None:
    with pytest.raises(InputError, match="^largest is "):
        icage.friction_curve(plan(TRIANGLE, MIDDLES), largest)  # type: ignore[arg-type]
