"""Small cases that plan and close in a moment."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

from icage.cage import Cage
from icage.case import Case
from icage.formats.case_json import read_case
from icage.planner import plan
from models import CASES
from tests.sim.grasps import t_shape


def t_case() -> Case:
    """A T held by discs in both corners and on top: no neighbour, a wide cage."""
    grasp = t_shape()
    return Case("T", "mm", grasp.outline, grasp.radius, grasp.contacts)


@functools.cache
def cage_of(name: str) -> Cage:
    """The cage of a solved problem, or of the T with discs."""
    case = t_case() if name == "T" else read_case(CASES / f"{name}.json")
    return plan(case.outline, case.contacts, case.finger_radius)


def write_case(case: Case, path: Path, **changed: Any) -> Path:
    """A case as a file."""
    data = {
        "format": "icage-case/1",
        "name": case.name,
        "unit": case.unit,
        "outline": {"vertices": case.outline.vertices.tolist()},
        "finger_radius": case.finger_radius,
        "grasp": {"contacts": case.contacts.tolist()},
        **changed,
    }
    path.write_text(json.dumps(data))
    return path
