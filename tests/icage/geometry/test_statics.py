"""icage/geometry/statics.py against forces solved another way (tests/oracles/statics.py)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from icage.geometry.statics import (
    balance,
    contact_normals,
    contacts_reason,
    free_fingers,
    no_depth_reason,
    slide_reason,
)
from icage.outline import Outline
from icage.tolerance import CONTACT_OFF, FREE_FINGER
from models import CASES
from tests.oracles.geometry import Floats, Ring, load_case, row, unit_hand
from tests.oracles.polygons import FAMILIES, rotated
from tests.oracles.statics import squeezing_forces, touch
from tests.oracles.targets import random_target

seeds = st.integers(0, 2**32 - 1)
families = st.sampled_from(sorted(FAMILIES))
TRIANGLE = Outline([[0, 0], [1, 0], [0.5, math.sqrt(0.75)]])
MIDDLES = 0.5 * (TRIANGLE.vertices + np.roll(TRIANGLE.vertices, -1, axis=0))
SQUARE = Outline([[0, 0], [1, 0], [1, 1], [0, 1]])
HOUR_GLASS = Outline([[0, 0], [4, 0], [3, 2], [4, 4], [0, 4], [1, 2]])


def reason(outline: Outline, contacts: Floats) -> str:
    return contacts_reason(outline, contacts).split(":")[0]


# ------------------------------------------------------------------ normals


@given(families, seeds)
def test_normals_are_those_of_the_edges_near_by(family: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ring = Ring.of(FAMILIES[family](rng))
    outline = Outline(ring.vertices)
    for point in (*ring.vertices, *rng.uniform(ring.vertices.min(0), ring.vertices.max(0), (5, 2))):
        distance = ring.nearest_on_edges(point)[1]
        reach = float(rng.choice([1e-6, 0.05, 0.3])) * ring.diameter
        assume(np.abs(distance - reach).min() > 1e-12 * ring.diameter)
        found = np.array(contact_normals(outline, point, reach)).reshape(-1, 2)
        assert found == pytest.approx(-ring.normals[distance <= reach], abs=1e-12)


def test_two_normals_at_a_vertex_and_none_in_the_open() -> None:
    assert np.array(contact_normals(SQUARE, np.array([1.0, 0.0]), 1e-9)).tolist() == [
        [0.0, 1.0],
        [-1.0, 0.0],
    ]
    assert len(contact_normals(SQUARE, np.array([0.5, 0.0]), 1e-9)) == 1
    assert contact_normals(SQUARE, np.array([0.5, 0.5]), 1e-9) == []


# ------------------------------------------------------------------ balance


def edge_contacts(ring: Ring, rng: np.random.Generator) -> tuple[Floats, Floats] | None:
    """Three contacts on edges whose inward normals meet in one point, and these normals."""
    centre = rng.uniform(ring.vertices.min(0), ring.vertices.max(0))
    along = ((centre - ring.starts) * ring.tangents).sum(1)
    on = np.flatnonzero((along > 0.01 * ring.lengths) & (along < 0.99 * ring.lengths))
    if len(on) < 3:
        return None
    e = rng.choice(on, 3, replace=False)
    return ring.starts[e] + along[e, None] * ring.tangents[e], -ring.normals[e]


@given(families, seeds)
def test_balance_of_three_edges_against_cross_products(family: str, seed: int) -> None:
    """Three concurrent forces balance with shares n_2 x n_3 : n_3 x n_1 : n_1 x n_2."""
    rng = np.random.default_rng(seed)
    ring = Ring.of(FAMILIES[family](rng))
    drawn = edge_contacts(ring, rng)
    assume(drawn is not None)
    contacts, n = drawn  # type: ignore[misc]
    share = np.array([np.linalg.det([n[1], n[2]]), np.linalg.det([n[2], n[0]]),
                      np.linalg.det([n[0], n[1]])])  # fmt: skip
    share = share if share.sum() > 0.0 else -share
    assume(np.abs(share).min() > 1e-2)
    work = balance(Outline(ring.vertices), contacts, CONTACT_OFF * ring.diameter)
    if share.min() < 0.0:
        assert work is None
        return
    share /= share.sum()
    wanted = -float((share[:, None] * n * contacts).sum()) / ring.diameter
    assert work == pytest.approx(wanted, abs=1e-3)  # the slack of 1e-6 over shares of 1e-2


@pytest.mark.parametrize("radius", [0.0, 0.05])
@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_grasps_that_squeeze_do_positive_work(family: str, radius: float) -> None:
    """Random immobilizing grasps of the oracle, which solves for squeezing forces by itself."""
    rng = np.random.default_rng(17)
    for _ in range(8):
        target = random_target(rng, family, radius)
        ring = Ring.of(target.vertices)
        touches = [touch(ring, p, target.radius, 1e-9 * ring.diameter) for p in target.contacts]
        assert all(t is None or len(t.choices) == 1 for t in touches)
        hand = unit_hand(target.contacts)
        rows = np.array([row(n, hand[k]) for k, t in enumerate(touches) if t for n in t.choices[0]])
        w = target.contacts[1] - target.contacts[0]
        assert squeezing_forces(rows, w)[1] < 1e-7
        if radius == 0.0:
            work = balance(Outline(ring.vertices), target.contacts, CONTACT_OFF * ring.diameter)
            assert work is not None
            assert work > 0.0


def test_the_work_of_a_known_grasp() -> None:
    """Middles of an equilateral triangle: equal forces, each along an arm of sqrt(3)/6."""
    assert balance(TRIANGLE, MIDDLES, 1e-6) == pytest.approx(math.sqrt(3.0) / 6.0, abs=1e-5)
    turned = balance(TRIANGLE, MIDDLES[[1, 2, 0]], 1e-6)
    assert turned == pytest.approx(balance(TRIANGLE, MIDDLES, 1e-6), rel=1e-12)


@given(st.floats(-math.pi, math.pi), st.floats(-50.0, 50.0), st.sampled_from([1e-3, 1.0, 1e3]))
def test_balance_does_not_depend_on_frame_or_unit(turn: float, far: float, unit: float) -> None:
    moved = [unit * rotated(p, turn, (far, -far)) for p in (TRIANGLE.vertices, MIDDLES)]
    work = balance(Outline(moved[0]), moved[1], CONTACT_OFF * unit)
    assert work == pytest.approx(math.sqrt(3.0) / 6.0, abs=2e-5)


def test_collinear_vertices_change_nothing() -> None:
    ring = np.stack([TRIANGLE.vertices, MIDDLES], axis=1).reshape(-1, 2)
    assert balance(Outline(ring), MIDDLES, 1e-6) == pytest.approx(math.sqrt(3.0) / 6.0, abs=1e-5)


def test_nothing_balances() -> None:
    off = MIDDLES + [[0.1, 0.0], [0.0, 0.0], [0.0, 0.0]]
    assert balance(TRIANGLE, off, 1e-6) is None
    assert balance(SQUARE, np.array([[0.2, 0.0], [0.5, 0.0], [0.8, 0.0]]), 1e-6) is None
    assert balance(SQUARE, np.array([[0.5, 0.5], [0.6, 0.5], [0.5, 0.6]]), 1e-6) is None


@given(st.floats(1e-4, 0.3), st.integers(0, 2))
def test_an_error_of_concurrency_is_seen(off: float, finger: int) -> None:
    contacts = MIDDLES.copy()
    edge = TRIANGLE.vertices[(finger + 1) % 3] - TRIANGLE.vertices[finger]
    contacts[finger] += off * edge
    assert balance(TRIANGLE, contacts, 1e-6) is None


def test_the_largest_work_of_several_is_told() -> None:
    """Two fingers in the waist of an hour glass, the third in the open: four edges push.

    All are as steep, 2 : 1, so a total force of 1 pushes with 2 / sqrt(5) along the waist of 2.
    """
    waist = np.array([[1.0, 2.0], [3.0, 2.0], [2.0, 9.0]])
    work = balance(HOUR_GLASS, waist, 1e-6)
    assert work == pytest.approx(2.0 / math.sqrt(5.0) / HOUR_GLASS.diameter, abs=1e-5)


# ------------------------------------------------------------------ sentences


def test_sentences() -> None:
    off = MIDDLES + [[0.1, 0.0], [0.0, 0.0], [0.0, 0.0]]
    assert reason(TRIANGLE, off) == "no equilibrium"
    assert reason(TRIANGLE, MIDDLES) == "no strict local minimum"
    told = contacts_reason(SQUARE, np.array([[0.0, 0.5], [1.0, 0.5], [0.5, 2.0]]), slide=0.25)
    assert told == slide_reason(0.25, SQUARE.diameter)
    assert "0.25 long, 0.177 of the diameter" in told
    assert "sigma_max / sigma_0 - 1 = 3e-11" in no_depth_reason(1.0 + 3e-11)


def test_fingers_that_pull_apart_are_stretching() -> None:
    """Fingers inside a slot, on walls that face each other: forces balance, closing lets go."""
    slot = Outline([[0, 0], [4, 0], [4, 3], [3, 3], [3, 1], [1, 1], [1, 3], [0, 3]])
    inside = np.array([[1.0, 2.0], [3.0, 2.0], [2.0, 5.0]])
    work = balance(slot, inside, 1e-6)
    assert work == pytest.approx(-1.0 / slot.diameter, abs=1e-5)
    assert reason(slot, inside) == "stretching"


# ------------------------------------------------------------------ free fingers


@pytest.mark.parametrize(
    "name", sorted(p.stem for p in CASES.glob("*.json") if "disc" not in p.stem)
)
def test_no_finger_of_a_case_is_free(name: str) -> None:
    data = load_case(name)
    contacts = np.array(data["grasp"]["contacts"])
    outline = Outline(data["outline"]["vertices"])
    ring = Ring.of(data["outline"]["vertices"])
    gap = np.array([ring.nearest_on_edges(p)[1].min() for p in contacts])
    expected = tuple(int(k) + 1 for k in np.flatnonzero(gap > FREE_FINGER * ring.diameter))
    assert free_fingers(outline, contacts) == expected


@given(families, seeds)
def test_free_fingers_are_those_off_the_outline(family: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ring = Ring.of(FAMILIES[family](rng))
    e = rng.integers(len(ring), size=3)
    on = ring.starts[e] + (rng.random(3) * ring.lengths[e])[:, None] * ring.tangents[e]
    off = np.where(rng.random(3) < 0.5, 3e-7, 1e-9) * ring.diameter
    points = on + off[:, None] * ring.normals[e]
    gap = np.array([ring.nearest_on_edges(p)[1].min() for p in points])
    assume(np.abs(gap - FREE_FINGER * ring.diameter).min() > 1e-9 * ring.diameter)
    expected = tuple(int(k) + 1 for k in np.flatnonzero(gap > FREE_FINGER * ring.diameter))
    assert free_fingers(Outline(ring.vertices), points) == expected
