"""The paper's condition on regions: right on one case, wrong on another, never without bound."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from icage.cells.membership import VERDICTS, query
from icage.cells.regions import caging_regions
from icage.formats.case_json import read_case
from icage.paper_condition import sample_condition
from icage.planner import plan
from models import CASES


def test_on_the_t_it_is_right() -> None:
    case = read_case(CASES / "T_best.json")
    report = sample_condition(plan(case.outline, case.contacts), 300, np.random.default_rng(1))
    assert (report.tested, report.in_cage, report.outside) == (300, 300, {})
    assert report.counterexample is None
    assert report.share_right == 1.0


def test_on_the_nine_sided_polygon_it_is_not() -> None:
    """Regions that reach all the way round: a hand beside the object stands in all three."""
    case = read_case(CASES / "ngon9_best.json")
    cage = plan(case.outline, case.contacts)
    report = sample_condition(cage, 400, np.random.default_rng(1))
    assert report.tested == 400
    assert report.in_cage + sum(report.outside.values()) == 400
    assert report.share_right < 0.2
    example = report.counterexample
    assert example is not None
    regions = [r.geometry for r in caging_regions(cage) if r.bound == "outer"]
    for finger, region in zip(cage.hand.fingers(example), regions, strict=True):
        assert region.contains(shapely.Point(finger))
    assert example[3] < cage.sigma_max
    answer = query(cage, example[None])
    assert not answer.in_cage[0]
    assert VERDICTS[int(answer.verdict[0])] in report.outside


def test_the_same_seed_gives_the_same_report() -> None:
    case = read_case(CASES / "L_best.json")
    cage = plan(case.outline, case.contacts)
    first, again = (sample_condition(cage, 50, np.random.default_rng(7)) for _ in range(2))
    assert first.tried == again.tried
    assert first.tested == pytest.approx(50)
