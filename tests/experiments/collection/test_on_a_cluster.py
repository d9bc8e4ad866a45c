"""What goes to a worker and comes back: objects to the last bit, rows that are checked."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from experiments.collection.backends import rows_in, run_remote
from experiments.collection.objects import Readable, readable_of
from experiments.collection.options import SearchOptions
from experiments.collection.rows import searched_rows, table_of
from experiments.io.arrow_bytes import bytes_of
from icage.case import Case
from icage.grasps.wanted import Wanted
from icage.outline import Outline

TRIANGLE = Outline([[0.1, 0.2], [1.0 / 3.0, -7e-3], [0.31, 1.0 / 7.0]])
ONE = Readable("a/b.json", "0123456789abcdef", 7, Case("b", "mm", TRIANGLE))


def test_an_object_arrives_to_the_last_bit():
    again = readable_of(json.loads(json.dumps(ONE.document())))
    assert again == ONE
    there = again.case.outline.vertices
    assert there.tobytes() == ONE.case.outline.vertices.tobytes()


def test_the_rows_are_those_of_a_search_here():
    options = SearchOptions(Wanted(), top=2)
    text = json.dumps(options.document())
    data = run_remote(text, json.dumps(ONE.document()))
    here = table_of(searched_rows(ONE, options))
    assert table_of(rows_in(data, ONE, 2)).equals(here)
    assert np.isfinite(here["sigma_0"].to_pylist()[0])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"file": "c.json"}, "another object"),
        ({"digest": "0"}, "another object"),
        ({"rank": 2}, "no order"),
        ({"why": "\x1b[2J"}, "cannot be printed"),
    ],
)
def test_rows_of_others_are_not_taken(change: dict[str, Any], words: str):
    row = {"file": ONE.file, "digest": ONE.digest, "seed": ONE.seed, "rank": 1}
    assert rows_in(bytes_of(table_of([row])), ONE, 1)
    with pytest.raises(ValueError, match=words):
        rows_in(bytes_of(table_of([row | change])), ONE, 1)


@pytest.mark.parametrize("count", [0, 3])
def test_no_rows_and_too_many_are_no_answer(count: int):
    row = {"file": ONE.file, "digest": ONE.digest, "seed": ONE.seed}
    with pytest.raises(ValueError, match=f"{count} rows instead of 2"):
        rows_in(bytes_of(table_of([row] * count)), ONE, 2)


def test_a_target_goes_along():
    sides = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 3.0**0.5]])
    middles = (sides + np.roll(sides, -1, axis=0)) / 2.0
    case = Case("t", "m", Outline(sides), 0.0, middles)
    one = replace(ONE, case=case)
    assert readable_of(json.loads(json.dumps(one.document()))).case == case
