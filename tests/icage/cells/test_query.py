"""What the verdicts mean, and how they hang together."""

from __future__ import annotations

import numpy as np
import pytest

from icage.cells.membership import VERDICTS, query
from models import CASES
from tests.icage.cells.wandering import solved, wander

NAMES = sorted(path.stem for path in CASES.glob("*.json"))
CAGES = [name for name in NAMES if "not_a_cage" not in name and "notcage" not in name]
SOME = [
    "T_best",
    "cross_multi",
    "hook_deep_multi",
    "never_escapes_b",
    "disc_hammer",
    "handsaw_best",
]


def verdicts(name: str, placements: np.ndarray) -> list[str]:
    return [VERDICTS[v] for v in query(solved(name).cage, placements).verdict]


@pytest.mark.parametrize("name", NAMES)
def test_the_plans_own_grasps_never_collide(name: str) -> None:
    cage = solved(name).cage
    if not cage.grasps:
        return
    rows = np.array([g.placement.as_array() for g in cage.grasps])
    answers = query(cage, rows)
    for k, grasp in enumerate(cage.grasps):
        assert VERDICTS[answers.verdict[k]] in ("target", "caged", "other")
        assert answers.in_cage[k]
        assert grasp.id in answers.grasps_of(k)
    assert VERDICTS[answers.verdict[0]] == "target"
    assert answers.grasps_of(0) == (0,)


@pytest.mark.parametrize("name", CAGES)
def test_fields_agree_with_the_verdict(name: str) -> None:
    cage = solved(name).cage
    rng = np.random.default_rng(3)
    inside = wander(cage, ("target", "caged", "other"), rng, 60)
    noise = rng.normal(size=(300, 4)) * np.array([1.0, 1.0, 2.0, 0.3]) * cage.sigma_0
    around = cage.target_placement.as_array() + noise
    around[:, 3] = np.abs(around[:, 3])
    rows = np.vstack([inside, around])
    answers = query(cage, rows)
    first = np.inf if cage.sigma_first is None else cage.sigma_first
    last = np.inf if cage.sigma_max is None else cage.sigma_max
    assert (answers.sigma == rows[:, 3]).all()
    for k in range(len(rows)):
        verdict, ids = VERDICTS[answers.verdict[k]], answers.grasps_of(k)
        sigma, margin = rows[k, 3], answers.margin[k]
        if verdict in ("escapes", "collision"):
            assert margin == 0.0
            assert ids == ()
            assert not answers.in_cage[k]
            continue
        assert np.isnan(margin) or margin > 0.0
        if verdict == "target":
            assert ids == (0,)
            assert sigma < first
        elif verdict == "caged":
            assert 0 in ids
            assert first <= sigma * (1.0 + 1e-9)
            assert sigma < last
        else:
            assert 0 not in ids
        if verdict in ("target", "caged"):
            assert answers.in_cage[k]
            assert np.isnan(margin) if np.isinf(last) else margin == pytest.approx(last - sigma)
        has_target_margin = verdict == "target" and np.isfinite(first)
        assert np.isnan(answers.target_margin[k]) != has_target_margin
        if has_target_margin:
            assert answers.target_margin[k] == pytest.approx(first - sigma)


@pytest.mark.parametrize("name", SOME)
def test_collision_is_the_true_object(name: str) -> None:
    """Also with discs: judged on the true offset, from both sides of 1e-9 of the diameter."""
    case = solved(name)
    rng = np.random.default_rng(4)
    noise = rng.normal(size=(600, 4)) * np.array([0.5, 0.5, 1.0, 0.3]) * case.cage.sigma_0
    rows = case.cage.target_placement.as_array() + noise
    rows[:, 3] = np.abs(rows[:, 3])
    told = [v == "collision" for v in verdicts(name, rows)]
    fingers = case.cage.hand.fingers(rows)
    depth = [max(case.ring.depth(p, case.cage.finger_radius) for p in row) for row in fingers]
    assert told == [d > 1e-9 * case.ring.diameter for d in depth]
    assert 50 < sum(told) < 590


@pytest.mark.parametrize("name", SOME)
def test_opening_inside_a_component_keeps_the_order_of_verdicts(name: str) -> None:
    """A hand that opens without touching goes target, caged, escapes; it never gets safer."""
    case = solved(name)
    cage = case.cage
    rank = {"other": 0, "target": 0, "caged": 1, "escapes": 2}
    starts = wander(cage, ("target",), np.random.default_rng(5), 40)
    for start in starts:
        rows = np.repeat(start[None], 30, axis=0)
        rows[:, 3] = start[3] * np.linspace(1.0, 2.0, 30)
        told = verdicts(name, rows)
        free = told.index("collision") if "collision" in told else len(told)
        ranks = [rank[v] for v in told[:free]]
        assert ranks == sorted(ranks)


@pytest.mark.parametrize("name", SOME)
def test_order_and_batches_do_not_matter(name: str) -> None:
    cage = solved(name).cage
    rng = np.random.default_rng(6)
    noise = rng.normal(size=(400, 4)) * np.array([0.7, 0.7, 2.0, 0.3]) * cage.sigma_0
    rows = cage.target_placement.as_array() + noise
    rows[:, 3] = np.abs(rows[:, 3])
    whole = query(cage, rows)
    order = rng.permutation(len(rows))
    shuffled = query(cage, rows[order])
    assert (whole.verdict[order] == shuffled.verdict).all()
    np.testing.assert_allclose(whole.margin[order], shuffled.margin, rtol=1e-9)
    one = query(cage, rows[:1])
    assert one.verdict[0] == whole.verdict[0]


@pytest.mark.parametrize("name", SOME)
def test_full_turns_of_theta_do_not_matter(name: str) -> None:
    cage = solved(name).cage
    rows = wander(cage, ("target", "caged", "other"), np.random.default_rng(7), 50)
    turned = rows + np.array([0.0, 0.0, 2.0 * np.pi, 0.0])
    assert (query(cage, rows).verdict == query(cage, turned).verdict).all()
