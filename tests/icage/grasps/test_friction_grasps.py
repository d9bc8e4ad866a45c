"""Grasps ranked by what friction leaves of the guarantee, against a dense enumeration."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from icage import Case, InputError, Outline, plan
from icage.cage import Cage
from icage.grasps.of_case import best_of_case
from icage.grasps.search import ranked_grasps
from icage.grasps.wanted import ANY_HAND, Wanted
from tests.icage.grasps.small_outlines import SMALL
from tests.oracles.geometry import Ring
from tests.oracles.grasps import grid_grasps

MUS = (0.05, 0.3)
SOME = ("dart", "notched", "arrow", "hour glass", "slit", "L")


@cache
def of_grid(name: str) -> tuple[Cage, ...]:
    """Two fingers on one edge are not searched (docs/decisions/0010), and not compared here."""
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    cages = [plan(outline, contacts) for _, contacts in grid_grasps(ring, 20)]
    return tuple(cage for cage in cages if cage.status != "not_a_cage")


@cache
def best(name: str, mu: float) -> tuple[Cage, ...]:
    wanted = Wanted("friction", limits=ANY_HAND, mu=mu)
    case = Case(name, "m", Outline(SMALL[name]))
    return best_of_case(case, 6, wanted, np.random.default_rng(0)).cages


def kept(cage: Cage, mu: float) -> float:
    """sigma_first(mu) / sigma_0."""
    level = cage.friction(mu).sigma_first
    level = cage.sigma_largest if level is None else level
    assert level is not None
    return level / cage.sigma_0


@pytest.mark.parametrize("mu", MUS)
@pytest.mark.parametrize("name", SOME)
def test_no_grasp_of_a_dense_grid_keeps_more(name: str, mu: float) -> None:
    most = max(kept(cage, mu) for cage in of_grid(name))
    assert kept(best(name, mu)[0], mu) >= most * (1.0 - 1e-6)


@pytest.mark.parametrize("mu", MUS)
@pytest.mark.parametrize("name", SOME)
def test_grasps_are_listed_by_what_friction_leaves(name: str, mu: float) -> None:
    ratios = [kept(cage, mu) for cage in best(name, mu)]
    assert ratios == sorted(ratios, reverse=True)
    assert all(r >= 1.0 for r in ratios)


def test_friction_changes_which_grasp_is_best() -> None:
    """Else this aim would be the other one."""
    frictionless = best_of_case(
        Case("dart", "m", Outline(SMALL["dart"])), 1, Wanted(limits=ANY_HAND),
        np.random.default_rng(0),
    ).cages[0]  # fmt: skip
    changed = [
        kept(best(name, mu)[0], mu) > kept(_first(name), mu) * 1.001
        for name in SOME for mu in MUS
    ]  # fmt: skip
    assert kept(frictionless, 0.05) <= kept(best("dart", 0.05)[0], 0.05) * (1.0 + 1e-9)
    assert sum(changed) >= 3


@cache
def _first(name: str) -> Cage:
    case = Case(name, "m", Outline(SMALL[name]))
    return best_of_case(case, 1, Wanted(limits=ANY_HAND), np.random.default_rng(0)).cages[0]


def test_threads_change_nothing() -> None:
    outline = Outline(SMALL["slit"])
    wanted = Wanted("friction", limits=ANY_HAND, mu=0.2)
    one, two = (
        ranked_grasps(outline, wanted=wanted, rng=np.random.default_rng(1), workers=workers)
        for workers in (1, 2)
    )
    assert [c.score for c in one.candidates] == [c.score for c in two.candidates]
    assert one.unplanned == two.unplanned == 0


def test_a_score_is_that_of_the_plan() -> None:
    outline = Outline(SMALL["hour glass"])
    wanted = Wanted("friction", limits=ANY_HAND, mu=0.1)
    found = ranked_grasps(outline, wanted=wanted, rng=np.random.default_rng(1))
    for candidate in found.candidates[:10]:
        assert kept(plan(outline, candidate.contacts), 0.1) == pytest.approx(
            candidate.score, rel=1e-9
        )


def test_from_python() -> None:
    (grasp,) = Case("L", "m", Outline(SMALL["L"])).grasps(1, aim="friction", mu=0.1)
    assert grasp.score == pytest.approx(kept(plan(SMALL["L"], grasp), 0.1), rel=1e-9)


@pytest.mark.parametrize(
    ("aim", "mu", "words"),
    [
        ("friction", None, "needs mu"),
        ("first", 0.1, "goes with the aim 'friction' only"),
        ("friction", 0.0, "more than 0"),
        ("friction", -1.0, "more than 0"),
        ("friction", float("nan"), "mu"),
        ("rub", 0.1, "one of first, cage, friction"),
    ],
)
def test_an_aim_and_a_mu_that_do_not_fit_are_refused(aim: str, mu: float, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Case("L", "m", Outline(SMALL["L"])).grasps(1, aim=aim, mu=mu)  # type: ignore[arg-type]
