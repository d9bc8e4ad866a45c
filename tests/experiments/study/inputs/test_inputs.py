"""An input of a study is one row of one table: everything else follows from it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from experiments.environment import ROOT
from experiments.study.inputs.config import study_config
from experiments.study.inputs.placements import HandError, SeenError, moved
from experiments.study.inputs.variable_list import listing, markdown
from experiments.study.inputs.variables import PAIRS, PERCENT, VARIABLES, Variable
from experiments.study.inputs.variants import ShapeError, Variants
from experiments.study.report.rate_figures import draw_rates
from experiments.study.report.results_md import results_page
from experiments.study.report.summary import summary
from experiments.study.run.command import command_line
from experiments.study.run.document import study_document, study_of
from experiments.study.run.rows import table_of
from experiments.study.run.shard import Study, run_trials
from experiments.study.run.worlds import Slope, slope_of, worlds_of
from icage.arrays import FloatArray
from sim.closing.varied import Worlds
from tests.experiments.small import cage_of, t_case

COUNT = 12

SIZES = np.array([2.0, 4.0])

EVERY = pytest.mark.parametrize("name", list(VARIABLES))


def test_every_field_that_inputs_set_is_set_by_one_row():
    known = {
        *(("hand", f.name) for f in fields(HandError)),
        *(("seen", f.name) for f in fields(SeenError)),
        *(("slope", f.name) for f in fields(Slope)),
        *(("shape", name) for name in ShapeError._fields),
        *(("world", f.name) for f in fields(Worlds)),
    } - {("world", "gravity_x"), ("world", "gravity_y")}  # follow from the slope
    rows = [(one.part, one.field) for one in VARIABLES.values()]
    assert len(set(rows)) == len(rows)
    assert set(rows) == known


def test_a_world_is_the_usual_one_where_every_input_is_nominal():
    worlds, usual = worlds_of(given(), np.zeros((2, 4)), SIZES), Worlds.usual(2)
    for one in fields(Worlds):
        assert np.array_equal(getattr(worlds, one.name), getattr(usual, one.name)), one.name


def given(**changed: float) -> dict[str, FloatArray]:
    """Nominal values of all inputs, of two trials, but for these."""
    values = {name: np.full(2, one.nominal) for name, one in VARIABLES.items()}
    return values | {name: np.full(2, value) for name, value in changed.items()}


def parts(values: dict[str, FloatArray]) -> dict[str, Any]:
    """Everything that becomes of the inputs of trials."""
    cage = cage_of("T")
    study = Study(study_config({"case": "T"}, t_case()), t_case(), cage)
    hands = np.full(2, complex(cage.hand.z.mean()))
    rows = np.array([[0.1, 0.2, 0.3, 1.0]] * 2)
    worlds = worlds_of(values, rows, SIZES)
    return {
        "place": moved(rows, values, cage, hands).tolist(),
        "world": {f.name: getattr(worlds, f.name).tolist() for f in fields(Worlds)},
        "slope": {f.name: getattr(slope_of(values), f.name).tolist() for f in fields(Slope)},
        "shape": Variants(study.config, cage).keys(values, np.array([5, 5]))[0],
    }


@EVERY
def test_an_input_changes_the_field_of_its_row_and_no_other_part(name: str):
    one = VARIABLES[name]
    value = min(one.high, one.nominal + 0.01)
    before, after = parts(given()), parts(given(**{name: value}))
    changed = {part for part in before if before[part] != after[part]}
    if one.part in ("hand", "seen"):
        assert changed == {"place"}
    elif one.part == "shape":
        assert changed == {"shape"}
        assert getattr(after["shape"][0], one.field) == value
    elif one.part == "slope":
        assert changed == ({"slope", "world"} if name == "tilt" else {"slope"})
        assert after["slope"][one.field] == [value, value]
    else:
        scale = SIZES if one.measure == "length" else np.ones(2)
        assert changed == {"world"}
        assert after["world"][one.field] == (value / scale).tolist()


def little(one: Variable) -> str:
    """A distribution of a little more than the nominal value, as a user writes it."""
    if one.measure == "length":
        return "0:0.3%"
    low = one.nominal
    return f"{low!r}:{low + 0.03!r}" + ("rad" if one.measure == "angle" else "")


def whole(name: str, folder: Path) -> tuple[pa.Table, str, str]:
    """Table, page and drawing of a study of one input, by way of its document."""
    given = {
        "case": "T",
        "trials": COUNT,
        "max_time": 0.05,
        "vary": {name: little(VARIABLES[name])},
    }
    first = Study(study_config(given, t_case()), t_case(), cage_of("T"))
    study = study_of(study_document(first))
    assert study.config == first.config
    table = table_of(study, run_trials(study, np.arange(COUNT)))
    found = summary(study.config, study.design, table, study.case.outline.diameter)
    stopped = {"early": False, "at": COUNT, "why": "all"}
    document = {**study_document(study), "finished": True, "stopped": stopped, "found": found}
    draw_rates(document, folder / f"{name}.svg")
    drawn = (folder / f"{name}.svg").read_text(encoding="utf-8")
    return table, results_page(document, command_line(document)), drawn


@contextmanager
def renamed(which: str, **changed: str) -> Iterator[None]:
    """The table with another name in one row, in the same order; as it was afterwards."""
    before = dict(VARIABLES)
    rows = [replace(one, **changed) if key == which else one for key, one in before.items()]
    try:
        VARIABLES.clear()
        VARIABLES.update((one.name, one) for one in rows)
        yield
    finally:
        VARIABLES.clear()
        VARIABLES.update(before)


@EVERY
@pytest.mark.slow
def test_an_input_is_known_by_its_row_alone(name: str, tmp_path: Path):
    """Under a made-up name, it does the same, and nothing asks for the old one."""
    table, page, drawn = whole(name, tmp_path)
    label = "of a made-up kind"
    with renamed(name, name="made_up", label=label):
        again, other_page, other_drawn = whole("made_up", tmp_path)
        assert "  made_up " in "\n".join(listing())
        assert "| `made_up` |" in "\n".join(markdown())
    columns = [name if column == "made_up" else column for column in again.column_names]
    assert again.rename_columns(columns).equals(table)
    assert f"--vary {name}=" in page
    assert "--vary made_up=" in other_page
    assert f"\n## {label.capitalize()}\n" in other_page
    assert label in other_drawn
    assert label not in drawn


def test_a_pair_is_two_rows_that_differ_in_the_axis_only():
    for names in PAIRS.values():
        one, other = (VARIABLES[name] for name in names)
        alike = replace(other, name=one.name, field=one.field, label=one.label, help=one.help)
        assert alike == one


def test_groups_stand_together_in_the_table():
    groups = [one.group for one in VARIABLES.values()]
    assert sum(a != b for a, b in pairwise(groups)) == len(set(groups)) - 1


def test_the_page_of_formats_lists_the_inputs():
    page = (ROOT / "docs/formats.md").read_text(encoding="utf-8")
    assert "\n".join(["", *markdown(), ""]) in page
    for pair in PAIRS:
        assert f"`{pair}`" in page


def test_percent_is_what_ranges_are_written_in():
    assert VARIABLES["linkage_play"].high == 10.0 * PERCENT
    assert VARIABLES["linkage_play"].written_range == "0% to 10%"
