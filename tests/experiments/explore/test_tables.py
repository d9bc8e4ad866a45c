"""The tables of a query say what the query finds by searching."""

from __future__ import annotations

import numpy as np
import pytest

import icage
from icage.cells.held_outside import held_outside
from icage.cells.membership import EscapeLevels, Locator, query
from icage.cells.query_tables import query_tables
from icage.errors import InputError, MethodError
from icage.geometry.near_frame import NearFrame
from models import CASES
from tests.experiments.explore.placements import SIX, cage_of, held_elsewhere


@pytest.mark.parametrize("name", SIX)
def test_held_cells_are_those_from_which_a_search_does_not_escape(name: str):
    work = cage_of(name).work
    assert work is not None
    held = held_outside(work)
    assert len(held.cells) > 10
    levels = EscapeLevels(work.search.free_space).of(held.cells, np.zeros(len(held.cells)))
    assert levels == pytest.approx(held.escapes, rel=1e-12)


@pytest.mark.parametrize("name", SIX)
def test_whatever_is_held_outside_the_cage_lies_in_a_held_cell(name: str):
    cage = cage_of(name)
    tables = query_tables(cage)
    cells, escapes = tables.outside.tolist(), tables.outside_level.tolist()
    level = dict(zip(map(tuple, cells), escapes, strict=True))
    rows = held_elsewhere(cage, np.random.default_rng(5), 300)
    answers = query(cage, rows)
    outside = np.flatnonzero((answers.verdict == 2) & ~answers.in_cage)
    assert len(outside) > 100
    locator = Locator.of(cage.work.search.free_space)
    fingers = cage.hand.fingers(NearFrame.of(cage.outline).rows_into(rows[outside]))
    for row, cell in zip(outside, locator.cells(fingers, tables.held).tolist(), strict=True):
        margin = level[tuple(cell)] - rows[row, 3]
        if np.isnan(answers.margin[row]):
            assert margin == np.inf
        else:
            assert margin == pytest.approx(answers.margin[row], abs=1e-9 * cage.outline.diameter)


@pytest.mark.parametrize("name", SIX)
def test_no_cell_is_in_both_tables(name: str):
    tables = query_tables(cage_of(name))
    cage = set(map(tuple, tables.cage.cells.tolist()))
    assert cage.isdisjoint(map(tuple, tables.outside.tolist()))
    assert len(cage) == len(tables.cage.level) == len(tables.cage.parent) == len(tables.cage.stamp)
    assert (np.diff(tables.cage.level) >= 0.0).all()


def test_contacts_that_are_no_cage_have_empty_tables():
    tables = query_tables(icage.plan(icage.load(CASES / "rectangle_notcage.json")))
    assert len(tables.pieces.start) == 1
    assert len(tables.cage.cells) == len(tables.outside) == 0


def test_a_plan_of_the_contact_space_has_none():
    case = icage.load(CASES / "T_best.json")
    cage = icage.plan(case, method="contact-space")
    with pytest.raises(MethodError, match="contact space"):
        query_tables(cage)


def test_too_large_an_outline_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("icage.cells.sublevels.MOST_CELLS", 100)
    with pytest.raises(InputError, match="simplify the outline"):
        held_outside(cage_of("hook_deep_multi").work)
