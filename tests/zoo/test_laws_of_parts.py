"""Laws of what plans are made of, which hold for any object: searches, forces, geometry."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely

from icage.discs.offsets import arcs, directions_on_arcs, offsets
from icage.geometry.exterior import exterior_pieces, without_straight_vertices
from icage.geometry.statics import balance, contact_normals, free_fingers
from icage.grasps.features import EDGE, VERTEX, balanced_triples, features_of
from icage.grasps.kernels.hands import HandLimits
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Wanted
from icage.hand_sublevels import sublevels
from icage.planner import plan
from icage.tolerance import MERGE_VERTEX
from tests.zoo.shapes import VALID
from tests.zoo.specimens import EXACT, MOST_VERTICES, RADIUS, Specimen, specimen


def _grasp_search(one: Specimen) -> None:
    """A candidate's levels are those of its plan; the whole search is run on the small shapes."""
    if one.candidate is None:
        return
    assert one.candidate.sigma_0 == pytest.approx(one.cage.sigma_0, rel=EXACT)
    if len(one.ring) <= MOST_VERTICES:
        best = best_grasps(
            one.outline, top=1, wanted=Wanted(limits=ANY_HAND), rng=np.random.default_rng(0)
        )[0]
        assert best.sigma_0 < best.level
        assert best.score >= one.candidate.score
        assert plan(one.outline, best.contacts).status != "not_a_cage"


def _grasps_of_hand(one: Specimen) -> None:
    told = grasps_of_hand(one.outline, one.cage.hand)
    off = [np.abs(c - one.cage.contacts).max() for c in told]
    assert min(off) <= 1e-7 * one.size
    for grasp in one.cage.grasps:
        if grasp.plateau is None:
            assert min(np.abs(c - grasp.contacts).max() for c in told) <= 1e-7 * one.size


def _sublevels_of_hand(one: Specimen) -> None:
    """Target and grasps of a cage are among all minima; the target escapes where the cage does."""
    cage = one.cage
    found = sublevels(one.outline, cage.hand)
    assert (found.merges > found.births).all()
    gaps = found.contacts[:, 1] - found.contacts[:, 0]
    assert np.abs(np.hypot(*gaps.T) - found.births).max() <= 1e-9 * one.size
    # symmetric objects have several minima of one level
    target = np.abs(found.births - cage.sigma_0) <= 1e-9 * one.size
    escape = np.inf if cage.sigma_max is None else cage.sigma_max
    apart = np.abs(found.escapes[target] - escape) if np.isfinite(escape) else 0.0
    assert (found.escapes[target] == escape).any() or np.min(apart) <= 1e-9 * one.size
    for grasp in cage.grasps:
        assert np.abs(found.births - grasp.sigma).min() <= 1e-9 * one.size


def _features(one: Specimen) -> None:
    """Edges as drawn (a cut edge is two), and every concave vertex in two readings."""
    features = features_of(one.outline)
    assert (features.kind == EDGE).sum() == len(one.outline)
    back = np.roll(one.ring.tangents, 1, axis=0)
    ahead = one.ring.tangents
    turn = back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0]
    assert (features.kind == VERTEX).sum() == 2 * (turn < -1e-6).sum()
    triples, points = balanced_triples(features, one.outline, HandLimits.apart(1e-3 * one.size))
    assert len(triples) == len(points)
    assert one.candidate is None or len(triples) > 0


def _statics(one: Specimen) -> None:
    work = balance(one.outline, one.cage.contacts, 1e-6 * one.size)
    assert work is not None
    assert work > 0.0
    assert free_fingers(one.outline, one.cage.contacts) == ()
    for p in one.cage.contacts:
        assert contact_normals(one.outline, p, 1e-6 * one.size)


def _exterior_pieces(one: Specimen) -> None:
    """Convex, counterclockwise, and together the box without the object."""
    pieces, origin = exterior_pieces(one.outline, one.cage.hand)
    corners = np.column_stack([pieces.x, pieces.y])
    area = 0.0
    for k in range(pieces.total):
        ring = corners[pieces.slot_vertex[pieces.ptr[k] : pieces.ptr[k + 1]]]
        side = np.roll(ring, -1, axis=0) - ring
        after = np.roll(side, -1, axis=0)
        turn = side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0]
        lengths = np.hypot(*side.T) * np.hypot(*after.T)
        assert (turn >= -1e-9 * lengths).all()
        x, y = (ring - ring[0]).T
        area += 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    width, height = corners.max(0) - corners.min(0)
    missing = width * height - area
    assert missing == pytest.approx(one.outline.area, abs=1e-9 * width * height)
    assert np.abs(origin - one.outline.vertices[0]).max() == 0.0


def _offsets(one: Specimen) -> None:
    far = float(np.abs(one.outline.vertices).max()) / one.size
    kept = without_straight_vertices(one.outline.vertices, one.size)
    merged = MERGE_VERTEX if len(kept) < len(one.outline) else 0.0
    slack = (1e-12 + 1e-15 * far + merged) * one.size
    for radius in (0.003 * one.size, RADIUS * one.size, 0.3 * one.size):
        grown = offsets(one.outline, radius, 8)
        for polygon, low, high in (
            (grown.inner, radius - grown.sagitta, radius),
            (grown.outer, radius, radius * radius / (radius - grown.sagitta)),
        ):
            gap = shapely.distance(shapely.points(polygon.vertices), one.outline.polygon)
            assert gap.min() >= low - slack
            assert gap.max() <= high * (1.0 + 1e-9) + slack
        turned = sum(arc.turn for arc in arcs(one.outline, radius))
        assert turned >= 2.0 * np.pi - 1e-6
    if one.discs is not None:
        told = directions_on_arcs(one.outline, one.discs.finger_radius, one.discs.contacts)
        assert all(len(v) <= len(one.discs.contacts) for v in told.values())


LAWS: dict[str, Callable[[Specimen], None]] = {
    "best_grasps": _grasp_search,
    "grasps_of_hand": _grasps_of_hand,
    "sublevels": _sublevels_of_hand,
    "contact features": _features,
    "balance of forces": _statics,
    "exterior_pieces": _exterior_pieces,
    "offsets": _offsets,
}
"""A new function is one line: its name and a check of one specimen."""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [shape.name for shape in VALID])
def test_law(name: str, law: str) -> None:
    LAWS[law](specimen(name))
