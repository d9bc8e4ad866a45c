"""Laws of what a plan answers, which hold for any object: placements, regions, documents."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

from icage.cage import Cage
from icage.cells.membership import VERDICTS, query
from icage.cells.regions import FingerRegion, caging_regions, outer_bounds
from icage.formats.case_json import parse_case
from icage.formats.json_out import json_text
from icage.formats.plan_json import plan_document, plan_summary
from icage.formats.query_json import query_document
from tests.zoo.shapes import VALID
from tests.zoo.specimens import MOST_VERTICES, Specimen, case_of, specimen


def _query(one: Specimen) -> None:
    for cage in one.cages:
        rows = np.array([g.placement.as_array() for g in cage.grasps])
        answers = query(cage, rows)
        told = [VERDICTS[v] for v in answers.verdict]
        nothing = cage.wedge is not None and cage.wedge.sigma <= cage.sigma_0
        assert told[0] == ("caged" if nothing else "target")  # by an exact fit only
        assert set(told) <= {"target", "caged", "other"}
        assert answers.in_cage.all()
        for k, grasp in enumerate(cage.grasps):
            assert grasp.id in answers.grasps_of(k)
        far = rows[:1] + [10.0 * one.size, 0.0, 0.0, 0.0]
        assert VERDICTS[query(cage, far).verdict[0]] == "escapes"
        inside = one.outline.polygon.representative_point()
        deep = np.array([[inside.x, inside.y, 0.0, cage.sigma_0]])
        assert VERDICTS[query(cage, deep).verdict[0]] == "collision"


def _query_document(one: Specimen) -> None:
    for cage in one.cages:
        rows = np.array([g.placement.as_array() for g in cage.grasps])
        document = json.loads(json_text(query_document(query(cage, rows))))
        assert document["format"] == "icage-query/1"
        assert len(document["results"]) == len(rows)


@cache
def regions_of(one: Specimen) -> list[tuple[Cage, tuple[FingerRegion, ...]]]:
    """Rough ones, once for all laws; of discs (arcs of many vertices) on small shapes alone."""
    cages = one.cages if len(one.ring) <= MOST_VERTICES else [one.cage]
    return [(cage, caging_regions(cage, gap=0.1)) for cage in cages]


def _regions(one: Specimen) -> None:
    """Those of the points and of the discs hold the fingers of every grasp in the cage."""
    for cage, regions in regions_of(one):
        outer = [r.geometry for r in regions if r.bound == "outer"]
        inner = [r.geometry for r in regions if r.bound == "inner"]
        alone = outer_bounds(cage, gap=0.1)
        assert len(outer) == len(inner) == len(alone) == len(cage.contacts)
        for grasp in cage.grasps:
            # the true grasps of discs lie a sagitta off the polygon that was searched
            slack = 2e-8 * one.size + (0.0 if cage.work is None else 4.0 * cage.work.sagitta)
            for region, bound, p in zip(outer, alone, grasp.contacts, strict=True):
                assert region.distance(shapely.Point(p)) <= slack
                assert bound.distance(shapely.Point(p)) <= slack
        for low, high in zip(inner, outer, strict=True):
            assert low.difference(high.buffer(1e-8 * one.size)).area <= 1e-7 * high.area
            assert low.area > 0.0


def _plan_document(one: Specimen) -> None:
    for cage, regions in [*regions_of(one), *((cage, ()) for cage in one.cages[1:])]:
        document = json.loads(json_text(plan_document(cage, regions, one.shape.name, "mm")))
        assert document["format"] == "icage-plan/1"
        assert document["sigma_max"] == cage.sigma_max
        assert document["grasps"][0]["contacts"] == np.asarray(cage.grasps[0].contacts).tolist()
        assert len(document["regions"]) == len(regions)
        assert any(line.startswith("sigma_0") for line in plan_summary(cage, "zoo", "mm"))


def _case_document(one: Specimen) -> None:
    """Out to a case file's text and in again: the same numbers and so the same answer."""
    for cage in one.cages:
        text = json.dumps(case_of(one.outline.vertices.tolist(), cage.contacts.tolist(),
                                  cage.finger_radius))  # fmt: skip
        case = parse_case(json.loads(text), Path())
        assert case.outline.vertices.tobytes() == one.outline.vertices.tobytes()
        assert case.contacts.tolist() == cage.contacts.tolist()


LAWS: dict[str, Callable[[Specimen], None]] = {
    "query": _query,
    "query document": _query_document,
    "caging_regions": _regions,
    "plan document": _plan_document,
    "case document": _case_document,
}
"""A new function is one line: its name and a check of one specimen."""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [shape.name for shape in VALID])
def test_law(name: str, law: str) -> None:
    LAWS[law](specimen(name))
