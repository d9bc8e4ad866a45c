"""What fingers can touch, and the triples of it that balance, against carriers and a grid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.features import EDGE, VERTEX, balanced_triples, features_of
from icage.grasps.kernels.hands import HandLimits
from icage.grasps.wanted import ANY_HAND, Wanted
from icage.outline import Outline
from tests.icage.grasps.small_outlines import DISC_SHAPES, RADIUS, SMALL
from tests.oracles.geometry import Floats, Ring, unit_hand
from tests.oracles.grasps import APART, carriers, counterclockwise, grid_grasps
from tests.oracles.polygons import FAMILIES

families = st.sampled_from(["random", "star", "tool", "lattice", "rectilinear"])
seeds = st.integers(0, 2**32 - 1)


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


@pytest.mark.parametrize("name", DISC_SHAPES)
def test_grasps_of_one_polygon_stand_on_features_of_another(name: str) -> None:
    """Of the offset drawn with more segments: corners of chords, but the same edges and arcs."""
    outline = Outline(SMALL[name])
    radius = RADIUS * outline.diameter
    rough = GraspEvaluator(outline, radius, Wanted(limits=ANY_HAND))
    fine = GraspEvaluator(outline, radius, Wanted(limits=ANY_HAND), segments=16)
    triples, points = rough.triples()
    found = rough.grasps(triples, points)
    assert len(found)
    same, at = rough.on_features(found)
    assert same.tolist() == found.triples.tolist()
    assert at.tolist() == found.points.tolist()
    triples, at = fine.on_features(found)
    assert at.tolist() == found.points.tolist()
    feet = fine.features.feet(at)
    for finger in range(3):
        stands = feet[np.arange(len(at)), triples[:, finger]]
        assert np.abs(stands - found.contacts[:, finger]).max() <= 0.1 * radius
    away = replace(found, contacts=found.contacts + [0.0, 3.0 * outline.diameter])
    assert len(fine.on_features(away)[0]) == 0
