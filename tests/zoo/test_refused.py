"""Refused shapes crossed with every way in. A new way in is one line in ``DOORS``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from icage.cells.membership import query
from icage.cells.method import CELLS
from icage.cells.regions import caging_regions, outer_bounds
from icage.contact_space.method import ContactSpace
from icage.discs.offsets import offsets
from icage.errors import IcageError, InputError, OutlineError
from icage.formats.case_json import parse_case, parse_object
from icage.geometry.exterior import exterior_pieces
from icage.grasps.features import features_of
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.search import best_grasps
from icage.hand import HandShape
from icage.hand_sublevels import sublevels
from icage.method import Method
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats
from tests.zoo.shapes import REFUSED, Shape
from tests.zoo.specimens import case_of, specimen

THREE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.8]])
DOORS: dict[str, tuple[Callable[[Any], object], type[Exception]]] = {
    "Outline": (Outline, OutlineError),
    "parse_case": (lambda v: parse_case(case_of(v, THREE.tolist()), Path()), InputError),
    "parse_object": (lambda v: parse_object(case_of(v, []), Path()), InputError),
    "plan": (lambda v: plan(Outline(v), THREE), OutlineError),
    "plan of discs": (lambda v: plan(Outline(v), THREE, 0.1), OutlineError),
    "best_grasps": (
        lambda v: best_grasps(Outline(v), rng=np.random.default_rng(0)), OutlineError
    ),
    "grasps_of_hand": (lambda v: grasps_of_hand(Outline(v), HandShape(0.5 + 0.8j)), OutlineError),
    "sublevels": (lambda v: sublevels(v, HandShape(0.5 + 0.8j)), OutlineError),
    "offsets": (lambda v: offsets(Outline(v), 0.1, 8), OutlineError),
    "exterior_pieces": (
        lambda v: exterior_pieces(Outline(v), HandShape(0.5 + 0.8j)), OutlineError
    ),
    "features": (lambda v: features_of(Outline(v)), OutlineError),
}  # fmt: skip
"""Every way in for an outline, and the error class it answers a refused one with."""


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("shape", REFUSED, ids=lambda s: s.name)
def test_refused(shape: Shape, door: str) -> None:
    enter, error = DOORS[door]
    with pytest.raises(error) as told:
        enter(shape.vertices)
    assert issubclass(shape.refused or IcageError, InputError)
    assert len(str(told.value)) > 10
    assert "\n" not in str(told.value)


WRONG_CONTACTS: dict[str, tuple[Floats, str]] = {
    "clockwise": (THREE[::-1], "clockwise"),
    "collinear": (np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), "collinear"),
    "coincident": (np.zeros((3, 2)), "coincide"),
    "two": (THREE[:2], "three finger centres"),
    "not a number": (np.full((3, 2), np.nan), "must be finite"),
}


@pytest.mark.parametrize("method", ["cells", "contact space", "discs"])
@pytest.mark.parametrize("name", WRONG_CONTACTS)
def test_contacts_that_are_no_hand_are_refused_by_every_method(name: str, method: str) -> None:
    contacts, message = WRONG_CONTACTS[name]
    outline = specimen("triangle").outline
    method: Method = ContactSpace() if method == "contact space" else CELLS
    with pytest.raises(InputError, match=message):
        plan(outline, contacts, 0.1 if method == "discs" else 0.0, method)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (np.zeros(4), "rows x, y, theta, sigma"),
        (np.zeros((2, 3)), "rows x, y, theta, sigma"),
        (np.array([[0, 0, 0, 1.0], [0, 0, 0, np.nan]]), "placement 1: numbers must be finite"),
        (np.array([[0, 0, 0, -1.0]]), "placement 0: sigma = -1.0; at least 0"),
    ],
)
def test_placements_that_are_none_are_refused(rows: Floats, message: str) -> None:
    with pytest.raises(InputError, match=message):
        query(specimen("triangle").cage, rows)


@pytest.mark.parametrize("level", [0.0, -1.0, np.nan, 1e9])
def test_levels_outside_the_cage_are_refused(level: float) -> None:
    for ask in (caging_regions, outer_bounds):
        with pytest.raises(InputError, match=r"above sigma_0 = .* is allowed"):
            ask(specimen("triangle").cage, level)
