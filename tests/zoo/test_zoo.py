"""Valid shapes of the zoo crossed with every public function, refused ones with every way in.

What is checked are laws that hold for any object. A new function is one line in ``LAWS`` (a name
and a check of one specimen), a new way in for an outline one line in ``DOORS``.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from icage.agreement import disagreements
from icage.cage import Cage
from icage.cells.membership import VERDICTS, query
from icage.cells.method import CELLS
from icage.cells.regions import FingerRegion, caging_regions, outer_bounds
from icage.cells.sublevels import births_and_merges
from icage.contact_space.method import ContactSpace
from icage.discs.offsets import arcs, directions_on_arcs, offsets
from icage.errors import GraspError, IcageError, InputError, OutlineError
from icage.formats.case_json import parse_case, parse_object
from icage.formats.json_out import json_text
from icage.formats.plan_json import plan_document, plan_summary
from icage.formats.query_json import query_document
from icage.geometry.exterior import exterior_pieces, without_straight_vertices
from icage.geometry.statics import balance, contact_normals, free_fingers
from icage.grasps.evaluator import GraspEvaluator
from icage.grasps.features import EDGE, VERTEX, balanced_triples, features_of
from icage.grasps.kernels.hands import HandLimits
from icage.grasps.of_one_hand import grasps_of_hand
from icage.grasps.search import best_grasps
from icage.grasps.wanted import ANY_HAND, Candidate, Wanted
from icage.hand import HandShape
from icage.method import Method
from icage.outline import Outline
from icage.planner import plan
from icage.tolerance import MERGE_VERTEX
from tests.oracles.geometry import Floats, Ring, unit_hand
from tests.oracles.path_check import path_facts
from tests.oracles.polygons import rotated
from tests.oracles.statics import is_strict_minimum
from tests.zoo.shapes import REFUSED, VALID, WITHOUT_GRASP, Shape

RADIUS = 0.02
"""[diameter] Of the disc fingers."""
MOST_VERTICES = 5
"""Up to here discs have their regions drawn and the whole search is run."""
TRIED = 60
"""Triples of features that are looked at for a specimen's grasp."""
EXACT = 1e-9
ROUNDING = 1e-9
"""[diameter] Contacts and paths."""


@dataclass(frozen=True, slots=True, eq=False)
class Specimen:
    """A shape with a grasp of point fingers and, where one was found, of discs."""

    shape: Shape
    outline: Outline
    ring: Ring
    cage: Cage
    discs: Cage | None
    candidate: Candidate | None

    @property
    def cages(self) -> list[Cage]:
        """The one or two cages, points first."""
        return [self.cage] if self.discs is None else [self.cage, self.discs]

    @property
    def size(self) -> float:
        """Diameter, [unit]."""
        return self.outline.diameter


def held(outline: Outline, ring: Ring, radius: float) -> Candidate | None:
    """The best of a few grasps that hold beyond doubt and not only by a hair."""
    bench = GraspEvaluator(outline, radius, Wanted(limits=ANY_HAND))
    triples, points = bench.triples()
    few = np.linspace(0, len(triples) - 1, min(TRIED, len(triples)), dtype=int)
    tried = [bench.at(triples[k], points[k]) for k in few]
    good = [
        c
        for c in tried
        if c is not None
        and c.score > 1.001
        and is_strict_minimum(ring, c.contacts, radius, margin=1e-3)
    ]
    return max(good, key=lambda c: c.score, default=None)


@cache
def specimen(name: str) -> Specimen:
    shape = next(s for s in VALID if s.name == name)
    outline, ring = Outline(shape.vertices), Ring.of(shape.vertices)
    points = held(outline, ring, 0.0) if shape.contacts is None else None
    contacts = shape.contacts if points is None else points.contacts
    assert contacts is not None, "every valid shape of the zoo has a grasp"
    assert is_strict_minimum(ring, contacts)
    radius = RADIUS * outline.diameter
    discs = held(outline, ring, radius)
    return Specimen(
        shape, outline, ring, plan(outline, contacts),
        None if discs is None else plan(outline, discs.contacts, radius), points,
    )  # fmt: skip


# ------------------------------------------------------------------ the laws


def _outline(one: Specimen) -> None:
    x, y = (one.outline.vertices - one.outline.vertices[0]).T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0.0
    again = Outline(one.outline.vertices)
    assert again.vertices.tobytes() == one.outline.vertices.tobytes()
    assert not one.outline.vertices.flags.writeable
    assert 0.0 < one.outline.area < one.size**2
    assert repr(one.outline).startswith("<Outline: ")


def _plan(one: Specimen) -> None:
    for cage in one.cages:
        assert cage.status in ("cage", "never_escapes")
        top = cage.sigma_largest if cage.sigma_max is None else cage.sigma_max
        assert top is not None
        first = top if cage.sigma_first is None else cage.sigma_first
        assert 0.0 < cage.sigma_0 <= first <= top
        if cage.sigma_max_upper is not None and cage.sigma_max is not None:
            assert cage.sigma_max <= cage.sigma_max_upper
        levels = [p.sigma for p in cage.punctures]
        assert levels == sorted(levels)
        if cage.status == "cage":
            assert cage.punctures[-1].sigma == cage.sigma_max
            assert cage.punctures[0].sigma == cage.sigma_first
        assert cage.adjusted_by <= 1e-5 * one.size
        for grasp in cage.grasps:
            assert cage.sigma_max is None or grasp.sigma < cage.sigma_max
            assert grasp.target == (grasp.id == 0)
            for p in grasp.contacts:
                assert one.ring.depth(p, cage.finger_radius) <= ROUNDING * one.size


def _both_methods(one: Specimen) -> None:
    other = plan(one.outline, one.cage.contacts, method=ContactSpace())
    assert disagreements(one.cage, other) == []
    assert len(other.grasps) == len(one.cage.grasps)


def _turned_shape(one: Specimen) -> None:
    """About a vertex, so that no digits are lost far from the origin."""
    for cage in one.cages:
        pivot = one.outline.vertices[0]
        ring = rotated(one.outline.vertices - pivot, 2.0)
        contacts = rotated(cage.contacts - pivot, 2.0)
        other = plan(Outline(ring), contacts, cage.finger_radius)
        # a million diameters away a coordinate keeps ten digits of the object, else sixteen
        lost = 1e-15 * float(np.abs(one.outline.vertices).max()) / one.size
        assert disagreements(cage, other, EXACT + 100.0 * lost) == []
        assert len(other.grasps) == len(cage.grasps)


def _relabelled_hand(one: Specimen) -> None:
    for first in (1, 2):
        other = plan(one.outline, np.roll(one.cage.contacts, -first, axis=0))
        for name in ("sigma_first", "sigma_max"):
            a, b = getattr(one.cage, name), getattr(other, name)
            assert (a is None) == (b is None)
            if a is not None:
                assert b / other.sigma_0 == pytest.approx(a / one.cage.sigma_0, rel=EXACT)


def _query(one: Specimen) -> None:
    for cage in one.cages:
        rows = np.array([g.placement.as_array() for g in cage.grasps])
        answers = query(cage, rows)
        told = [VERDICTS[v] for v in answers.verdict]
        assert told[0] == "target"
        assert set(told) <= {"target", "caged", "other"}
        assert answers.in_cage.all()
        for k, grasp in enumerate(cage.grasps):
            assert grasp.id in answers.grasps_of(k)
        far = rows[:1] + [10.0 * one.size, 0.0, 0.0, 0.0]
        assert VERDICTS[query(cage, far).verdict[0]] == "escapes"
        inside = one.outline.polygon.representative_point()
        deep = np.array([[inside.x, inside.y, 0.0, cage.sigma_0]])
        assert VERDICTS[query(cage, deep).verdict[0]] == "collision"


def _query_document(one: Specimen) -> None:
    for cage in one.cages:
        rows = np.array([g.placement.as_array() for g in cage.grasps])
        document = json.loads(json_text(query_document(query(cage, rows))))
        assert document["format"] == "icage-query/1"
        assert len(document["results"]) == len(rows)


@cache
def regions_of(one: Specimen) -> list[tuple[Cage, tuple[FingerRegion, ...]]]:
    """Rough ones, once for all laws; of discs (arcs of many vertices) on small shapes alone."""
    cages = one.cages if len(one.ring) <= MOST_VERTICES else [one.cage]
    return [(cage, caging_regions(cage, gap=0.1)) for cage in cages]


def _regions(one: Specimen) -> None:
    """Those of the points and of the discs hold the fingers of every grasp in the cage."""
    for cage, regions in regions_of(one):
        outer = [r.geometry for r in regions if r.bound == "outer"]
        inner = [r.geometry for r in regions if r.bound == "inner"]
        alone = outer_bounds(cage, gap=0.1)
        assert len(outer) == len(inner) == len(alone) == len(cage.contacts)
        for grasp in cage.grasps:
            # the true grasps of discs lie a sagitta off the polygon that was searched
            slack = 2e-8 * one.size + (0.0 if cage.work is None else 4.0 * cage.work.sagitta)
            for region, bound, p in zip(outer, alone, grasp.contacts, strict=True):
                assert region.distance(shapely.Point(p)) <= slack
                assert bound.distance(shapely.Point(p)) <= slack
        for low, high in zip(inner, outer, strict=True):
            assert low.difference(high.buffer(1e-8 * one.size)).area <= 1e-7 * high.area
            assert low.area > 0.0


def _escape_path(one: Specimen) -> None:
    for cage in one.cages:
        if cage.status == "never_escapes":
            assert cage.escape_path is None
            continue
        assert cage.escape_path is not None
        hand = unit_hand(cage.contacts)
        facts = path_facts(one.ring, hand, cage.escape_path, cage.contacts, cage.finger_radius)
        level = cage.sigma_max_upper if cage.finger_radius else cage.sigma_max
        assert level is not None
        assert facts.sigma_max <= level * (1.0 + EXACT)
        assert facts.sigma_end == 0.0
        assert facts.start_gap <= ROUNDING * one.size
        assert facts.depth <= ROUNDING * one.size
        assert cage.min_finger_gap is not None
        assert cage.min_finger_gap <= facts.finger_gap + ROUNDING * one.size


def _plan_document(one: Specimen) -> None:
    for cage, regions in [*regions_of(one), *((cage, ()) for cage in one.cages[1:])]:
        document = json.loads(json_text(plan_document(cage, regions, one.shape.name, "mm")))
        assert document["format"] == "icage-plan/1"
        assert document["sigma_max"] == cage.sigma_max
        assert document["grasps"][0]["contacts"] == np.asarray(cage.grasps[0].contacts).tolist()
        assert len(document["regions"]) == len(regions)
        assert any(line.startswith("sigma_0") for line in plan_summary(cage, "zoo", "mm"))


def _case_document(one: Specimen) -> None:
    """Out to a case file's text and in again: the same numbers and so the same answer."""
    for cage in one.cages:
        text = json.dumps(case_of(one.outline.vertices.tolist(), cage.contacts.tolist(),
                                  cage.finger_radius))  # fmt: skip
        case = parse_case(json.loads(text), Path())
        assert case.outline.vertices.tobytes() == one.outline.vertices.tobytes()
        assert case.contacts.tolist() == cage.contacts.tolist()


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
    try:
        rows = births_and_merges(one.outline, one.cage.hand)
    except InputError:
        assert len(one.ring) > 20
        return
    assert (rows[:, 1] > rows[:, 0]).all()
    assert np.abs(rows[:, 0] - one.cage.sigma_0).min() <= 1e-9 * one.size


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
    "Outline": _outline,
    "plan": _plan,
    "plan by contact space": _both_methods,
    "plan of the turned shape": _turned_shape,
    "plan of a relabelled hand": _relabelled_hand,
    "plan document": _plan_document,
    "case document": _case_document,
    "query": _query,
    "query document": _query_document,
    "caging_regions": _regions,
    "escape path": _escape_path,
    "best_grasps": _grasp_search,
    "grasps_of_hand": _grasps_of_hand,
    "births_and_merges": _sublevels_of_hand,
    "contact features": _features,
    "balance of forces": _statics,
    "exterior_pieces": _exterior_pieces,
    "offsets": _offsets,
}
"""Every public function of today: a new one is one line."""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", [shape.name for shape in VALID])
def test_law(name: str, law: str) -> None:
    LAWS[law](specimen(name))


def test_nearly_all_specimens_have_a_grasp_of_discs() -> None:
    without = [s.name for s in VALID if specimen(s.name).discs is None]
    assert len(without) <= len(VALID) // 6, without


@pytest.mark.parametrize("shape", WITHOUT_GRASP, ids=lambda s: s.name)
def test_shapes_without_a_grasp(shape: Shape) -> None:
    outline = Outline(shape.vertices)
    with pytest.raises(GraspError, match="no immobilizing"):
        best_grasps(outline, rng=np.random.default_rng(0))
    low, high = outline.vertices.min(0), outline.vertices.max(0)
    middle = 0.5 * (low + high)
    on = np.array([[low[0], middle[1]], [middle[0], low[1]], [high[0], middle[1]]])
    for method in (CELLS, ContactSpace()):
        cage = plan(outline, on, method=method)
        assert cage.status == "not_a_cage"
        assert cage.why
        assert cage.sigma_0 == cage.sigma_first == cage.sigma_max
    assert (offsets(outline, 0.1, 8).outer.area) > outline.area


# ------------------------------------------------------------------ what is refused


def case_of(vertices: Any, contacts: Any, radius: float = 0.0) -> dict[str, Any]:
    return {
        "format": "icage-case/1", "name": "zoo", "unit": "mm", "finger_radius": radius,
        "outline": {"vertices": vertices}, "grasp": {"contacts": contacts},
    }  # fmt: skip


THREE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.8]])
DOORS: dict[str, tuple[Callable[[Any], object], type[Exception]]] = {
    "Outline": (Outline, OutlineError),
    "parse_case": (lambda v: parse_case(case_of(v, THREE.tolist()), Path()), InputError),
    "parse_object": (lambda v: parse_object(case_of(v, []), Path()), InputError),
    "plan": (lambda v: plan(Outline(v), THREE), OutlineError),
    "plan of discs": (lambda v: plan(Outline(v), THREE, 0.1), OutlineError),
    "best_grasps": (
        lambda v: best_grasps(Outline(v), rng=np.random.default_rng(0)), OutlineError
    ),
    "grasps_of_hand": (lambda v: grasps_of_hand(Outline(v), HandShape(0.5 + 0.8j)), OutlineError),
    "births_and_merges": (
        lambda v: births_and_merges(Outline(v), HandShape(0.5 + 0.8j)), OutlineError
    ),
    "offsets": (lambda v: offsets(Outline(v), 0.1, 8), OutlineError),
    "exterior_pieces": (
        lambda v: exterior_pieces(Outline(v), HandShape(0.5 + 0.8j)), OutlineError
    ),
    "features": (lambda v: features_of(Outline(v)), OutlineError),
}  # fmt: skip
"""Every way in for an outline, and the error class it answers a refused one with."""


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("shape", REFUSED, ids=lambda s: s.name)
def test_refused(shape: Shape, door: str) -> None:
    enter, error = DOORS[door]
    with pytest.raises(error) as told:
        enter(shape.vertices)
    assert issubclass(shape.refused or IcageError, InputError)
    assert len(str(told.value)) > 10
    assert "\n" not in str(told.value)


WRONG_CONTACTS: dict[str, tuple[Floats, str]] = {
    "clockwise": (THREE[::-1], "clockwise"),
    "collinear": (np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), "collinear"),
    "coincident": (np.zeros((3, 2)), "coincide"),
    "two": (THREE[:2], "three finger centres"),
    "not a number": (np.full((3, 2), np.nan), "must be finite"),
}


@pytest.mark.parametrize("method", ["cells", "contact space", "discs"])
@pytest.mark.parametrize("name", WRONG_CONTACTS)
def test_contacts_that_are_no_hand_are_refused_by_every_method(name: str, method: str) -> None:
    contacts, message = WRONG_CONTACTS[name]
    outline = specimen("triangle").outline
    method: Method = ContactSpace() if method == "contact space" else CELLS
    with pytest.raises(InputError, match=message):
        plan(outline, contacts, 0.1 if method == "discs" else 0.0, method)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (np.zeros(4), "rows x, y, theta, sigma"),
        (np.zeros((2, 3)), "rows x, y, theta, sigma"),
        (np.array([[0, 0, 0, 1.0], [0, 0, 0, np.nan]]), "placement 1: numbers must be finite"),
        (np.array([[0, 0, 0, -1.0]]), "placement 0: sigma = -1.0; at least 0"),
    ],
)
def test_placements_that_are_none_are_refused(rows: Floats, message: str) -> None:
    with pytest.raises(InputError, match=message):
        query(specimen("triangle").cage, rows)


@pytest.mark.parametrize("level", [0.0, -1.0, np.nan, 1e9])
def test_levels_outside_the_cage_are_refused(level: float) -> None:
    for ask in (caging_regions, outer_bounds):
        with pytest.raises(InputError, match=r"above sigma_0 = .* is allowed"):
            ask(specimen("triangle").cage, level)
