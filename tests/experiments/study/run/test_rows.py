"""Rows of a study's table: the same alone and in company, and whole."""

from __future__ import annotations

import json

import numpy as np
import pytest

from experiments.study.inputs.config import ConfigError
from experiments.study.run.document import study_document, study_of
from experiments.study.run.rows import table_of
from experiments.study.run.shard import Study, run_trials
from icage import sampling
from icage.errors import InputError
from tests.experiments.study.run.trials import outcomes, study

MUCH = {
    "place_xy": "normal:2%", "place_theta": "normal:3deg", "bias_theta": "normal:2deg",
    "friction": "truncated:0.1:0.2:0:0.6", "softness": "1:5", "table_friction": "0:0.1",
    "tilt": "0:10deg", "mass": "0.5:2", "inertia": "0.5:2", "com_x": "normal:2%",
    "speed": "0.5:2", "force": "0.5:2",
}  # fmt: skip
SHAPES = {
    "outline_scale": "truncated:1:0.01:0.9:1.1",
    "outline_noise": "0:1%",
    "finger_radius": "-0.5%:0.5%",
    "phi_1": "normal:1deg",
    "linkage_play": "grid:0,0.1%",
}


@pytest.mark.parametrize(
    ("vary", "sampling", "count"),
    [
        (MUCH, "random", 25),
        ({**MUCH, **SHAPES}, "sobol", 14),
        ({"outline_scale": "grid:1,1.01", "friction": "0:0.8"}, "random", 14),
        ({"outline_noise": "1%", "friction": "0:0.4"}, "saltelli", 15),
    ],
    ids=["worlds", "shapes", "one other shape", "saltelli"],
)
def test_a_row_is_the_same_alone_and_in_company(vary: dict[str, str], sampling: str, count: int):
    one = study(vary=vary, sampling=sampling, starts="cage", max_time=1.5)
    whole = table_of(one, run_trials(one, np.arange(count)))
    assert whole.num_rows == count
    assert len(set(whole["outcome"].to_pylist())) > 1
    for first, last in ((0, 1), (7, 8), (count - 1, count), (3, 9)):
        fresh = Study(one.config, one.case, one.cage)
        part = table_of(fresh, run_trials(fresh, np.arange(first, last)))
        assert part.schema == whole.schema
        assert part.equals(whole.slice(first, last - first)), (first, last)


def test_a_row_of_the_table_holds_the_trial():
    one = study(vary={"friction": "0:0.5", "place_x": "normal:1%"}, seed=9)
    ran = run_trials(one, np.arange(5, 12))
    table = table_of(one, ran)
    rows = table.to_pydict()
    assert rows["trial"] == list(range(5, 12))
    assert set(rows["seed"]) == {9}
    assert rows["friction"] == ran.values["friction"].tolist()
    assert "mass" not in rows  # it did not vary
    closings = ran.closings.closings
    assert rows["steps"] == closings.steps.tolist()
    assert rows["end_theta"] == closings.end[:, 2].tolist()
    assert rows["outcome"] == outcomes(ran)
    size = one.case.outline.diameter
    assert rows["penetration_max"] == pytest.approx((closings.penetration_max * size).tolist())
    assert rows["position_error"] == pytest.approx((ran.errors[:, 0] * size).tolist())


def test_a_study_read_from_its_document_runs_the_same_trials():
    one = study(vary={**MUCH, **SHAPES}, seed=3, max_time=1.0)
    again = study_of(json.loads(json.dumps(study_document(one))))
    assert again.config == one.config
    rows = [table_of(s, run_trials(s, np.arange(4))) for s in (one, again)]
    assert rows[0].equals(rows[1])


@pytest.mark.parametrize(
    ("radius", "contacts", "words"),
    [
        (0.0, [[0.5, 1.0], [0.1, 3.4], [-0.5, 1.0]], "a study's case has discs"),
        (0.1, [[0.6, 1.9], [0.1, 3.5], [-0.6, 1.2]], "is not a cage: no equilibrium"),
    ],
    ids=["points", "no cage"],
)
def test_a_document_of_what_is_no_cage_is_refused(radius: float, contacts: object, words: str):
    document = json.loads(json.dumps(study_document(study())))
    document["case"] |= {"finger_radius": radius, "contacts": contacts}
    with pytest.raises(InputError, match=words):
        study_of(document)


def test_a_set_too_small_to_draw_from_is_refused(monkeypatch: pytest.MonkeyPatch):
    """Where the intended placement is looked for there, and where all of them are drawn."""
    drawn = study(starts="cage")
    monkeypatch.setattr(sampling, "TRIES_PER_START", 0)
    with pytest.raises(ConfigError, match="too small to draw from: 0 of .* is needed"):
        study(starts="nominal")
    with pytest.raises(ConfigError, match="too small to draw from: 0 of .* is needed"):
        run_trials(drawn, np.arange(2))
