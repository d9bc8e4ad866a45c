"""Tilt, friction and the centre of mass as one trial has them."""

from __future__ import annotations

import numpy as np

from experiments.study.inputs.variables import VARIABLES
from experiments.study.run.shard import run_trials
from experiments.study.run.worlds import worlds_of
from tests.experiments.study.run.trials import held, middles, outcomes, run, study

DRIVE, DAMPING = 900.0, 300.0
"""Of ``SimConfig``: the closing force and the object's damping."""


def test_downhill_is_told_in_the_objects_axes():
    """A hand wide open and slow: seen from the object, the hand drifts uphill."""
    start = held(opening=6.0)
    directions = (0.0, 70.0, 200.0)
    vary = {
        "tilt": "30deg", "weight": "10%", "speed": 0.02, "mass": "grid:1,2",
        "tilt_direction": "grid:" + ",".join(f"{a}deg" for a in directions),
        "place_theta": 0.5,
    }  # fmt: skip
    time = 0.1
    one = study(nominal=start, vary=vary, max_time=0.02 * time)  # slower hands have longer
    ran = run_trials(one, np.arange(6))
    assert set(outcomes(ran)) == {"timed_out"}
    before = middles(one.cage.hand, ran.starts)
    drift = middles(one.cage.hand, ran.closings.closings.end) - before
    speed = 0.1 * np.sin(np.pi / 6.0) * DRIVE / DAMPING * one.case.outline.diameter
    angle = ran.values["tilt_direction"]
    mass = ran.values["mass"]
    late = time - mass / DAMPING  # it takes this long to get going
    expected = -late * speed * mass * np.array([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(drift, expected.T, rtol=0.01, atol=1e-3 * np.abs(expected).max())


def test_what_friction_holds_is_jammed_and_never_unmatched():
    """High friction on the L: it stops where no frictionless object could."""
    ran = run(40, "L", vary={"friction": "grid:0,0.9"}, max_time=3.0)
    words = np.array(outcomes(ran))
    rough = ran.values["friction"] > 0.0
    assert set(words[~rough]) == {"target"}
    assert "jammed" in words[rough]
    assert "unmatched" not in words
    assert (ran.grasp_id[words == "jammed"] == -1).all()
    stuck = run(4, vary={"table_friction": 1.0})
    assert set(outcomes(stuck)) == {"jammed"}


def test_the_centre_of_mass_is_off_by_a_length_of_the_true_object():
    """Twice as large, an offset of the same length is half as many diameters."""
    values = {name: np.full(2, one.nominal) for name, one in VARIABLES.items()}
    values["com_x"][:] = 0.3
    worlds = worlds_of(values, np.zeros((2, 4)), np.array([2.0, 4.0]))
    assert worlds.com_x.tolist() == [0.15, 0.075]
