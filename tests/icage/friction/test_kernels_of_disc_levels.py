"""Bounds of choices and the least of them: what the kernels of disc jams promise each other."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from icage.cells.work import work_of
from icage.friction.disc_jams import NO_GOAL, DiscJams
from icage.friction.jam import JamTolerance
from icage.friction.jam_search import JamSearch
from icage.friction.kernels import disc_jams as module
from icage.friction.kernels.disc_features import ARC
from icage.friction.kernels.disc_jams import Choices, bounds_of, least_disc_jam
from icage.friction.kernels.far import Near
from icage.friction.kernels.goal import Goal
from icage.friction.kernels.jams import LeastJam
from icage.planner import plan
from tests.icage.friction.flat_polygons import fingers_of
from tests.oracles.geometry import Floats

pytestmark = pytest.mark.usefixtures("plain")


@cache
def searched() -> tuple[JamSearch, DiscJams]:
    """Three discs of a tenth round a triangle whose sides are one long."""
    inner, radius = 0.75**0.5 / 3.0, 0.1
    way = np.array([[0.0, -1.0], [0.75**0.5, 0.5], [-(0.75**0.5), 0.5]])
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.75**0.5]])
    cage = plan(corners, [0.5, inner] + (inner + radius) * way, radius)
    work = work_of(cage)
    assert work is not None
    search = JamSearch(cage, work)
    assert search._discs is not None
    return search, search._discs


def bounds(mu: float, near: Near, goal: Goal, below: float, choices: Choices) -> Floats:
    _, d = searched()
    return bounds_of(d.pieces, d.z, d.cells, d.contacts, d.subsets, choices, near, goal,
                     math.atan(mu), below, d._thick)  # fmt: skip


def least(
    mu: float, near: Near, goal: Goal, below: float, bound: Floats, order: Floats | None = None
) -> LeastJam:
    _, d = searched()
    order = np.argsort(bound, kind="stable") if order is None else order
    return least_disc_jam(d.pieces, d.z, d.cells, d.contacts, d.subsets, d.choices, bound, order,
                          near, goal, math.atan(mu), below, d._thick)  # fmt: skip


def sigma_of(jam: LeastJam) -> float:
    return float(np.hypot(*jam.hand[2:]))


def curved(bound: Floats) -> list[int]:
    """The choices that are bounded and have a finger on an arc."""
    _, d = searched()
    count = d.subsets.sum(axis=1)[d.choices.subset]
    kinds = [d.contacts.kind[c[:n]] for c, n in zip(d.choices.chosen, count, strict=True)]
    return [k for k in np.flatnonzero(np.isfinite(bound)).tolist() if (kinds[k] == ARC).any()]


def test_bounds_are_no_lower_than_those_for_more_friction() -> None:
    search, d = searched()
    near = search.near(JamTolerance())
    choices = Choices(*(column[::3] for column in d.choices))
    before, count = choices.bound, len(choices.bound)
    for mu in (0.8, 0.3):
        found = bounds(mu, near, NO_GOAL, np.inf, choices)
        assert (found >= before - 1e-12).all()
        before = found
    # what was known already is kept, and what is known to be too high is not looked at
    known = choices._replace(bound=np.where(np.arange(count) % 2, 2.0, choices.bound))
    again = bounds(mu, near, NO_GOAL, np.inf, known)
    assert again[::2].tolist() == found[::2].tolist()
    assert (again[1::2] >= 2.0).all()
    level = float(np.median(found[np.isfinite(found)]))
    few = bounds(mu, near, NO_GOAL, level, choices)
    assert few[found < level] == pytest.approx(found[found < level])
    assert (few[choices.bound >= level] == np.inf).all()
    assert (few >= found - 1e-12).all()


def test_the_least_jam_is_the_least_of_single_choices() -> None:
    search, d = searched()
    near, mu = search.near(JamTolerance()), 0.3
    bound = bounds(mu, near, NO_GOAL, d.known, d.choices)
    found = least(mu, near, NO_GOAL, d.known, bound)
    order = np.argsort(bound, kind="stable")
    alone = [least(mu, near, NO_GOAL, d.known, bound, order[k : k + 1]) for k in range(8)]
    assert found.sigma == min(one.sigma for one in alone) < alone[1].sigma
    assert found.touches.tolist() == alone[0].touches.tolist()
    assert found.hand.tolist() == alone[0].hand.tolist()
    for one, k in zip(alone, order[:8], strict=True):
        assert one.sigma >= bound[k]
        if one.sigma < np.inf:
            assert sigma_of(one) == pytest.approx(one.sigma, rel=1e-6)
            assert one.touches.tolist() == d.subsets[d.choices.subset[k]].tolist()
    # whichever comes first
    others = np.array([order[3], order[0], order[1]])
    assert least(mu, near, NO_GOAL, d.known, bound, others).sigma >= found.sigma


def test_a_level_that_is_only_bounded_has_the_hand_of_its_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Parts of arcs that cannot lower a level by much are not halved: their bound is the level."""
    search, d = searched()
    near, mu = search.near(JamTolerance()), 0.8
    bound = bounds(mu, near, NO_GOAL, np.inf, d.choices)
    for k in curved(bound)[:6]:
        one = np.array([k])
        with monkeypatch.context() as patch:
            exact = least(mu, near, NO_GOAL, np.inf, bound, one)
            patch.setattr(module, "_GAP", 1e-6)
            patch.setattr(module, "_DOUBLED", 1.0)  # soon everything is too little to look at
            rough = least(mu, near, NO_GOAL, exact.sigma * (1.0 + 1e-4), bound, one)
        assert exact.sigma * (1.0 - 5e-3) < rough.sigma < exact.sigma
        assert sigma_of(rough) == pytest.approx(rough.sigma, rel=1e-3)
        assert rough.touches.tolist() == exact.touches.tolist()


def test_a_jam_is_its_own_nearest_and_from_beside_it_none_is_further() -> None:
    search, d = searched()
    near, every, mu = search.near(JamTolerance()), search.within(0.0, 0.0), 0.3
    jam = least(mu, near, NO_GOAL, d.known, bounds(mu, near, NO_GOAL, d.known, d.choices))
    hand = fingers_of(jam.hand[None], d.z)[0]
    for off in (np.zeros(4), np.array([0.01, -0.004, 0.007, 0.02])):
        fingers = fingers_of((jam.hand + off)[None], d.z)[0]
        goal = Goal(np.column_stack([fingers.real, fingers.imag]), d.known, True)
        towards = bounds(mu, every, goal, np.inf, d.choices)
        found = least(mu, every, goal, np.inf, towards)
        assert found.sigma <= np.abs(fingers - hand).max() + 1e-6
        assert found.sigma >= towards.min()
        told = fingers_of(found.hand[None], d.z)[0]
        assert np.abs(told - fingers).max() == pytest.approx(found.sigma, abs=1e-6)
        assert sigma_of(found) <= d.known * (1.0 + 1e-9)
    # no hand of more than ``most`` counts, however near
    small = goal._replace(most=0.98 * sigma_of(found))
    nearer = np.argsort(towards, kind="stable")[:12]
    further = least(mu, every, small, np.inf, towards, nearer)
    assert further.sigma > found.sigma
    assert further.sigma == np.inf or sigma_of(further) <= small.most * (1.0 + 1e-6)
