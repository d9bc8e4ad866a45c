"""Whole sublevels: against the table of all cells, closed forms, plans, other names of fingers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.random import Generator
from scipy.optimize import linear_sum_assignment

import icage
from icage.cells import sublevels as of_cells
from icage.errors import GraspError, HandError, InputError
from tests.oracles.against_itself.table_of_cells import births_and_merges
from tests.oracles.geometry import Floats
from tests.oracles.polygons import random_polygon
from tests.zoo.shapes import VALID

EXACT = 1e-9
"""[diameter]"""

TRIANGLE = [[0, 0], [1, 0], [0.5, 0.75**0.5]]
EQUILATERAL = icage.HandShape.from_angles_deg(60.0, 120.0)


def _polar(radius: Floats, angle: Floats) -> Floats:
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def _star(rng: Generator) -> Floats:
    n = int(rng.integers(5, 30))
    angle = (np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2.0 * np.pi / n
    return _polar(rng.uniform(0.35, 1.0, n), angle)


def _symmetric_star(rng: Generator) -> Floats:
    k = int(rng.integers(3, 9))
    return _polar(np.tile([1.0, rng.uniform(0.3, 0.9)], k), np.arange(2 * k) * np.pi / k)


def _regular(rng: Generator) -> Floats:
    n = int(rng.integers(3, 24))
    turn = rng.choice([0.0, rng.uniform(0.0, 6.0)])
    return _polar(np.ones(n), 2.0 * np.pi * np.arange(n) / n + turn)


def _skyline(rng: Generator) -> Floats:
    heights = rng.permutation(int(rng.integers(3, 8))) + 1.0
    roof = [point for k, h in enumerate(heights) for point in ((k, h), (k + 1, h))]
    return np.array([(0.0, 0.0), (len(heights), 0.0), *roof[::-1]])


def _comb(rng: Generator) -> Floats:
    """Pockets between teeth: some hands hook in them and never get out."""
    k = int(rng.integers(2, 6))
    teeth: list[tuple[float, float]] = []
    for i in range(k):
        teeth += [(i, 0.0), (i, rng.uniform(1.9, 3.0)), (i + 0.5, 2.0), (i + 0.5, 0.2)]
    return np.array([(0.0, -1.0), (k, -1.0), *teeth[::-1]])


def _spiral(rng: Generator) -> Floats:
    turn = np.linspace(0.0, rng.uniform(4.0, 8.0), int(rng.integers(8, 14)))
    radius = 1.0 + 0.4 * turn
    return np.vstack([_polar(radius, turn), _polar(radius - 0.35, turn)[::-1]])


def _any(rng: Generator) -> Floats:
    return random_polygon(rng, int(rng.integers(5, 26)))


def _of_the_zoo(rng: Generator) -> Floats:
    small = [shape for shape in VALID if len(shape.vertices) <= 45]
    return np.asarray(small[int(rng.integers(len(small)))].vertices, dtype=np.float64)


def _nearly_degenerate(rng: Generator) -> Floats:
    """What is symmetric or parallel, moved by next to nothing."""
    kinds = (_symmetric_star, _regular, _skyline, _comb)
    vertices = kinds[int(rng.integers(len(kinds)))](rng)
    return vertices + rng.normal(size=vertices.shape) * 10.0 ** rng.uniform(-12.0, -5.0)


FAMILIES: dict[str, Callable[[Generator], Floats]] = {
    "stars": _star,
    "symmetric stars": _symmetric_star,
    "regular polygons": _regular,
    "rectilinear": _skyline,
    "pockets": _comb,
    "spirals": _spiral,
    "any": _any,
    "zoo": _of_the_zoo,
    "nearly degenerate": _nearly_degenerate,
}


def _hand(rng: Generator) -> icage.HandShape:
    """Equilateral, right-angled, flat, or any."""
    kind = rng.random()
    if kind < 0.25:
        return EQUILATERAL
    if kind < 0.4:
        return icage.HandShape(1j)
    if kind < 0.5:
        return icage.HandShape(complex(0.5, rng.uniform(0.02, 0.1)))
    low, high = np.sort(rng.uniform(5.0, 170.0, 2))
    return icage.HandShape.from_angles_deg(low, max(high, low + 5.0))


def _diagram(found: icage.Sublevels) -> Floats:
    return np.column_stack([found.births, found.merges])


def _apart(a: Floats, b: Floats) -> float:
    """The most by which rows differ when they are matched as well as can be."""
    if len(a) != len(b):
        return np.inf
    far = 2.0 * max(np.max(rows, where=np.isfinite(rows), initial=1.0) for rows in (a, b))
    a, b = (np.where(np.isfinite(rows), rows, 10.0 * far) for rows in (a, b))
    gap = np.abs(a[:, None] - b[None]).max(axis=2, initial=0.0)
    rows, columns = linear_sum_assignment(gap)
    return float(gap[rows, columns].max(initial=0.0))


@pytest.mark.parametrize(
    "first", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in range(4, 64, 4))]
)
@pytest.mark.parametrize("family", FAMILIES)
def test_the_same_diagram_as_the_table_of_all_cells(family: str, first: int) -> None:
    for number in range(first, first + 4):
        rng = np.random.default_rng([14, number])
        outline, hand = icage.Outline(FAMILIES[family](rng)), _hand(rng)
        found = icage.sublevels(outline, hand)
        _is_a_forest(found)
        if _table_apart(outline, hand) > EXACT * outline.diameter:
            # Where exact symmetry holds a hand at more points than it needs, rounding alone says
            # whether it is shut off. Then they must agree as soon as the symmetry is broken.
            for _ in range(3):
                near = outline.vertices + 1e-9 * rng.standard_normal(outline.vertices.shape)
                apart = _table_apart(icage.Outline(near), hand)
                assert family.startswith("symmetric"), number
                assert apart <= EXACT * outline.diameter, number


def _table_apart(outline: icage.Outline, hand: icage.HandShape) -> float:
    return _apart(_diagram(icage.sublevels(outline, hand)), births_and_merges(outline, hand))


def _is_a_forest(found: icage.Sublevels) -> None:
    """Minima merge into deeper ones that end no earlier, and stand where they say."""
    size = found.outline.diameter
    into = found.into[found.into >= 0]
    assert (found.births[into] <= found.births[found.into >= 0]).all()
    assert (found.merges[into] >= found.merges[found.into >= 0]).all()
    assert (found.depths > 1e-10 * size).all()
    w = (found.contacts[:, 1:] - found.contacts[:, :1]) @ [1.0, 1j]
    assert np.abs(np.abs(w[:, 0]) - found.births).max(initial=0.0) <= EXACT * size
    assert np.abs(w[:, 1] - w[:, 0] * found.hand.z_3).max(initial=0.0) <= EXACT * size


def test_the_regular_triangle() -> None:
    found = icage.sublevels(TRIANGLE, EQUILATERAL)
    assert found.births == pytest.approx([0.5] * 3, abs=1e-12)
    assert found.merges == pytest.approx([0.75**0.5] * 3, abs=1e-12)
    assert found.into.tolist() == [-1] * 3
    middles = {(0.5, 0.0), (0.75, 0.433013), (0.25, 0.433013)}
    for contacts in found.contacts:
        assert {tuple(p) for p in (contacts.round(6) + 0.0).tolist()} == middles
    assert not found.never_escape.any()


@pytest.mark.parametrize("number", range(4))
def test_naming_the_fingers_differently_only_scales_the_levels(number: int) -> None:
    """Other edges tell of the same least points: nothing hangs on which fingers are asked."""
    rng = np.random.default_rng([15, number])
    outline, hand = icage.Outline(_star(rng)), _hand(rng)
    other = icage.HandShape((hand.z[0] - hand.z[1]) / (hand.z[2] - hand.z[1]))
    found, renamed = icage.sublevels(outline, hand), icage.sublevels(outline, other)
    assert len(found) > 10
    scale = abs(hand.z[2] - hand.z[1])
    assert _apart(scale * _diagram(found), _diagram(renamed)) <= EXACT * scale * outline.diameter


def test_a_plan_is_a_part_of_it() -> None:
    """More pieces than a table of all cells would hold."""
    rng = np.random.default_rng(5)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 130))
    outline = icage.Outline(_polar(rng.uniform(0.35, 1.0, 130), angle))
    found = icage.sublevels(outline, EQUILATERAL)
    _is_a_forest(found)
    planned = 0
    for k in range(0, len(found), len(found) // 40):
        try:
            cage = icage.plan(outline, found.contacts[k])
        except GraspError:  # a two-finger grasp, whose third finger is off the outline
            continue
        if cage.status == "cage":
            planned += 1
            assert cage.sigma_0 == pytest.approx(found.births[k], rel=EXACT)
            assert cage.sigma_max == pytest.approx(found.escapes[k], rel=EXACT)
    assert planned >= 5


def test_threads_and_stretches_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    outline = icage.Outline(_star(np.random.default_rng(3)))
    one = icage.sublevels(outline, EQUILATERAL, workers=1)
    monkeypatch.setattr(of_cells, "_STRETCH", 97)
    assert icage.sublevels(outline, EQUILATERAL, workers=3) == one
    assert len(one) > 10


def test_what_rounding_once_made_a_minimum() -> None:
    """A cell that only touches, and one born where every hand has escaped."""
    ring = _polar(np.ones(24), 2.0 * np.pi * np.arange(24) / 24)
    assert len(icage.sublevels(ring, icage.HandShape.from_angles_deg(90.0, 135.0))) == 0
    for k in (4, 6, 8):
        star = _polar(np.tile([1.0, 0.6], k), np.arange(2 * k) * np.pi / k)
        assert not icage.sublevels(star, EQUILATERAL).never_escape.any()


def test_an_object_far_from_its_origin() -> None:
    near = icage.sublevels(TRIANGLE, EQUILATERAL)
    far = icage.sublevels(np.array(TRIANGLE) + [3e5, -7e4], EQUILATERAL)
    assert _apart(_diagram(near), _diagram(far)) <= EXACT
    shift = far.contacts.mean(axis=(0, 1)) - near.contacts.mean(axis=(0, 1))
    assert shift == pytest.approx([3e5, -7e4], abs=1e-8)


def test_the_answer_is_a_value() -> None:
    found = icage.sublevels(TRIANGLE, EQUILATERAL)
    assert found == icage.sublevels(TRIANGLE, EQUILATERAL)
    assert found != icage.sublevels(np.array(TRIANGLE) * 2.0, EQUILATERAL)
    assert repr(found) == "<Sublevels: 3 minima, sigma 0.5 to 0.5>"
    with pytest.raises(ValueError, match="read-only"):
        found.births[0] = 1.0


def test_what_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="fingers of radius 6; sublevels"):
        icage.sublevels(icage.load("pliers"))
    with pytest.raises(HandError, match="bare outline needs a HandShape"):
        icage.sublevels(TRIANGLE)
    with pytest.raises(GraspError, match="no target grasp yet"):
        icage.sublevels(icage.Case("triangle", "mm", icage.Outline(TRIANGLE)))
    with pytest.raises(InputError, match="hand is 3; a HandShape is needed"):
        icage.sublevels(TRIANGLE, 3)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="workers is 0"):
        icage.sublevels(TRIANGLE, EQUILATERAL, workers=0)
    monkeypatch.setattr(of_cells, "MOST_CELLS", 10)
    with pytest.raises(InputError, match="up to 10 in all are allowed here: simplify"):
        icage.sublevels(TRIANGLE, EQUILATERAL)
