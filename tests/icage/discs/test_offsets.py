"""The grown object: chords inside the true curve, tangents outside, straight edges exact."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from icage.discs.offsets import Offsets, arcs, check_disc_contacts, directions_on_arcs, offsets
from icage.errors import GraspError
from icage.outline import Outline
from tests.oracles.geometry import Floats, Ring
from tests.oracles.polygons import FAMILIES
from tests.oracles.targets import random_target

seeds = st.integers(0, 2**32 - 1)
families = st.sampled_from(sorted(FAMILIES))
radii = st.floats(math.log(1e-3), math.log(0.4)).map(math.exp)
"""[diameter]"""
segment_counts = st.sampled_from([1, 2, 3, 8, 16, 33])

SQUARE = Outline([[0, 0], [1, 0], [1, 1], [0, 1]])
CASE = Outline([[0, 0], [6, 0], [6, 5], [3.2, 5], [3.2, 4], [5, 4], [5, 1], [1, 1], [1, 4],
                [2.8, 4], [2.8, 5], [0, 5]])  # fmt: skip
"""A room whose door is 0.4 wide."""
CHORD_AT_CONTACT = 1e-3
"""[rad] Half the chord that a contact on an arc rests on: closer to the arc's end see below."""
ROUNDING = 1e-12
"""[diameter] What a vertex of the union may be off by: the noding grid is 1e-15."""


def drawn(family: str, seed: int) -> Ring:
    return Ring.of(FAMILIES[family](np.random.default_rng(seed)))


def along(ring: Floats, per_edge: int = 7) -> Floats:
    """Points on a polygon's edges, its corners and middles among them, (k, 2)."""
    t = np.linspace(0.0, 1.0, per_edge)[:-1]
    after = np.roll(ring, -1, axis=0)
    return (ring[:, None] + t[None, :, None] * (after - ring)[:, None]).reshape(-1, 2)


def distances(outline: Outline, points: Floats) -> Floats:
    """From the filled object, (k,)."""
    return np.atleast_1d(shapely.distance(shapely.points(points), outline.polygon))


def sagitta_of(radius: float, segments: int) -> float:
    """Of a chord over a quadrant's share. No arc may be cut coarser than that."""
    return radius * (1.0 - math.cos(0.25 * math.pi / segments))


# ------------------------------------------------------------------ bounds


@settings(max_examples=60)
@given(families, seeds, radii, segment_counts)
def test_chords_lie_inside_and_tangents_outside(
    family: str, seed: int, radius: float, segments: int
) -> None:
    """Exactly: by the distance of points on both boundaries from the object."""
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    grown = offsets(outline, r, segments)
    slack = ROUNDING * ring.diameter
    inner = distances(outline, along(grown.inner.vertices))
    outer = distances(outline, along(grown.outer.vertices))
    assert inner.max() <= r + slack
    assert inner.min() >= r - grown.sagitta - slack
    assert outer.min() >= r - slack
    step = math.acos(1.0 - grown.sagitta / r)
    assert outer.max() <= r / math.cos(step) + slack
    assert grown.sagitta <= sagitta_of(r, segments) * (1.0 + 1e-9)


@settings(max_examples=40)
@given(families, seeds, radii)
def test_the_buffer_of_shapely_lies_between(family: str, seed: int, radius: float) -> None:
    """Its outer ring, at 512 segments a quadrant and with its own sagitta taken off."""
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    grown = offsets(outline, r, 8)
    true = shapely.Polygon(outline.polygon.buffer(r, quad_segs=512).exterior)
    slack = 1e-9 * ring.diameter + sagitta_of(r, 512)
    assert grown.inner.polygon.difference(true.buffer(slack)).area <= 1e-15 * true.area
    assert true.difference(grown.outer.polygon.buffer(slack)).area <= 1e-15 * true.area
    gap = grown.outer.area - grown.inner.area
    step = 2.0 * math.acos(1.0 - grown.sagitta / r)
    turned = sum(arc.turn for arc in arcs(outline, r))
    assert gap <= turned / step * r * r * (math.tan(0.5 * step) - 0.5 * math.sin(step)) * (1 + 1e-6)


@settings(max_examples=30)
@given(families, seeds, radii, segment_counts)
def test_the_sagitta_is_that_of_the_widest_chord(
    family: str, seed: int, radius: float, segments: int
) -> None:
    """Every arc is cut into the fewest equal parts of at most a quadrant's share."""
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    turns = [arc.turn for arc in arcs(outline, r)]
    parts = [max(1, math.ceil(t / (0.5 * math.pi) * segments - 1e-9)) for t in turns]
    widest = max(t / n for t, n in zip(turns, parts, strict=True))
    found = offsets(outline, r, segments).sagitta
    assert found == pytest.approx(r * (1.0 - math.cos(0.5 * widest)), rel=1e-6)


def grown_pockets(outline: Outline, r: float) -> int:
    return len(outline.polygon.buffer(r, quad_segs=64).interiors)


# ------------------------------------------------------------------ straight edges


@settings(max_examples=60)
@given(families, seeds, radii, segment_counts)
def test_straight_edges_are_exact(family: str, seed: int, radius: float, segments: int) -> None:
    """What of an edge's parallel is clear of all else lies on both boundaries."""
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    grown = offsets(outline, r, segments)
    edges = shapely.linestrings(np.stack([ring.starts, ring.ends], axis=1))
    reach = r / (1.0 - grown.sagitta / r)  # of a corner between tangents
    seen = 0
    for k in range(len(ring)):
        t = np.linspace(0.02, 0.98, 9)[:, None]
        points = ring.starts[k] + t * (ring.ends[k] - ring.starts[k]) + r * ring.normals[k]
        # open to the outside: nothing else comes near the way straight out
        far = points + 3.0 * (ring.diameter + r) * ring.normals[k]
        ways = shapely.linestrings(np.stack([points, far], axis=1))
        others = shapely.distance(ways[:, None], np.delete(edges, k)[None])
        clear = others.min(axis=1) > reach * (1.0 + 1e-6)
        for polygon in (grown.inner, grown.outer):
            off = shapely.distance(shapely.points(points[clear]), polygon.polygon.exterior)
            assert np.all(off <= ROUNDING * ring.diameter)
        seen += int(clear.sum())
    assume(seen > 0)


def test_a_square_by_hand() -> None:
    grown = offsets(SQUARE, 0.5, 1)
    quarter = 0.25 * math.pi
    assert grown.sagitta == pytest.approx(0.5 * (1.0 - math.cos(quarter)), rel=1e-12)
    assert len(grown.inner) == 8  # a chord at each corner
    # the tangents at both ends of an arc meet in the corner of a square
    assert len(grown.outer.polygon.simplify(0.0).exterior.coords) == 5
    assert grown.inner.area == pytest.approx(1.0 + 4 * 0.5 + 4 * 0.125, rel=1e-12)
    assert grown.outer.area == pytest.approx(4.0, rel=1e-12)


def test_collinear_and_repeated_vertices_make_no_arcs() -> None:
    middle = 0.5 * (SQUARE.vertices + np.roll(SQUARE.vertices, -1, axis=0))
    finer = Outline(np.stack([SQUARE.vertices, middle], axis=1).reshape(-1, 2))
    assert len(arcs(finer, 0.3)) == 4
    for name in ("inner", "outer"):
        one, other = (getattr(offsets(o, 0.3, 8), name) for o in (SQUARE, finer))
        assert one.polygon.symmetric_difference(other.polygon).area <= 1e-14


# ------------------------------------------------------------------ arcs


@given(families, seeds)
def test_arcs_turn_by_the_exterior_angles(family: str, seed: int) -> None:
    """One arc a convex vertex; all turns together are a full one and those of concave corners."""
    ring = drawn(family, seed)
    found = arcs(Outline(ring.vertices), 0.1 * ring.diameter)
    back = np.roll(ring.tangents, 1, axis=0)
    turn = np.arctan2(
        back[:, 0] * ring.tangents[:, 1] - back[:, 1] * ring.tangents[:, 0],
        (back * ring.tangents).sum(1),
    )
    convex = np.flatnonzero(~ring.concave)
    assert [a.vertex.tolist() for a in found] == ring.vertices[convex].tolist()
    assert [a.turn for a in found] == pytest.approx(turn[convex], abs=1e-12)
    total = sum(a.turn for a in found) + float(turn[ring.concave].sum())
    assert total == pytest.approx(2.0 * math.pi, abs=1e-10)


@given(families, seeds, radii)
def test_arcs_start_and_end_over_their_edges(family: str, seed: int, radius: float) -> None:
    ring = drawn(family, seed)
    r = radius * ring.diameter
    for arc in arcs(Outline(ring.vertices), r):
        q = int(np.flatnonzero((ring.vertices == arc.vertex).all(axis=1))[0])
        first, last = (
            arc.vertex + r * np.array([math.cos(a), math.sin(a)])
            for a in (arc.start, arc.start + arc.turn)
        )
        slack = 1e-12 * ring.diameter
        assert first == pytest.approx(arc.vertex + r * ring.normals[q - 1], abs=slack)
        assert last == pytest.approx(arc.vertex + r * ring.normals[q], abs=slack)
        assert arc.ends == pytest.approx(np.array([first, last]), abs=slack)


# ------------------------------------------------------------------ through


@settings(max_examples=60)
@given(families, seeds, radii, segment_counts, st.lists(st.floats(0.01, 0.99), max_size=3))
def test_wanted_directions_are_touched(
    family: str, seed: int, radius: float, segments: int, shares: list[float]
) -> None:
    """The outer polygon touches the true curve there, the inner has its normal, 1e-6 radii below.

    Where another part of the object covers the point of the arc, nothing is asked.
    """
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    found = arcs(outline, r)
    number = seed % len(found)
    arc = found[number]
    wanted = sorted({arc.start + s * arc.turn for s in shares})
    assume(0.01 * arc.turn > CHORD_AT_CONTACT)
    assume(all(b - a > 1e-4 for a, b in pairwise(wanted)))
    grown = offsets(outline, r, segments, {number: tuple(wanted)})
    shell = shapely.Polygon(outline.polygon.buffer(r, quad_segs=256).exterior).exterior
    slack = ROUNDING * ring.diameter
    for direction in wanted:
        way = np.array([math.cos(direction), math.sin(direction)])
        spot = shapely.Point(arc.vertex + r * way)
        others = np.array([ring.nearest_on_edges(arc.vertex + r * way)[1]])
        open_there = float(others.min()) > r * (1.0 - 1e-9) and shell.distance(spot) < 1e-3 * r
        if not open_there:
            continue
        assert grown.outer.polygon.exterior.distance(spot) <= slack
        below = grown.inner.polygon.exterior.distance(spot)
        assert below <= 1e-6 * r + slack
        if others[others > r * (1.0 + 1e-9)].min(initial=np.inf) > 1.01 * r:
            normal = normal_at(grown.inner, arc.vertex + r * way)
            assert abs(float(normal @ way) - 1.0) <= 1e-9 or below <= slack


@pytest.mark.parametrize("before_the_end", [2e-3, 5e-4, 1e-5])
def test_a_contact_near_the_end_of_an_arc_rests_on_its_own_normal(before_the_end: float) -> None:
    direction = -before_the_end  # corner (1, 0) of the square: its arc runs from -90 to 0 degrees
    way = np.array([math.cos(direction), math.sin(direction)])
    grown = offsets(SQUARE, 0.5, 16, {1: (direction,)})
    normal = normal_at(grown.inner, np.array([1.0, 0.0]) + 0.5 * way)
    assert normal == pytest.approx(way, abs=1e-6)


def normal_at(polygon: Outline, point: Floats) -> Floats:
    """Outward normal of the edge nearest to a point."""
    ring = Ring.of(polygon.vertices)
    return ring.normals[int(np.argmin(ring.nearest_on_edges(point)[1]))]


@settings(max_examples=40)
@given(families, seeds, st.floats(0.01, 0.2))
def test_directions_on_arcs_are_those_of_the_contacts(
    family: str, seed: int, radius: float
) -> None:
    """Finger centres set on arcs are found there; those over edges are on none."""
    ring = drawn(family, seed)
    outline, r, rng = Outline(ring.vertices), radius * ring.diameter, np.random.default_rng(seed)
    found = arcs(outline, r)
    numbers = rng.integers(len(found), size=2).tolist()
    angle = [found[k].start + rng.uniform(0.05, 0.95) * found[k].turn for k in numbers]
    centres = [
        found[k].vertex + r * np.array([math.cos(a), math.sin(a)])
        for k, a in zip(numbers, angle, strict=True)
    ]
    e = int(rng.integers(len(ring)))
    flat = 0.5 * (ring.starts[e] + ring.ends[e]) + r * ring.normals[e]
    told = directions_on_arcs(outline, r, np.array([*centres, flat]))
    for k, a in zip(numbers, angle, strict=True):
        assert any(abs(math.remainder(t - a, 2.0 * math.pi)) < 1e-9 for t in told[k])
    for k, arc in enumerate(found):
        on = [abs(float(np.hypot(*(c - arc.vertex))) - r) for c in (*centres, flat)]
        assert len(told.get(k, ())) <= sum(gap <= 1e-6 * ring.diameter for gap in on)


# ------------------------------------------------------------------ pockets


@pytest.mark.parametrize(("radius", "closed"), [(0.1, 0), (0.19, 0), (0.21, 1), (0.5, 1), (2, 0)])
def test_a_room_closes_when_its_door_does(radius: float, closed: int) -> None:
    """The door is 0.4 wide; at a radius of 1.5 and more the room itself is full."""
    grown = offsets(CASE, radius, 16)
    assert grown.closed_pockets == closed
    inside = shapely.Point(3.0, 2.5)
    assert grown.inner.polygon.contains(inside) == (radius > 0.2)
    if closed:
        assert distances(CASE, along(grown.inner.vertices)).min() >= radius - grown.sagitta - 1e-9


def test_two_rooms_count_twice() -> None:
    two = Outline(
        np.vstack([CASE.vertices, [[0, 4.5], [-0.2, 4.5], [-0.2, 4.0], [-1, 4], [-1, 1], [-4, 1],
                   [-4, 4], [-1.2, 4], [-1.2, 4.5], [-5, 4.5], [-5, 0]]])
    )  # fmt: skip
    assert offsets(two, 0.15, 16).closed_pockets == grown_pockets(two, 0.15) == 1
    assert offsets(two, 0.25, 16).closed_pockets == grown_pockets(two, 0.25) == 2


@settings(max_examples=30)
@given(st.sampled_from(["comb", "spiral", "star", "random"]), seeds, st.floats(0.005, 0.2))
def test_pockets_are_counted_as_by_shapely(family: str, seed: int, radius: float) -> None:
    ring = drawn(family, seed)
    outline, r = Outline(ring.vertices), radius * ring.diameter
    counts = {grown_pockets(outline, r * f) for f in (0.97, 1.0, 1.03)}
    assume(len(counts) == 1)
    assert offsets(outline, r, 64).closed_pockets in counts


# ------------------------------------------------------------------ units and frames


@settings(max_examples=30)
@given(families, seeds, radii, st.sampled_from([1e-6, 1e-3, 1e3, 1e6]))
def test_the_unit_does_not_matter(family: str, seed: int, radius: float, unit: float) -> None:
    ring = drawn(family, seed)
    r = radius * ring.diameter
    one = offsets(Outline(ring.vertices), r, 8)
    other = offsets(Outline(unit * ring.vertices), unit * r, 8)
    check_same(one, other, unit, 1e-11)


@settings(max_examples=30)
@given(families, seeds, radii, st.sampled_from([1e2, 1e4]))
def test_far_from_the_origin(family: str, seed: int, radius: float, far: float) -> None:
    ring = drawn(family, seed)
    r = radius * ring.diameter
    one = offsets(Outline(ring.vertices), r, 8)
    other = offsets(Outline(ring.vertices + [far, -far]), r, 8)
    check_same(one, other, 1.0, 1e-14 * far + 1e-11)


def check_same(one: Offsets, other: Offsets, unit: float, within: float) -> None:
    for name in ("inner", "outer"):
        a, b = getattr(one, name), getattr(other, name)
        assert b.area / unit**2 == pytest.approx(a.area, rel=10.0 * within)
        assert b.diameter / unit == pytest.approx(a.diameter, rel=within)
    assert other.closed_pockets == one.closed_pockets
    assert other.sagitta / unit == pytest.approx(one.sagitta, rel=1e-5)


# ------------------------------------------------------------------ contacts of discs


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_contacts_at_the_radius_are_accepted_and_others_named(family: str) -> None:
    rng = np.random.default_rng(5)
    for _ in range(4):
        target = random_target(rng, family, 0.03)
        outline, contacts = Outline(target.vertices), target.contacts
        grown = offsets(outline, target.radius, 16).inner
        swallowed = shapely.distance(shapely.points(contacts), grown.polygon.exterior)
        if np.max(swallowed) > 0.005 * target.radius:
            with pytest.raises(GraspError, match="lies in a pocket"):
                check_disc_contacts(outline, target.radius, contacts)
            continue
        check_disc_contacts(outline, target.radius, contacts)
        finger = int(rng.integers(3))
        off = contacts.copy()
        off[finger] += 3.0 * target.radius * (contacts[finger] - contacts.mean(0))
        ring = Ring.of(target.vertices)
        if abs(ring.depth(off[finger], target.radius)) > 2e-6 * ring.diameter:
            with pytest.raises(GraspError, match=rf"contact {finger + 1} is .* is needed"):
                check_disc_contacts(outline, target.radius, off)


def test_refused_disc_contacts() -> None:
    inside = np.array([[0.5, 0.1], [1.1, 0.5], [0.5, 1.1]])
    with pytest.raises(GraspError, match=r"contact 1 is -0\.1 from the outline; .* radius 0\.1"):
        check_disc_contacts(SQUARE, 0.1, inside)
    near = np.array([[0.4, -0.1], [0.59, -0.1], [0.5, 1.1]])
    with pytest.raises(GraspError, match=r"fingers 1 and 2 overlap: .* 0\.19 apart.* 2 x 0\.1"):
        check_disc_contacts(SQUARE, 0.1, near)
    room = np.array([[3.0, 1.3], [3.0, 5.3 + 0.0], [-0.3, 2.5]])
    with pytest.raises(GraspError, match="contact"):
        check_disc_contacts(CASE, 0.3, room)
    pocket = np.array([[-0.3, 2.5], [3.0, 1.3], [6.3, 2.5]])
    with pytest.raises(GraspError, match=r"contact 2 lies in a pocket .* radius 0\.3"):
        check_disc_contacts(CASE, 0.3, pocket)
