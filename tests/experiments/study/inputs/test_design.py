"""Designs of experiments: a trial's values depend on its number, whatever piece it is drawn in."""

from __future__ import annotations

import warnings
from collections import Counter
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest

from experiments.study.inputs.config import StudyConfig
from experiments.study.inputs.design import Design, base_points, cells, sobol_points
from experiments.study.inputs.distributions import Distribution
from experiments.study.inputs.placements import Intended
from experiments.study.inputs.variables import VARIABLES
from experiments.study.report.indices import layout
from icage.arrays import FloatArray
from tests.experiments.small import cage_of

UNIFORM = Distribution("uniform", (0.0, 1.0))
THREE = {
    "friction": UNIFORM,
    "tilt": Distribution("normal", (0.0, 1.0)),
    "mass": Distribution("truncated", (1.0, 0.2, 0.5, 1.5)),
}
GRIDS = {
    "friction": Distribution("grid", (0.0, 0.3, 0.6)),
    "speed": UNIFORM,
    "mass": Distribution("grid", (1.0, 2.0)),
    "weight": Distribution("grid", (0.5, 0.1, 0.9, 0.2)),
}
PLACED = {
    "place_x": UNIFORM,
    "bias_theta": Distribution("normal", (0.0, 0.1)),
    "friction": UNIFORM,
    "outline_noise": UNIFORM,
}
SAMPLINGS = [
    ("random", THREE), ("random", GRIDS), ("random", PLACED), ("random", {}),
    ("sobol", THREE), ("sobol", GRIDS), ("sobol", {"friction": UNIFORM}),
    ("saltelli", THREE), ("saltelli", PLACED), ("saltelli", {}),
]  # fmt: skip


def design(sampling: str, vary: dict[str, Distribution], trials: int = 100, **more: Any) -> Design:
    return Design.of(StudyConfig("T", trials=trials, sampling=sampling, vary=vary, **more))


def matrix(one: Design, trials: Any) -> FloatArray:
    """Values of all variables, and which start and which shape, (n, d)."""
    rows = np.asarray(trials, dtype=np.int64)
    values = one.values(rows)
    columns = [values[name] for name in VARIABLES]
    return np.column_stack([*columns, *one.streams(rows), one.shapes(rows)])


@pytest.mark.parametrize(("sampling", "vary"), SAMPLINGS)
@settings(max_examples=8)
@given(cuts=st.lists(st.integers(0, 100), max_size=6), seed=st.integers(0, 2**63 - 1))
def test_any_split_into_pieces_gives_the_same_values(
    sampling: str, vary: dict[str, Distribution], cuts: list[int], seed: int
):
    one = design(sampling, vary, seed=seed)
    whole = matrix(one, np.arange(100))
    edges = [0, *sorted(cuts), 100]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nobody who runs a study is told of powers of two
        pieces = [matrix(one, np.arange(a, b)) for a, b in pairwise(edges)]
    assert np.concatenate(pieces).tobytes() == whole.tobytes()
    some = np.array(sorted({cut for cut in cuts if cut < 100}), dtype=np.int64)  # with gaps
    assert matrix(one, some).tobytes() == whole[some].tobytes()


@pytest.mark.parametrize(("sampling", "vary"), SAMPLINGS)
def test_more_trials_keep_the_first_ones(sampling: str, vary: dict[str, Distribution]):
    few, many = design(sampling, vary, trials=60), design(sampling, vary, trials=5000)
    assert few.total <= many.total
    assert matrix(few, np.arange(60)).tobytes() == matrix(many, np.arange(60)).tobytes()


def test_far_trials_are_had_without_the_near_ones():
    for sampling in ("random", "sobol"):
        one = design(sampling, THREE, trials=10_000_000)
        far = matrix(one, [9_999_998, 9_999_999])
        assert far[1].tobytes() == matrix(one, [9_999_999])[0].tobytes()
        assert (far[0, :-3] != matrix(one, [0])[0, :-3]).sum() == 3


def test_seeds_differ_and_repeat():
    for sampling in ("random", "sobol"):
        one, same, other = (
            matrix(design(sampling, THREE, seed=seed), np.arange(50)) for seed in (1, 1, 2)
        )
        assert one.tobytes() == same.tobytes()
        varied = [k for k, name in enumerate(VARIABLES) if name in THREE]
        assert not np.isin(one[:, varied], other[:, varied]).any()


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_variables_are_uniform_and_do_not_know_of_each_other(sampling: str):
    vary = dict.fromkeys(VARIABLES, UNIFORM)
    one = design(sampling, vary, trials=4096, seed=5)
    values = one.values(np.arange(4096))
    rows = np.column_stack([values[name] for name in VARIABLES])
    for column in rows.T:
        assert kstest(column, "uniform").pvalue > 1e-4
    seen = np.corrcoef(rows.T) - np.eye(len(VARIABLES))
    assert np.abs(seen).max() < 5.0 / np.sqrt(4096)
    following = np.corrcoef(rows[:-1].T, rows[1:].T)  # nor of the trial before
    if sampling == "random":
        assert np.abs(following - np.eye(2 * len(VARIABLES))).max() < 5.0 / np.sqrt(4096)


def test_a_sobol_sequence_fills_every_part_of_the_range_alike():
    points = sobol_points(3, 0, 256, np.random.default_rng(1))
    for column in points.T:
        assert (np.bincount((256 * column).astype(int), minlength=256) == 1).all()
    pairs = Counter(map(tuple, (16 * points[:, :2]).astype(int).tolist()))
    assert set(pairs.values()) == {1}


def test_variables_that_do_not_vary_have_their_value():
    vary = {"friction": Distribution("fixed", (0.3,)), "mass": Distribution("grid", (2.0,))}
    one = design("random", vary)
    assert one.names == ()
    values = one.values(np.arange(7))
    assert set(values) == set(VARIABLES)
    for name, found in values.items():
        expected = vary[name].parameters[0] if name in vary else VARIABLES[name].nominal
        assert found.tolist() == [expected] * 7


# ---------------------------------------------------------------------------- grids


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_every_cell_of_the_grids_has_as_many_trials(sampling: str):
    one = design(sampling, GRIDS, trials=240)
    assert cells(one.config, one.names) == 24
    values = one.values(np.arange(240))
    rows = np.column_stack([values[name] for name in ("friction", "mass", "weight")])
    seen = Counter(map(tuple, rows.tolist()))
    assert set(seen.values()) == {10}
    assert len(seen) == 24
    assert len(np.unique(values["speed"])) == 240
    assert len(np.unique(rows[:24], axis=0)) == 24  # one of each before any comes again


# ---------------------------------------------------------------------------- Saltelli


@pytest.mark.parametrize("vary", [THREE, PLACED], ids=["three", "placed"])
@pytest.mark.parametrize("starts", ["guaranteed", "nominal"])
def test_a_member_differs_from_a_in_its_groups_columns_which_are_those_of_b(
    vary: dict[str, Distribution], starts: str
):
    one = design("saltelli", vary, trials=300, starts=starts)
    groups = dict(one.groups)
    placed = tuple(name for name in one.names if VARIABLES[name].group == "placement")
    assert set(groups) == {n for n in one.names if n not in placed} | (
        {"placement"} if placed or starts != "nominal" else set()
    )
    base, member = layout(np.arange(one.total), len(groups))
    values = one.values(np.arange(one.total))
    rows = np.column_stack([values[name] for name in one.names])
    number, stream = one.streams(np.arange(one.total))
    shapes = one.shapes(np.arange(one.total))
    assert number.tolist() == base.tolist()
    a, b = rows[member == 0], rows[member == 1]
    assert not np.isin(a, b).any()
    assert (stream[member == 0] == 0).all()
    assert (stream[member == 1] == 1).all()
    noisy = shapes[member == 0], shapes[member == 1]
    assert not np.isin(*noisy).any()
    assert len(np.unique(shapes)) == 2 * len(a)
    for k, (name, columns) in enumerate(one.groups):
        expected = placed if name == "placement" else (name,)
        assert tuple(one.names[c] for c in columns) == expected
        mine = rows[member == 2 + k]
        for c in range(len(one.names)):
            assert np.array_equal(mine[:, c], (b if c in columns else a)[:, c])
        assert (stream[member == 2 + k] == (name == "placement")).all()
        swapped = noisy[1] if name == "outline_noise" else noisy[0]
        assert np.array_equal(shapes[member == 2 + k], swapped)


def test_the_drawn_start_goes_with_its_group():
    one = design("saltelli", {"friction": UNIFORM}, trials=64)
    assert [name for name, _ in one.groups] == ["friction", "placement"]
    trials = np.arange(64)
    meant = Intended(one.config, cage_of("T")).placements(*one.streams(trials))
    _, member = layout(trials, 2)
    a, b, mixed, moved = (meant[member == k] for k in range(4))
    assert np.array_equal(mixed, a)
    assert np.array_equal(moved, b)
    assert not np.isin(a, b).any()
    assert len(np.unique(meant[:, 0])) == 2 * 16


def test_noise_of_one_size_is_an_input_for_its_shape():
    one = design("saltelli", {"outline_noise": Distribution("fixed", (0.1,))}, starts="nominal")
    assert one.groups == (("outline_noise", ()),)
    assert one.shapes(np.arange(6)).tolist() == [0, 1, 1, 2, 3, 3]
    assert len(np.unique(design("random", {}).shapes(np.arange(99)))) == 99


def test_base_points_are_a_power_of_two_that_gives_enough_trials():
    for trials in (1, 5, 96, 97, 1000, 12345):
        for groups in (1, 3, 10):
            base = base_points(trials, groups)
            assert base & (base - 1) == 0
            assert base * (groups + 2) >= trials
            assert base == 1 or base // 2 * (groups + 2) < trials
    one = design("saltelli", THREE, trials=1000)
    assert one.total == 256 * 6
    assert design("random", THREE, trials=1000).total == 1000
