"""Errors of libraries about a user's object are ours, their flags no warnings; our faults stay."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely

import icage
from icage.case import Case
from icage.errors import FormatError, InputError, LibraryError
from icage.library_faults import decoding_told, geometry_told
from models import CASES

DOORS: dict[str, Callable[[Case], Any]] = {
    "plan": icage.plan,
    "plan by contact space": lambda case: icage.plan(case, method="contact-space"),
    "sublevels": lambda case: icage.sublevels(case),
    "grasps": lambda case: case.grasps(top=1),
}


def raising(error: Exception) -> Callable[..., Any]:
    def fails(*_: object, **__: object) -> None:
        raise error

    return fails


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("error", [shapely.GEOSException("no corner"), np.linalg.LinAlgError("no")])
def test_every_way_in_tells_it(door: str, error: Exception, monkeypatch: Any) -> None:
    case = icage.load(str(CASES / "L_best.json"))
    monkeypatch.setattr(shapely, "constrained_delaunay_triangles", raising(error))
    with pytest.raises(LibraryError, match="gave up on this object: no"):
        DOORS[door](case)


@pytest.mark.parametrize("door", ["plan", "grasps"])
def test_a_fault_of_ours_stays_one(door: str, monkeypatch: Any) -> None:
    case = icage.load(str(CASES / "L_best.json"))
    monkeypatch.setattr(shapely, "constrained_delaunay_triangles", raising(KeyError("ours")))
    with pytest.raises(KeyError, match="ours"):
        DOORS[door](case)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["distance", "is_valid_reason", "points"])
def test_flags_that_geos_leaves_are_no_warnings(name: str, monkeypatch: Any) -> None:
    real, calls = getattr(shapely, name), []

    def flagged(*args: Any, **options: Any) -> Any:
        calls.append(np.divide(np.ones(1), np.zeros(1)))
        return real(*args, **options)

    case = icage.load(str(CASES / "L_best.json"))
    monkeypatch.setattr(shapely, name, flagged)
    assert icage.plan(case.outline, case.contacts).status == "cage"
    with pytest.raises(InputError, match="not simple"):
        icage.Outline([[0, 0], [1, 1], [1, 0], [0, 1]])
    assert calls


def test_what_a_decoder_raises_within_itself_is_told() -> None:
    with pytest.raises(ValueError, match="ours"), decoding_told("json", "the file"):
        raise ValueError("ours")
    with (
        pytest.raises(FormatError, match=r"the file cannot be read \(Expecting"),
        decoding_told("json", "the file"),
    ):
        json.loads("{")
    with pytest.raises(ZeroDivisionError), geometry_told():
        raise ZeroDivisionError
