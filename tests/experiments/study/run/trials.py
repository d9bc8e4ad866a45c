"""Trials of small studies, run in this process, and what became of them."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from experiments.study.inputs.config import study_config
from experiments.study.run.shard import STUDY_OUTCOMES, Ran, Study, run_trials
from icage.arrays import FloatArray
from icage.cage import Cage
from icage.case import Case
from icage.formats.case_json import read_case
from icage.hand import HandShape
from icage.planner import plan
from models import case_paths
from tests.experiments.small import cage_of, t_case
from tests.sim.grasps import l_shape


@functools.cache
def case_of(name: str) -> Case:
    if name == "T":
        return t_case()
    if name == "L":
        grasp = l_shape()
        return Case("L", "mm", grasp.outline, grasp.radius, grasp.contacts)
    return read_case(case_paths(name)[0])


@functools.cache
def planned(name: str) -> Cage:
    case = case_of(name)
    return cage_of("T") if name == "T" else plan(case.outline, case.contacts, case.finger_radius)


def study(name: str = "T", **table: Any) -> Study:
    case = case_of(name)
    return Study(study_config({"case": name, **table}, case), case, planned(name))


def run(count: int = 4, name: str = "T", **table: Any) -> Ran:
    return run_trials(study(name, **table), np.arange(count))


def outcomes(ran: Ran) -> list[str]:
    return [STUDY_OUTCOMES[int(code)] for code in ran.outcome]


def held(name: str = "T", opening: float = 1.0) -> list[float]:
    """The target's placement, opened about the middle of its fingers."""
    cage = planned(name)
    x, y, theta, sigma = cage.target_placement.as_array().tolist()
    wider = (opening - 1.0) * sigma * np.exp(1j * theta) * cage.hand.z.mean()
    return [x - wider.real, y - wider.imag, theta, opening * sigma]


def middles(hand: HandShape, placements: FloatArray) -> FloatArray:
    """Mean of the fingers, (n, 2)."""
    return hand.fingers(placements).mean(axis=-2)
