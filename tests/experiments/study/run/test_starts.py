"""Where the hand stands when a trial begins, and where it was meant to stand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely

import icage
from experiments.study.inputs.placements import BLOCK, Intended, moved
from experiments.study.inputs.variables import VARIABLES
from icage.arrays import FloatArray
from icage.cells.membership import TARGET, query
from tests.experiments.study.run.trials import case_of, outcomes, planned, run, study


def errors_at(rows: FloatArray, **errors: Any) -> tuple[FloatArray, FloatArray]:
    """Fingers (n, 3, 2) of intended placements, and of the ones with these errors."""
    cage = planned("T")
    values = {name: np.full(len(rows), one.nominal) for name, one in VARIABLES.items()}
    values |= {name: np.broadcast_to(value, len(rows)) for name, value in errors.items()}
    true = moved(rows, values, cage, np.full(len(rows), complex(cage.hand.z.mean())))
    return cage.hand.fingers(rows), cage.hand.fingers(true)


@pytest.fixture
def rows() -> FloatArray:
    return np.random.default_rng(1).uniform([-3, -3, -4, 0.2], [3, 3, 4, 3], (20, 4))


def test_frictionless_guaranteed_starts_all_reach_the_target():
    for name in ("T", "L"):
        ran = run(30, name)
        assert outcomes(ran) == ["target"] * 30
        assert ran.errors[:, 0].max() <= 1e-4
        assert ran.errors[:, 1].max() <= 1e-3
        assert (ran.answers.verdict == TARGET).all()
        np.testing.assert_allclose(ran.starts, ran.meant, atol=1e-14)
        assert (ran.grasp_id == planned(name).grasps[0].id).all()


def test_no_error_moves_nothing(rows: FloatArray):
    meant, true = errors_at(rows)
    np.testing.assert_allclose(true, meant, atol=1e-14)


def test_place_noise_moves_the_middle(rows: FloatArray):
    x, y = np.random.default_rng(2).normal(0.0, 0.3, (2, len(rows)))
    meant, true = errors_at(rows, place_x=x, place_y=y)
    np.testing.assert_allclose(true - meant, np.column_stack([x, y])[:, None] + np.zeros((3, 1)),
                               atol=1e-13)  # fmt: skip


def test_place_noise_turns_about_the_middle_and_opens_about_it(rows: FloatArray):
    rng = np.random.default_rng(3)
    turn, wider = rng.normal(0.0, 0.4, len(rows)), rng.uniform(0.0, 0.5, len(rows))
    meant, true = errors_at(rows, place_theta=turn, place_sigma=wider)
    about = meant.mean(axis=1, keepdims=True)
    np.testing.assert_allclose(true.mean(axis=1, keepdims=True), about, atol=1e-13)
    arms = (meant - about) @ np.array([1.0, 1j])
    seen = (true - about) @ np.array([1.0, 1j])
    expected = arms * (np.exp(1j * turn) * (1.0 + wider / rows[:, 3]))[:, None]
    np.testing.assert_allclose(seen, expected, atol=1e-13)


def test_the_hand_is_right_for_the_object_as_it_was_seen(rows: FloatArray):
    """The true object, moved by the bias (turned about its centroid, then shifted), is the object
    that was seen; from there the hand stands where it was meant to.
    """
    rng = np.random.default_rng(4)
    x, y, turn = rng.normal(0.0, 0.3, (3, len(rows)))
    meant, true = errors_at(rows, bias_x=x, bias_y=y, bias_theta=turn)
    centre = case_of("T").outline.centroid
    for i in range(len(rows)):
        cos, sin = np.cos(turn[i]), np.sin(turn[i])
        rotation = np.array([[cos, -sin], [sin, cos]])
        back = (true[i] - centre - [x[i], y[i]]) @ rotation + centre  # in the seen object's axes
        np.testing.assert_allclose(back, meant[i], atol=1e-13)


def test_intended_placements_hang_on_their_number_only():
    for starts in ("guaranteed", "cage"):
        one = study(starts=starts)
        numbers = np.arange(BLOCK - 3, BLOCK + 3)
        streams = np.array([0, 1, 0, 1, 0, 1])
        whole = one.intended.placements(numbers, streams)
        again = Intended(one.config, one.cage)
        back = [again.placements(numbers[k : k + 1], streams[k : k + 1]) for k in range(6)[::-1]]
        assert np.concatenate(back[::-1]).tobytes() == whole.tobytes()
        assert len(np.unique(whole[:, 0])) == 6
        assert query(one.cage, whole).in_cage.all()


def test_the_best_placement_has_the_most_room():
    one = study(vary={"place_xy": "normal:1%"}, place="best")
    (best,) = one.intended.placements(np.array([3]), np.array([0]))
    found = icage.place(one.cage, opening_error=True)
    assert best.tobytes() == found.placement.as_array().tobytes()
    roomy = study(vary={"place_xy": "normal:1%"}).intended.nominal
    away = shapely.distance(
        shapely.points(one.cage.hand.fingers(np.array([best, roomy]))), one.cage.outline.polygon
    ).min(axis=1)
    margin = one.cage.sigma_first - np.array([best[3], roomy[3]])
    z = one.cage.hand.z
    around = shapely.minimum_bounding_radius(shapely.MultiPoint(np.column_stack([z.real, z.imag])))
    room = np.minimum(away - one.cage.finger_radius, around * margin)
    assert room[0] == pytest.approx(found.tolerance, rel=1e-6)
    assert room[1] < room[0]


def test_the_nominal_placement_has_room():
    one = study(vary={"place_xy": "normal:1%"})
    (nominal,) = one.intended.placements(np.array([3]), np.array([0]))
    answers = query(one.cage, nominal[None, :])
    assert answers.verdict[0] == TARGET
    assert answers.target_margin[0] > 0.2 * (one.cage.sigma_first - one.cage.sigma_0)
    assert nominal.tobytes() == study(vary={"place_x": 0.0}).intended.nominal.tobytes()
