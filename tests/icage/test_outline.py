"""Everything that an Outline promises: what it keeps, what it refuses, and what it says then."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from icage.errors import InputError, OutlineError
from icage.outline import LARGEST_COORDINATE, MAX_VERTICES, Outline
from tests.oracles.polygons import FAMILIES

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
seeds = st.integers(0, 2**32 - 1)


def drawn(family: str, seed: int) -> np.ndarray:
    return FAMILIES[family](np.random.default_rng(seed))


def signed_area(ring: np.ndarray) -> float:
    """Shoelace, about the first vertex. [unit^2]"""
    (x, y), (u, v) = (ring - ring[0]).T, (np.roll(ring, -1, axis=0) - ring[0]).T
    return 0.5 * float(np.sum(x * v - u * y))


def circle(n: int) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(turn), np.sin(turn)])


# ------------------------------------------------------------------ what it keeps


@given(st.sampled_from(sorted(FAMILIES)), seeds)
def test_vertices_are_kept_bit_for_bit(family: str, seed: int) -> None:
    ring = drawn(family, seed)
    assert Outline(ring).vertices.tobytes() == ring.tobytes()
    assert Outline(ring.tolist()).vertices.tobytes() == ring.tobytes()


@given(st.sampled_from(sorted(FAMILIES)), seeds)
def test_a_clockwise_ring_is_turned_round(family: str, seed: int) -> None:
    ring = drawn(family, seed)
    turned = Outline(ring[::-1])
    assert signed_area(turned.vertices) > 0.0
    assert turned.vertices.tobytes() == ring.tobytes()


@given(st.sampled_from(sorted(FAMILIES)), seeds, st.integers(2, 4))
def test_repeated_vertices_are_dropped(family: str, seed: int, times: int) -> None:
    """Also the last one, equal to the first: a closed ring is the open one."""
    ring = drawn(family, seed)
    assert Outline(np.repeat(ring, times, axis=0)).vertices.tobytes() == ring.tobytes()
    closed = Outline(np.vstack([ring, ring[:1]]))
    assert len(closed) == len(ring)
    assert {tuple(p) for p in closed.vertices} == {tuple(p) for p in ring}
    assert signed_area(closed.vertices) == pytest.approx(signed_area(ring), rel=1e-12)


def test_collinear_vertices_stay() -> None:
    middle = 0.5 * (SQUARE + np.roll(SQUARE, -1, axis=0))
    ring = np.stack([SQUARE, middle], axis=1).reshape(-1, 2)
    assert Outline(ring).vertices.tolist() == ring.tolist()


def test_a_nearly_repeated_vertex_stays() -> None:
    ring = np.insert(SQUARE, 1, [np.nextafter(1.0, 0.0), 0.0], axis=0)
    assert len(Outline(ring)) == 5


@given(st.sampled_from(sorted(FAMILIES)), seeds)
def test_area_and_centroid(family: str, seed: int) -> None:
    ring = drawn(family, seed)
    outline = Outline(ring)
    area = signed_area(ring)
    assert outline.area == pytest.approx(area, rel=1e-12)
    x, y = ring.T
    u, v = np.roll(ring, -1, axis=0).T
    cross = x * v - u * y
    centre = np.array([np.sum((x + u) * cross), np.sum((y + v) * cross)]) / (6.0 * area)
    assert outline.centroid == pytest.approx(centre, abs=1e-9 * outline.diameter)


def spindle(n: int, thin: float) -> np.ndarray:
    x = np.linspace(0.0, 1.0, n)
    bulge = thin * x * (1.0 - x)
    return np.vstack([np.column_stack([x, -bulge]), np.column_stack([x, bulge])[-2:0:-1]])


@pytest.mark.parametrize("n", [3, 59, 60, 61, 400])
def test_diameter_is_the_largest_distance_of_two_vertices(n: int) -> None:
    """On either side of the count from which only the hull is looked at."""
    rng = np.random.default_rng(n)
    for _ in range(20):
        turn = np.sort(rng.random(n)) * 2.0 * np.pi
        if np.diff(turn, append=turn[0] + 2.0 * np.pi).max() > 3.0:
            continue
        ring = rng.uniform(0.3, 1.0, n)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
        assert Outline(ring).diameter == pytest.approx(pdist(ring).max(), rel=1e-14)
    assert Outline(circle(n)).diameter == pytest.approx(pdist(circle(n)).max(), rel=1e-14)


@pytest.mark.parametrize("thin", [1.0, 1e-3, 1e-6, 1e-8])
def test_diameter_of_a_thin_outline_of_many_vertices(thin: float) -> None:
    """Down to the thinnest that has an area: a third of ``thin``. A user's may not be so thin."""
    ring = spindle(60, thin)
    assert Outline.computed(ring).diameter == pytest.approx(pdist(ring).max(), rel=1e-14)
    with pytest.raises(OutlineError, match="no area: 3.33e-10 of its diameter squared"):
        Outline(spindle(60, 1e-9))


@pytest.mark.parametrize("far", [1e6, 1e9, 1e11])
def test_diameter_far_from_the_origin(far: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        turn = np.sort(rng.random(200)) * 2.0 * np.pi
        ring = far + rng.uniform(1.0, 1.0001, 200)[:, None] * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )
        assert Outline(ring).diameter == pytest.approx(pdist(ring).max(), rel=1e-14)


def test_arrays_are_copied_and_read_only() -> None:
    given_ring = SQUARE.copy()
    outline = Outline(given_ring)
    given_ring[0] = [5.0, 5.0]
    assert outline.vertices[0].tolist() == [0.0, 0.0]
    given_ring[1] = [6.0, 6.0]  # still ours to write
    with pytest.raises(ValueError, match="read-only"):
        outline.vertices[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        Outline(SQUARE[::-1]).vertices[0, 0] = 1.0
    with pytest.raises(AttributeError):
        outline.diameter = 2.0  # type: ignore[misc]
    with pytest.raises(AttributeError):
        outline.vertices = SQUARE  # type: ignore[misc]


def test_the_polygon_is_the_same_ring() -> None:
    outline = Outline(SQUARE[::-1])
    assert np.array(outline.polygon.exterior.coords)[:-1].tolist() == outline.vertices.tolist()
    assert outline.polygon.exterior.is_ccw


@pytest.mark.parametrize("unit", [1e-9, 1e-3, 1e3, 1e9])
def test_the_unit_of_the_drawing_does_not_matter(unit: float) -> None:
    outline = Outline(unit * SQUARE)
    assert outline.diameter == pytest.approx(unit * math.sqrt(2.0), rel=1e-15)
    assert outline.area == pytest.approx(unit**2, rel=1e-12)
    with pytest.raises(OutlineError, match="no area"):
        Outline(unit * np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 1e-13]]))


def test_equality_answers() -> None:
    assert Outline(SQUARE) == Outline(SQUARE.tolist())
    assert Outline(SQUARE) != Outline(2.0 * SQUARE)
    assert Outline(SQUARE) != "a square"
    assert hash(Outline(SQUARE)) == hash(Outline(SQUARE.tolist()))


# ------------------------------------------------------------------ what it refuses


BOW_TIE = [[0, 0], [1, 1], [1, 0], [0, 1]]
REFUSED: dict[str, tuple[Any, str]] = {
    "nothing": (None, r"pairs of numbers \[x, y\]; found an array \(\)"),
    "a number": (-1, r"pairs of numbers \[x, y\]; found an array \(\)"),
    "a flat list": ([0, 0, 1, 0, 1, 1], r"pairs of numbers \[x, y\]; found an array \(6,\)"),
    "points in space": (np.zeros((5, 3)), r"pairs of numbers .*\(5, 3\)"),
    "a list of rings": ([SQUARE, SQUARE], r"pairs of numbers .*\(2, 4, 2\)"),
    "rows of two lengths": ([[0, 0], [1], [1, 1]], r"pairs of numbers \[x, y\]"),
    "words": ([["left", "down"]] * 3, r"pairs of numbers \[x, y\]"),
    "an object": (object(), r"pairs of numbers \[x, y\]"),
    "no vertices": (np.zeros((0, 2)), r"has 0 different vertices; at least 3"),
    "one vertex": ([[1, 1]], r"has 1 different vertices; at least 3"),
    "one vertex, repeated": ([[1, 1]] * 5, r"has 1 different vertices; at least 3"),
    "a line there and back": ([[0, 0], [2, 1], [0, 0]], r"has 2 different vertices; at least 3"),
    "not a number": ([[0, 0], [1, 0], [math.nan, 1]], r"vertex 2 is \[nan, 1.0\]; must be finite"),
    "infinite": ([[0, 0], [1, -math.inf], [0, 1]], r"vertex 1 is \[1.0, -inf\]; must be finite"),
    "too far": (
        [[0, 0], [1, 0], [0, 2 * LARGEST_COORDINATE]],
        r"vertex 2 is \[0.0, 2\d+.0\]; coordinates up to 1e\+12 are allowed",
    ),
    "collinear": ([[0, 0], [1, 1], [2, 2]], r"not simple|no area"),
    "a hair": ([[0, 0], [1, 0], [0.5, 9e-13]], r"no area"),
    "a bow tie": (BOW_TIE, r"not simple: Self-intersection\[0\.5 0\.5\]"),
    "a spike inward": ([[0, 0], [2, 0], [1, 0], [1, 1]], r"not simple: Self-intersection\[2 0\]"),
    "a spike outward": (
        [[0, 0], [1, 0], [1, 1], [1, 2], [1, 1], [0, 1]],
        r"not simple: .*\[1 1\]",
    ),
    "two corners that touch": (
        [[0, 0], [1, 0], [0.5, 0.5], [1, 1], [0, 1], [0.5, 0.5]],
        r"not simple: .*\[0\.5 0\.5\]",
    ),
    "a corner on an edge": ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], r"not simple: .*\[1 0\]"),
    "a hole on a bridge": (
        [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1], [1, 1]],
        r"not simple",
    ),
    "a ring run twice": (np.vstack([SQUARE, SQUARE]), r"not simple"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str) -> None:
    vertices, message = REFUSED[name]
    with pytest.raises(OutlineError, match=message):
        Outline(vertices)
    assert issubclass(OutlineError, InputError)


def test_the_most_vertices() -> None:
    assert len(Outline(circle(MAX_VERTICES))) == MAX_VERTICES
    with pytest.raises(OutlineError, match=rf"{MAX_VERTICES + 1} vertices; at most {MAX_VERTICES}"):
        Outline(circle(MAX_VERTICES + 1))


def test_the_largest_coordinate_itself_is_allowed() -> None:
    assert len(Outline([[0, 0], [LARGEST_COORDINATE, 0], [0, LARGEST_COORDINATE]])) == 3


def test_complex_numbers_are_no_coordinates() -> None:
    with pytest.raises(OutlineError, match="pairs of numbers"):
        Outline(SQUARE * (1.0 + 1.0j))


def test_strings_are_no_coordinates() -> None:
    with pytest.raises(OutlineError, match="pairs of numbers"):
        Outline([["0", "0"], ["1", "0"], ["0", "1"]])


@given(seeds)
def test_a_random_tour_is_refused_exactly_when_edges_cross(seed: int) -> None:
    """Against exact arithmetic on small integers: every pair of edges, shared ends aside."""
    ring = np.random.default_rng(seed).integers(0, 12, (6, 2))
    if len({tuple(p) for p in ring.tolist()}) < 6:
        return
    if is_simple(ring.tolist()):
        assert len(Outline(ring)) == 6
    else:
        with pytest.raises(OutlineError):
            Outline(ring)


def is_simple(ring: list[list[int]]) -> bool:
    n = len(ring)
    for i in range(n):
        for j in range(i + 1, n):
            a, b, c, d = ring[i], ring[(i + 1) % n], ring[j], ring[(j + 1) % n]
            if j == i + 1:
                if folds(a, b, d):
                    return False
            elif (j + 1) % n == i:
                if folds(c, d, b):
                    return False
            elif meets(a, b, c, d):
                return False
    return True


def side(a: list[int], b: list[int], c: list[int]) -> int:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def folds(a: list[int], b: list[int], c: list[int]) -> bool:
    """Whether the edge from b to c runs back over the one from a to b."""
    back = (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1])
    return side(a, b, c) == 0 and back > 0


def meets(a: list[int], b: list[int], c: list[int], d: list[int]) -> bool:
    turns = np.sign([side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)]).tolist()
    if turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0:
        return True
    return any(
        turn == 0 and min(p[0], q[0]) <= r[0] <= max(p[0], q[0])
        and min(p[1], q[1]) <= r[1] <= max(p[1], q[1])
        for turn, (p, q, r) in zip(
            turns, [(a, b, c), (a, b, d), (c, d, a), (c, d, b)], strict=True
        )
    )  # fmt: skip
