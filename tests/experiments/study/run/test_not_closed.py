"""Starts that collide, are no cage or are far away: recorded where they are."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.study.run.rows import table_of
from tests.experiments.study.run.trials import held, middles, outcomes, planned, run, study


def test_a_start_in_collision_is_recorded_where_it_is():
    deep = held(opening=0.7)
    ran = run(3, nominal=deep)
    assert outcomes(ran) == ["collision"] * 3
    np.testing.assert_allclose(ran.starts, np.tile(deep, (3, 1)), atol=1e-14)
    assert len(ran.done) == 0
    table = table_of(study(nominal=deep), ran).to_pydict()
    assert table["verdict"] == ["collision"] * 3
    assert table["start_sigma"] == pytest.approx([deep[3]] * 3)
    empty = ("end_x", "peak_force", "penetration_max", "steps", "position_error", "angle_error")
    for name in empty:
        assert table[name] == [None] * 3
    assert table["grasp_id"] == [-1] * 3
    skipped = run(3, nominal=deep, uncaged="skip")
    assert outcomes(skipped) == ["collision"] * 3


def test_a_hand_smaller_than_shut_is_in_collision():
    ran = run(2, vary={"place_sigma": -9.0})
    assert outcomes(ran) == ["collision"] * 2
    assert (ran.starts[:, 3] < 0.0).all()


def test_some_starts_collide_and_the_others_are_closed():
    """Noise takes some fingers into the object: those are named, none is drawn again."""
    ran = run(40, vary={"place_xy": "normal:8%"})
    hit = np.array(outcomes(ran)) == "collision"
    assert 4 < hit.sum() < 36
    assert ran.done.tolist() == np.flatnonzero(~hit).tolist()
    assert (np.array(outcomes(ran))[~hit] != "collision").all()
    off = middles(planned("T").hand, ran.starts) - middles(planned("T").hand, ran.meant)
    drawn = np.column_stack([ran.values["place_x"], ran.values["place_y"]])
    np.testing.assert_allclose(off, drawn, atol=1e-12)


def test_uncaged_starts_are_closed_or_skipped_as_asked():
    wide = held(opening=2.2)
    assert wide[3] > planned("T").sigma_max
    for uncaged, closed in (("close", 3), ("skip", 0)):
        ran = run(3, nominal=wide, uncaged=uncaged)
        assert not ran.answers.in_cage.any()
        assert len(ran.done) == closed
        assert set(outcomes(ran)) == ({"not_caged"} if uncaged == "skip" else {"target"})


def test_a_hand_far_away_has_let_the_object_escape():
    far = [40.0, 0.0, 0.2, 2.0]
    assert outcomes(run(2, nominal=far)) == ["escaped"] * 2
