"""The grasps that are found, against forces solved another way and a dense enumeration."""

from __future__ import annotations

import math
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from icage.cage import Cage
from icage.discs.offsets import offsets
from icage.discs.true_curve import refine
from icage.errors import GraspError, InputError
from icage.grasps.features import EDGE, VERTEX, balanced_triples, features_of
from icage.grasps.kernels.hands import HandLimits
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Aim, Candidate, Wanted
from icage.hand import HandShape
from icage.outline import Outline
from icage.planner import plan
from tests.oracles.geometry import Floats, Ring, unit_hand
from tests.oracles.grasps import (
    APART,
    carriers,
    counterclockwise,
    grid_grasps,
    is_fair_hand,
    one_edge_grasps,
)
from tests.oracles.minima import all_minima
from tests.oracles.polygons import FAMILIES, random_polygon, rotated
from tests.oracles.statics import is_strict_minimum

AIMS: tuple[Aim, ...] = ("first", "cage")
SMALL: dict[str, Floats] = {
    name: np.array(ring, dtype=np.float64)
    for name, ring in {
        "triangle": [[0, 0], [1, 0], [0.4, 0.8]],
        "quadrilateral": [[0, 0], [1.3, 0.1], [1.1, 0.9], [0.1, 0.7]],
        "dart": [[0, 0], [2, 0], [0.7, 0.6], [0, 2]],
        "house": [[0, 0], [1, 0], [1, 0.7], [0.5, 1.2], [0, 0.7]],
        "notched": [[0, 0], [4, 0], [4, 2], [2, 1], [0, 2]],
        "boat": [[0, 0], [6, 0], [6, 1], [3, 0.3], [0, 1]],
        "arrow": [[0, 0], [2, 0], [2.5, 1], [2, 2], [0, 2], [0.8, 1]],
        "hour glass": [[0, 0], [2, 0], [1.4, 1], [2, 2], [1, 2.4], [0, 2], [0.6, 1]],
        "slit": [[0, 0], [4, 0], [4, 3], [2.2, 3], [2, 0.5], [1.8, 3], [0, 3]],
        "L": [[0, 0], [2, 0], [2, 0.7], [0.7, 0.7], [0.7, 2], [0, 2]],
    }.items()
}
_rng = np.random.default_rng(15)
SMALL["random 15"] = random_polygon(_rng, int(_rng.integers(4, 8)))
DISC_SHAPES = ("triangle", "dart", "notched", "L", "hour glass")
RADIUS = 0.05
"""[diameter]"""
families = st.sampled_from(["random", "star", "tool", "lattice", "rectilinear"])
seeds = st.integers(0, 2**32 - 1)


@cache
def found(name: str, aim: Aim, radius: float = 0.0, top: int = 6) -> tuple[Candidate, ...]:
    """The search's answer, once for all tests; ``radius`` is in diameters."""
    outline = Outline(SMALL[name])
    rng = np.random.default_rng(0)
    r = radius * outline.diameter
    return tuple(
        best_grasps(outline, finger_radius=r, top=top, wanted=Wanted(aim, limits=ANY_HAND), rng=rng)
    )  # fmt: skip


def score(cage: Cage, aim: Aim) -> float:
    """What the search ranks, from the plan of the same grasp."""
    if cage.status == "not_a_cage":
        return 0.0
    last = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
    first = last if cage.sigma_first is None else cage.sigma_first
    level = first if aim == "first" else last
    assert level is not None
    return level / cage.sigma_0


# ------------------------------------------------------------------ every grasp that is found


every_search = pytest.mark.parametrize(
    ("name", "aim"), [(name, aim) for name in SMALL for aim in AIMS]
)


@every_search
def test_the_contacts_of_points_are_those_of_a_grasp_that_holds(name: str, aim: Aim) -> None:
    ring = Ring.of(SMALL[name])
    for grasp in found(name, aim):
        # margin 0: the best grasp is often the last one before the forces cease to hold
        assert is_strict_minimum(ring, grasp.contacts, tol=1e-9, margin=0.0)


@every_search
def test_points_hold_and_the_plan_gives_the_same_levels(name: str, aim: Aim) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    grasps = found(name, aim)
    scores = [g.score for g in grasps]
    assert scores == sorted(scores, reverse=True)
    for grasp in grasps:
        cage = plan(outline, grasp.contacts)
        assert cage.status != "not_a_cage"
        assert is_strict_minimum(ring, cage.contacts, tol=1e-9, margin=0.0)
        assert score(cage, aim) == pytest.approx(grasp.score, rel=1e-9)
        assert grasp.sigma_0 == pytest.approx(cage.sigma_0, rel=1e-9)
        assert grasp.sigma_0 < grasp.level == pytest.approx(grasp.score * grasp.sigma_0)
        assert is_fair_hand(grasp.contacts, outline.diameter * (1.0 - 1e-9))


def on_true_curve(name: str, grasp: Candidate) -> Floats:
    """The grasp as found if it holds; else (contacts on chords) solved on the true curve."""
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    if is_strict_minimum(ring, grasp.contacts, r, tol=1e-9, margin=0.0):
        return grasp.contacts
    solved = refine(outline, HandShape.from_contacts(grasp.contacts), r, grasp.contacts)
    assert solved is not None
    off = np.linalg.norm(solved - grasp.contacts, axis=1).max()
    assert off <= 4.0 * offsets(outline, r, 16).sagitta + 1e-5 * ring.diameter
    return solved


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", DISC_SHAPES)
def test_discs_hold_on_the_true_curve(name: str, aim: Aim) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    sagitta = offsets(outline, r, 16).sagitta
    for grasp in found(name, aim, RADIUS):
        for p in grasp.contacts:
            assert abs(ring.depth(p, r)) <= sagitta + 1e-9 * ring.diameter
        contacts = on_true_curve(name, grasp)
        assert is_strict_minimum(ring, contacts, r, tol=1e-8, margin=0.0)


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", DISC_SHAPES)
def test_discs_on_the_true_curve_can_be_planned(name: str, aim: Aim) -> None:
    outline = Outline(SMALL[name])
    for grasp in found(name, aim, RADIUS):
        cage = plan(outline, on_true_curve(name, grasp), RADIUS * outline.diameter)
        assert cage.status != "not_a_cage"
        assert score(cage, aim) == pytest.approx(grasp.score, rel=2e-3)


@pytest.mark.parametrize("name", DISC_SHAPES)
def test_refining_leaves_a_grasp_that_holds_where_it_is(name: str) -> None:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    r = RADIUS * outline.diameter
    for grasp in found(name, "first", RADIUS):
        if not is_strict_minimum(ring, grasp.contacts, r, tol=1e-9, margin=0.0):
            continue
        solved = refine(outline, HandShape.from_contacts(grasp.contacts), r, grasp.contacts)
        assert solved is not None
        assert np.abs(solved - grasp.contacts).max() <= 1e-9 * ring.diameter


def test_no_two_grasps_are_nearly_the_same() -> None:
    for name in SMALL:
        for one, other in combinations(found(name, "first"), 2):
            copies = [np.roll(one.contacts, k, axis=0) for k in range(len(one.contacts))]
            apart = [np.linalg.norm(c - other.contacts, axis=1).max() for c in copies]
            assert min(apart) >= 0.08 * Outline(SMALL[name]).diameter


# ------------------------------------------------------------------ none better is missed


@cache
def enumerated(name: str) -> tuple[Cage, ...]:
    ring, outline = Ring.of(SMALL[name]), Outline(SMALL[name])
    grasps = [contacts for _, contacts in grid_grasps(ring, 20)]
    grasps += list(one_edge_grasps(ring, 6))
    return tuple(plan(outline, contacts) for contacts in grasps)


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", SMALL)
def test_no_grasp_of_a_dense_grid_is_better(name: str, aim: Aim) -> None:
    best = max(score(cage, aim) for cage in enumerated(name))
    assert best > 1.0
    assert found(name, aim)[0].score >= best * (1.0 - 1e-6)


@pytest.mark.parametrize("name", SMALL)
def test_nearly_all_grasps_of_the_grid_are_cages(name: str) -> None:
    """The oracle's strict minima are the planner's: shallow ones alone may fall to the cut."""
    verdicts = [cage.status for cage in enumerated(name)]
    assert len(verdicts) >= 8
    assert verdicts.count("not_a_cage") == 0


@pytest.mark.parametrize("name", SMALL)
def test_the_largest_cage_is_no_smaller_than_the_largest_first(name: str) -> None:
    """The winner by sigma_first has a cage at least as large: the winner by cage is no smaller."""
    first = found(name, "first")[0]
    largest = score(plan(Outline(SMALL[name]), first.contacts), "cage")
    assert found(name, "cage")[0].score >= largest * (1.0 - 1e-3)


# ------------------------------------------------------------------ what was asked for


@pytest.mark.parametrize("name", ["notched", "hour glass"])
def test_wanted_corners(name: str) -> None:
    outline, ring = Outline(SMALL[name]), Ring.of(SMALL[name])
    wanted = Wanted("first", corners=1, limits=ANY_HAND)
    corners = ring.vertices[ring.concave]
    grasps = best_grasps(outline, top=4, wanted=wanted, rng=np.random.default_rng(0))
    for grasp in grasps:
        gaps = np.linalg.norm(grasp.contacts[:, None] - corners[None], axis=2)
        assert (gaps.min(axis=1) <= 1e-12 * ring.diameter).sum() >= 1


@pytest.mark.parametrize("name", ["triangle", "notched"])
def test_wanted_shape(name: str) -> None:
    """Read from any finger, within the angle that was asked."""
    first = found(name, "first")[0]
    phi = HandShape.from_contacts(first.contacts).phi
    near = (phi[0] + 0.01, phi[1] - 0.01, 0.03)
    for grasp in best_grasps(
        Outline(SMALL[name]), wanted=Wanted("first", near=near), rng=np.random.default_rng(0)
    ):
        hand = HandShape.from_contacts(grasp.contacts)
        errors = [
            max(abs(a - b) for a, b in zip(hand.relabelled(k).phi, near[:2], strict=True))
            for k in range(len(hand.z))
        ]
        assert min(errors) <= near[2] + 1e-12


def test_top_is_the_beginning_of_a_longer_list() -> None:
    whole = found("hour glass", "first")
    any_hand = Wanted(limits=ANY_HAND)
    few = best_grasps(
        Outline(SMALL["hour glass"]), top=2, wanted=any_hand, rng=np.random.default_rng(0)
    )
    assert [same_as(c) for c in few] == [same_as(c) for c in whole[:2]]
    with pytest.raises(InputError, match=r"top = 0; at least 1 is needed"):
        best_grasps(Outline(SMALL["triangle"]), top=0, rng=np.random.default_rng(0))


def test_an_outline_without_such_a_grasp() -> None:
    with pytest.raises(GraspError, match="no immobilizing three-finger grasp was found"):
        best_grasps(
            Outline(SMALL["triangle"]), wanted=Wanted(corners=1), rng=np.random.default_rng(0)
        )


# ------------------------------------------------------------------ the same again


def same_as(candidate: Candidate) -> tuple[object, ...]:
    return candidate.contacts.tobytes(), candidate.triple, candidate.score, candidate.level


def test_the_same_seed_gives_the_same_list_with_any_number_of_workers() -> None:
    outline = Outline(SMALL["dart"])
    lists = [
        best_grasps(outline, top=5, rng=np.random.default_rng(3), workers=w) for w in (1, 1, 2)
    ]
    first, again, two = ([same_as(c) for c in answer] for answer in lists)
    assert len(first) == 5
    assert again == first
    assert two == first


@pytest.mark.parametrize("name", ["triangle", "dart", "notched", "hour glass"])
@pytest.mark.parametrize("change", ["turned", "moved", "scaled", "rolled", "clockwise"])
def test_the_best_score_does_not_depend_on_frame_unit_or_start(name: str, change: str) -> None:
    """The random steps differ, so the ends of the improvement may, by what it stops at."""
    ring = SMALL[name]
    other = {
        "turned": rotated(ring, 1.0),
        "moved": ring + [30.0, -70.0],
        "scaled": 1e-3 * ring,
        "rolled": np.roll(ring, 2, axis=0),
        "clockwise": ring[::-1],
    }[change]
    any_hand = Wanted(limits=ANY_HAND)
    best = best_grasps(Outline(other), top=1, wanted=any_hand, rng=np.random.default_rng(0))[0]
    assert best.score == pytest.approx(found(name, "first")[0].score, rel=1e-3)


# ------------------------------------------------------------------ all grasps of one hand


def unmatched(some: list[Floats], others: list[Floats], within: float) -> list[Floats]:
    return [a for a in some if not any(np.abs(a - b).max() <= within for b in others)]


def check_all_of(ring: Ring, hand: HandShape) -> int:
    strict = [m.contacts for m in all_minima(ring, hand.z) if not m.plateau]
    told = grasps_of_hand(Outline(ring.vertices), hand)
    within = 1e-7 * ring.diameter
    assert unmatched(told, strict, within) == []
    assert unmatched(strict, told, within) == []
    sigma = [float(np.hypot(*(c[1] - c[0]))) for c in told]
    assert np.diff(sigma).min(initial=0.0) >= -1e-9 * ring.diameter
    return len(told)


@pytest.mark.parametrize("name", SMALL)
def test_all_grasps_of_a_hand_on_small_outlines(name: str) -> None:
    """The hands of the best grasps, so that each has at least its own."""
    ring = Ring.of(SMALL[name])
    for grasp in found(name, "first")[:2]:
        hand = HandShape.from_contacts(grasp.contacts)
        assert check_all_of(ring, hand) >= 1
        told = grasps_of_hand(Outline(ring.vertices), hand)
        held = plan(Outline(ring.vertices), grasp.contacts).contacts
        assert unmatched([held], told, 1e-7 * ring.diameter) == []


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.floats(-0.3, 1.3), st.floats(0.3, 1.5), st.integers(3, 7))
def test_all_grasps_of_any_hand_on_random_polygons(
    seed: int, x: float, y: float, corners: int
) -> None:
    check_all_of(
        Ring.of(random_polygon(np.random.default_rng(seed), corners)), HandShape(complex(x, y))
    )


@pytest.mark.parametrize("name", ["triangle", "notched"])
def test_all_grasps_of_a_hand_on_a_grown_outline(name: str) -> None:
    """Discs: the polygon that stands for the grown object, its chords as edges like all others."""
    outline = Outline(SMALL[name])
    grown = offsets(outline, RADIUS * outline.diameter, 1).inner
    hand = HandShape.from_contacts(found(name, "first", RADIUS)[0].contacts)
    assert check_all_of(Ring.of(grown.vertices), hand) >= 1


@pytest.mark.parametrize("name", ["triangle", "notched", "L", "hour glass"])
@pytest.mark.parametrize("first", [1, 2])
def test_another_finger_first_gives_the_same_grasps(name: str, first: int) -> None:
    outline = Outline(SMALL[name])
    hand = HandShape.from_contacts(found(name, "first")[0].contacts)
    one = [np.roll(c, -first, axis=0) for c in grasps_of_hand(outline, hand)]
    other = grasps_of_hand(outline, hand.relabelled(first))
    within = 1e-8 * outline.diameter
    assert unmatched(one, other, within) == unmatched(other, one, within) == []


@pytest.mark.parametrize("name", ["triangle", "notched", "hour glass"])
def test_a_turned_outline_has_the_turned_grasps(name: str) -> None:
    hand = HandShape.from_contacts(found(name, "first")[0].contacts)
    one = [rotated(c, 2.0, (5.0, 1.0)) for c in grasps_of_hand(Outline(SMALL[name]), hand)]
    turned = Outline(rotated(SMALL[name], 2.0, (5.0, 1.0)))
    other = grasps_of_hand(turned, hand)
    within = 1e-8 * turned.diameter
    assert unmatched(one, other, within) == unmatched(other, one, within) == []


def test_too_many_pieces_are_refused() -> None:
    turn = 2.0 * np.pi * np.arange(700) / 700
    size = np.where(np.arange(700) % 2, 1.0, 0.9)[:, None]
    gear = Outline(size * np.column_stack([np.cos(turn), np.sin(turn)]))
    with pytest.raises(InputError, match=r"needs \d+ pieces; up to 250 are allowed"):
        grasps_of_hand(gear, HandShape.from_angles_deg(60.0, 120.0))


# ------------------------------------------------------------------ features and triples


@given(families, seeds)
def test_features_are_the_edges_and_the_concave_vertices(family: str, seed: int) -> None:
    ring = Ring.of(FAMILIES[family](np.random.default_rng(seed)))
    found_features = features_of(Outline(ring.vertices))
    edges = found_features.number[found_features.kind == EDGE]
    corners = found_features.number[found_features.kind == VERTEX]
    assert edges.tolist() == list(range(len(ring)))
    assert sorted(corners.tolist()) == sorted([*np.flatnonzero(ring.concave)] * 2)


@settings(max_examples=40)
@given(families, seeds)
def test_a_point_is_allowed_where_the_features_can_push_through_it(family: str, seed: int) -> None:
    """Against the oracle's carriers, which solve for the shares of the two normals."""
    rng = np.random.default_rng(seed)
    ring = Ring.of(FAMILIES[family](rng))
    features = features_of(Outline(ring.vertices))
    for p in rng.uniform(-1.0, 2.0, (6, 2)) * ring.diameter + ring.vertices.min(0):
        wanted = {f for f, _ in carriers(ring, p)}
        spots = dict(carriers(ring, p))
        told = set()
        for k in range(len(features.kind)):
            one = np.array([k, k, k])
            if features.allows(one, p):
                kind = "edge" if features.kind[k] == EDGE else "vertex"
                told.add((kind, int(features.number[k])))
                at = features.contacts(one, p)[0]
                assert at == pytest.approx(
                    spots.get((kind, int(features.number[k])), at), abs=1e-9 * ring.diameter
                )
        assert told == wanted


@settings(max_examples=25)
@given(families, seeds)
def test_triples_that_are_proposed_do_balance_and_squeeze(family: str, seed: int) -> None:
    ring = Ring.of(FAMILIES[family](np.random.default_rng(seed)))
    outline = Outline(ring.vertices)
    features = features_of(outline)
    triples, points = balanced_triples(
        features, outline, HandLimits.apart(APART * outline.diameter)
    )
    for triple, p in zip(triples, points, strict=True):
        assert features.allows(triple, p)
        contacts = features.contacts(triple, p)
        forces = np.array([force_through(features.normal[f], features.kind[f], c, p)
                           for f, c in zip(triple, contacts, strict=True)])  # fmt: skip
        share = np.linalg.svd(forces.T)[2][-1]
        share = share if share.sum() > 0.0 else -share
        assert share.min() > 0.0
        assert float((share[:, None] * forces * contacts).sum()) < 0.0
        assert unit_hand(contacts)[2].imag > 0.0


def force_through(normal: Floats, kind: int, contact: Floats, p: Floats) -> Floats:
    """Inward force of a contact along its line to P."""
    if kind == EDGE:
        return normal
    way = (p - contact) / np.hypot(*(p - contact))
    return way if float(way @ normal) > 0.0 else -way


@settings(max_examples=25)
@given(families, seeds)
def test_every_triple_that_squeezes_somewhere_is_proposed(family: str, seed: int) -> None:
    """By the oracle's grid; hands that are hardly hands and slivers of places are left out.

    So are forces that are parallel or nearly so: they do not meet within the search's reach.
    """
    ring = Ring.of(FAMILIES[family](np.random.default_rng(seed)))
    assume(len(ring) <= 10)
    outline = Outline(ring.vertices)
    features = features_of(outline)
    triples, _ = balanced_triples(features, outline, HandLimits.apart(APART * outline.diameter))
    names = [
        frozenset(
            ("edge" if features.kind[k] == EDGE else "vertex", int(features.number[k]))
            for k in triple
        )
        for triple in triples
    ]
    met: dict[frozenset[tuple[str, int]], int] = {}
    for three, contacts in grid_grasps(ring, 24):
        if three in names or meet_within(ring, three, contacts):
            met[three] = met.get(three, 0) + 1
    missed = {three: times for three, times in met.items() if three not in names and times >= 3}
    assert missed == {}


def meet_within(ring: Ring, three: frozenset[tuple[str, int]], contacts: Floats) -> bool:
    """Whether forces that meet within 3 diameters of the middle balance at these contacts.

    At two concave vertices forces need not run through the grid's point; where they meet further
    away, or are parallel, the search does not look. On two edges their lines meet in that point.
    """
    edges = [e for kind, e in three if kind == "edge"]
    if not edges:
        return True
    if len(edges) != 1:
        side = ring.tangents[edges]
        return len(edges) == 3 or abs(side[0, 0] * side[1, 1] - side[0, 1] * side[1, 0]) > 1e-9
    n = ring.normals[edges[0]]
    held = int(np.argmin(np.abs((contacts - ring.starts[edges[0]]) @ n)))
    for t in np.linspace(-4.0, 4.0, 201) * ring.diameter:
        p = contacts[held] + t * n
        if np.hypot(*(p - Outline(ring.vertices).centroid)) > 2.9 * ring.diameter:
            continue
        at = dict(carriers(ring, p))
        if not three <= set(at):
            continue
        forces = np.array([force_of(ring, feature, at[feature], p) for feature in three])
        spots = np.array([at[feature] for feature in three])
        share = np.linalg.svd(forces.T)[2][-1]
        share = share if share.sum() > 0.0 else -share
        work = float((share[:, None] * forces * spots).sum())
        if share.min() > 1e-2 and work < -1e-2 * ring.diameter:
            return True
    return False


def force_of(ring: Ring, feature: tuple[str, int], contact: Floats, p: Floats) -> Floats:
    """Unit force into the object of an edge or a concave vertex, along the line through P."""
    kind, k = feature
    if kind == "edge":
        return -ring.normals[k]
    way = (p - contact) / np.hypot(*(p - contact))
    return way if float(way @ (ring.normals[k - 1] + ring.normals[k])) < 0.0 else -way


def test_counterclockwise_is_so_in_the_oracle() -> None:
    points = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]])
    assert unit_hand(counterclockwise(points))[2].imag > 0.0
    assert math.isclose(abs(unit_hand(points)[2]), 1.0)
