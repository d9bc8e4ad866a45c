"""Loose ends, tangles, rational curves, and formats that are refused by their name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from icage import load
from icage.errors import FormatError, InputError
from icage.formats.drawings.crossings import check_tangle
from icage.formats.drawings.curves import Bezier
from icage.formats.drawings.ends import joined, where_loose
from icage.formats.drawings.rational import RationalBezier
from icage.formats.drawings.read import FORMATS, NOT_READ


def path(*points: tuple[float, float]) -> np.ndarray:
    return np.array(points, dtype=float)


def test_the_nearer_pair_is_joined_first():
    a, b, c = path((0, 0), (1, 0)), path((1.05, 0), (2, 0)), path((1.2, 0), (1.2, 5))
    found = joined([a, b, c], 0.3)
    # c is loose and near to the pair that a and b make, so it joins them; 5 and 0 stay loose.
    ends = [found.paths[0][1], found.paths[1][0], found.paths[2][0]]
    assert all((end == ends[0]).all() for end in ends)
    assert found.loose.tolist() == [[0, 0], [1.2, 5], [2, 0]]


def test_a_pair_further_apart_than_the_gap_stays_loose():
    found = joined([path((0, 0), (1, 0)), path((1.5, 0), (3, 0))], 0.4)
    assert len(found.loose) == 4
    assert where_loose(found.loose) == (
        "4 loose ends, the nearest two 0.5 apart, at (1, 0) and (1.5, 0)"
    )


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(3, 40))
def test_a_polygon_of_shuffled_turned_shaken_edges_is_closed(seed: int, n: int):
    rng = np.random.default_rng(seed)
    u = 2 * np.pi * np.arange(n + 1) / n
    corners = np.column_stack([np.cos(u), np.sin(u)])
    edge = float(np.hypot(*(corners[1] - corners[0])))
    edges = [corners[k : k + 2] + 0.05 * edge * rng.uniform(-1, 1, (2, 2)) for k in range(n)]
    edges = [edges[k][:: rng.choice([1, -1])] for k in rng.permutation(n)]
    found = joined(edges, 10.0 * edge)
    assert len(found.loose) == 0
    ends = np.vstack([one[[0, -1]] for one in found.paths])
    _, counts = np.unique(ends, axis=0, return_counts=True)
    assert counts.tolist() == [2] * n


def test_tangles_are_refused():
    rng = np.random.default_rng(0)
    with pytest.raises(FormatError, match="cross more than"):
        check_tangle([rng.random((1_000, 2))])
    with pytest.raises(FormatError, match="over each other"):
        check_tangle([path((0, k * 1e-6), (1, 1 + k * 1e-6)) for k in range(2_000)])
    check_tangle([np.column_stack([np.arange(3e4), np.arange(3e4) % 2])])


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), degree=st.integers(2, 7), spread=st.floats(0.0, 3.0))
@example(seed=5984, degree=2, spread=1.0)
def test_a_rational_curve_is_flattened_within_the_distance(seed: int, degree: int, spread: float):
    rng = np.random.default_rng(seed)
    curve = RationalBezier(
        rng.random((degree + 1, 2)), np.exp(spread * rng.normal(size=degree + 1))
    )
    t = np.linspace(0.0, 1.0, 4_001)
    second = np.diff(curve.at(t), 2, axis=0) * 4_000.0**2
    assert np.hypot(second[:, 0], second[:, 1]).max() <= curve.bend() * (1 + 1e-3) + 1e-3
    # At its turns the curve reaches its bounding box.
    corners = curve.at(np.array([0.0, *curve.turns(), 1.0]))
    assert (corners.max(axis=0) >= curve.at(t).max(axis=0) - 1e-9).all()
    assert (corners.min(axis=0) <= curve.at(t).min(axis=0) + 1e-9).all()
    same = RationalBezier(curve.control, np.full(degree + 1, 3.0))
    assert np.allclose(same.at(t), Bezier(curve.control).at(t), atol=1e-12)


@pytest.mark.parametrize("suffix", NOT_READ)
def test_a_known_format_is_refused_by_its_name_with_a_way_out(tmp_path: Path, suffix: str):
    file = tmp_path / f"part{suffix.upper()}"
    file.write_bytes(b"anything")
    what, way_out = NOT_READ[suffix]
    with pytest.raises(InputError) as caught:
        load(file)
    assert f"is {what}, which is not read: {way_out}" in str(caught.value)
    assert suffix not in FORMATS
