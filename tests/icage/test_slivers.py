"""Pieces of the plane as thin as 1e-8 rad: nothing that gives a little reaches beyond their tips.

The outlines were found by fuzzing (docs/decisions/0020-fuzzing.md); they stand for their kind.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from icage.agreement import disagreements
from icage.arrays import FloatArray, IntArray
from icage.cells.free_space import FreeSpace
from icage.cells.kernels.facet import CLEARANCE, facet_of, middles_on_facets
from icage.cells.kernels.passes import new_room, pass_value
from icage.cells.kernels.plateau import translations
from icage.cells.membership import query
from icage.cells.query_tables import _pieces as piece_tables  # pyright: ignore[reportPrivateUsage]
from icage.contact_space.exploration import Plane
from icage.friction.kernels.polygon import keep_in_piece
from icage.geometry.exterior import Pieces
from icage.hand import HandShape
from icage.kernels.locate import holds
from icage.kernels.tips import SHARP, Tips, tips_of
from icage.outline import Outline
from icage.placement_class import PlacementCode
from icage.planner import plan
from icage.tolerance import SLIDE_GIVE

SPIKED_L = [
    [1.0, 0.0], [2.0, 0.0], [2.000000008746895, -1.6914326113211343e-08], [2.0, 1.0], [0.0, 1.0],
    [0.0, -1.0], [1.0, -1.0],
]  # fmt: skip
ON_L = [[1.711274279380465, 1.0], [0.0, -0.6692143742870347], [1.0, 0.0]]
"""Held to first order: finger 2 on the left, finger 3 in the concave corner."""

CROWN = [
    [0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 1.0], [0.0, 2.0],
    [-2.2448737989532235e-09, 2.000000060902411],
]  # fmt: skip
ON_CROWN = [[2.5, 1.25], [0.5, 1.75], [1.375, 0.0]]

HOOK = [
    [0.0, 0.375], [-0.375, 0.375], [-0.625, 0.0], [-0.625, -0.5], [-0.25, -0.875], [0.5, -1.0],
    [0.5, -0.875], [-0.125, -0.75], [-0.5, -0.375], [-0.5, 0.0], [-0.25, 0.25], [0.0, 0.25],
]  # fmt: skip
ON_HOOK = [
    [-0.6250070849784273, -0.12499999999999112], [0.060540865738416716, -0.926763993663286],
    [0.061701579878232604, -0.7873330906869965],
]  # fmt: skip
TINY = 7.08497842655825e-06

SPLIT_STAR = [
    [0.7665865592161866, 0.15642944919805526], [0.2662855181196872, 0.18459231370969081],
    [0.2519631016158469, 0.4267552324563057], [0.2519630833824118, 0.42675521478519857],
    [-0.085360339557639, 0.3572369184110417], [-0.08535829712289376, 0.3572379182544066],
    [-0.3672504270621414, 0.6307657225940796], [-0.6789288883824632, 0.5946007698101037],
    [-0.7026935609780954, -0.030166712115112154], [-0.7360933168553213, -0.26961821112009476],
    [-0.20740184432510933, -0.28030175557692105], [-0.015109459910769507, -0.33249768212824116],
    [0.10665694759429778, -0.7337807690693073], [0.5588032506880506, -0.5233818908109142],
    [0.5956562592639854, -0.2262261171892451],
]  # fmt: skip
ON_STAR = [
    [-0.015109459910769603, -0.332497682128241], [0.2662855181196872, 0.18459231370969081],
    [-0.085360339557639, 0.3572369184110417],
]  # fmt: skip
"""Held at three concave corners, one of them cut by an edge of 2e-6: the hand there can do nothing,
the one beside it is a cage."""

SPIKED_CROSS = [
    [1.0, 1.0], [0.0, 1.0], [0.0, 2.0], [-1.0, 2.0], [-1.0, 1.0], [-2.0, 1.0], [-2.0, 0.0],
    [-1.0, 0.0], [-1.0, -1.0], [-1.0000000016950048, -1.0000000004583827], [1.0, -1.0],
]  # fmt: skip
ON_CROSS = [[0.0, 1.0], [-1.0, 0.0], [-1.0, -0.6599151468273772]]
"""Finger 2 in the concave corner that is the tip of a sliver: a facet that is open by a hair only
had a hand 1e-4 beyond it, a minimum that is none."""


@pytest.mark.parametrize(
    ("ring", "contacts", "radius"),
    [
        (SPIKED_L, ON_L, 0.0),
        (CROWN, ON_CROWN, 0.0),
        (HOOK, ON_HOOK, TINY),
        (SPLIT_STAR, ON_STAR, 0.0),
        (SPIKED_CROSS, ON_CROSS, 0.0),
    ],
    ids=["slide", "region", "discs", "isolated", "facet"],
)
def test_methods_agree_where_pieces_are_slivers(
    ring: list[list[float]], contacts: list[list[float]], radius: float
) -> None:
    cells, space = (plan(ring, contacts, radius, method) for method in ("cells", "contact-space"))
    assert cells.status == "cage"
    assert disagreements(cells, space, 1e-9) == []
    assert len(cells.grasps) == len(space.grasps)
    assert not space.warnings


def spiked(angle: float, spin: float) -> tuple[Outline, FloatArray]:
    """The L, its lower right corner drawn out to a needle, and a grasp on it; both turned."""
    ring = np.array(SPIKED_L)
    ring[2] = [2.0 + 0.5 * angle, -angle]
    turn = np.array([[math.cos(spin), math.sin(spin)], [-math.sin(spin), math.cos(spin)]])
    return Outline(ring @ turn), np.array(ON_L) @ turn


@pytest.mark.parametrize("spin", [0.0, 2.9])
@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_a_hand_that_slides_stays_beside_its_pieces(angle: float, spin: float) -> None:
    outline, contacts = spiked(angle, spin)
    space = FreeSpace.around(outline, HandShape.from_contacts(contacts))
    cells, w = cells_at(space, contacts)
    shapes = shapes_of(space.pieces)
    looked_at = 0
    for cell in cells:
        for x, y in translations(space.pieces, space.z, cell, w.real, w.imag):
            fingers = complex(x, y) + w * (space.z @ [1.0, 1j])
            for finger, k in zip(fingers, cell, strict=True):
                off = shapes[k].distance(shapely.Point(finger.real, finger.imag))
                assert off <= 3.0 * SLIDE_GIVE * outline.diameter
            looked_at += 1
    assert looked_at


@pytest.mark.parametrize("spin", [0.0, 2.9])
@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_regions_of_slivers_keep_the_third_finger_in_them(angle: float, spin: float) -> None:
    outline, contacts = spiked(angle, spin)
    plane = Plane.around(outline, HandShape.from_contacts(contacts))
    space = plane.space
    slivers = np.flatnonzero(np.diff(space.tip_ptr) > 0)
    assert len(slivers)
    shapes = [
        shapely.Polygon(np.column_stack([space.slot_x[a:b], space.slot_y[a:b]]))
        for a, b in zip(space.ptr[:-1], space.ptr[1:], strict=True)
    ]
    looked_at = 0
    for c in slivers.tolist():
        for i, j, k in np.ndindex(3, space.edges, space.edges):
            region = np.array([i, j, k, c])
            for s, u in plane.corners(region):
                third = plane.fingers(plane.hand_at(region, float(s), float(u)))[(i + 2) % 3]
                off = shapes[c].distance(shapely.Point(float(third.real), float(third.imag)))
                assert off <= 25.0 * space.clip
                looked_at += 1
    assert looked_at


def test_a_point_beyond_the_tip_of_a_sliver_is_not_in_it() -> None:
    outline, pieces, tips = spiked_pieces(2e-8)
    give, seen = 1e-9 * outline.diameter, 0
    for k, shape in enumerate(shapes_of(pieces)):
        for tip in range(tips.tip_ptr[k], tips.tip_ptr[k + 1]):
            x, y = tips.tip_x[tip], tips.tip_y[tip]
            nx, ny = tips.tip_nx[tip], tips.tip_ny[tip]
            assert shape.distance(shapely.Point(x, y)) <= 1e-15
            for beyond, held in ((0.5, True), (2.0, False), (1e5, False)):
                px, py = x - beyond * give * nx, y - beyond * give * ny
                assert holds(pieces, k, px, py, give) == held
            seen += 1
    assert seen


@pytest.mark.parametrize("spin", [0.0, 2.9])
@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8, 2e-9])
def test_the_hand_of_a_pass_is_in_its_cell(angle: float, spin: float) -> None:
    outline, contacts = spiked(angle, spin)
    assert passes_in_their_cells(
        FreeSpace.around(outline, HandShape.from_contacts(contacts)), contacts
    )


@pytest.mark.parametrize("spin", [0.0, 1.0, 2.9])
def test_the_hand_of_a_pass_is_in_its_cell_though_the_facet_is_open_by_a_hair(spin: float) -> None:
    turn = np.array([[math.cos(spin), math.sin(spin)], [-math.sin(spin), math.cos(spin)]])
    outline, contacts = Outline(np.array(SPIKED_CROSS) @ turn), np.array(ON_CROSS) @ turn
    assert passes_in_their_cells(
        FreeSpace.around(outline, HandShape.from_contacts(contacts)), contacts
    )


def passes_in_their_cells(space: FreeSpace, contacts: FloatArray) -> int:
    """How many passes there are at the contacts; none has a finger outside its piece."""
    pieces, room, count = space.pieces, new_room(), 0
    shapes = shapes_of(pieces)
    for cell in cells_at(space, contacts)[0]:
        for finger in range(len(cell)):
            for slot in range(pieces.ptr[cell[finger]], pieces.ptr[cell[finger] + 1]):
                facet = facet_of(pieces, cell, finger, slot)
                low = pass_value(pieces, space.z, facet, space.cap, space.worst, room)
                if low.sigma == math.inf:
                    continue
                hands = middles_on_facets(
                    pieces, space.z, cell[None], np.array([finger]), np.array([slot]),
                    np.array([[low.w_x, low.w_y]]),
                )  # fmt: skip
                at = hands[0] @ [1.0, 1j, 0.0, 0.0] + hands[0] @ [0.0, 0.0, 1.0, 1j] * (
                    space.z @ [1.0, 1j]
                )
                for point, k in zip(at, cell, strict=True):
                    off = shapes[k].distance(shapely.Point(point.real, point.imag))
                    assert off <= 25.0 * CLEARANCE * pieces.diameter
                count += 1
    return count


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_a_finger_in_the_object_beyond_a_tip_collides(angle: float) -> None:
    outline, contacts = spiked(angle, 0.0)
    cage = plan(outline, contacts)
    assert cage.work is not None
    tips = spiked_tips(angle, 0.0)
    body = shapely.Polygon(outline.vertices)
    seen = 0
    for x, y, nx, ny in zip(tips.tip_x, tips.tip_y, tips.tip_nx, tips.tip_ny, strict=True):
        for beyond in (1e-7, 1e-5, 1e-3):
            finger = np.array([x - beyond * nx, y - beyond * ny])
            finger = finger + cage.work.search.free_space.origin
            if not shapely.buffer(body, -1e-8).contains(shapely.Point(finger)):
                continue
            for theta in np.linspace(0.0, 6.0, 7):
                assert (
                    query(cage, np.array([[*finger, theta, 0.3 * cage.sigma_0]])).verdict[0]
                    == PlacementCode.COLLISION
                )
            seen += 1
    assert seen


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_the_tables_of_a_page_hold_what_the_planner_holds(angle: float) -> None:
    outline, contacts = spiked(angle, 2.9)
    work = plan(outline, contacts).work
    assert work is not None
    tables, tips = piece_tables(work), spiked_tips(angle, 2.9)
    tolerance, seen = 1e-9 * outline.diameter, 0
    for k in range(work.search.free_space.pieces.total):
        rows = slice(tables.start[k], tables.start[k + 1])
        for tip in range(tips.tip_ptr[k], tips.tip_ptr[k + 1]):
            for beyond in (-0.5, 0.5, 2.0, 1e5):
                x = tips.tip_x[tip] - beyond * tolerance * tips.tip_nx[tip]
                y = tips.tip_y[tip] - beyond * tolerance * tips.tip_ny[tip]
                gaps = (tables.normals[rows] * ([x, y] - tables.corners[rows])).sum(axis=1)
                assert (gaps.min() >= -tolerance) == (beyond < 1.0)
                seen += 1
    assert seen


@pytest.mark.parametrize("angle", [1e-3, 1e-6, 2e-8])
def test_a_finger_of_a_jam_stays_beside_its_sliver(angle: float) -> None:
    outline, pieces, tips = spiked_pieces(angle)
    loose, seen = 1e-9 * outline.diameter, 0
    for k, shape in enumerate(shapes_of(pieces)):
        for tip in range(tips.tip_ptr[k], tips.tip_ptr[k + 1]):
            polygon, spare = np.zeros((64, 4)), np.empty((64, 4))
            around = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
            polygon[:4, :2] = around + [tips.tip_x[tip], tips.tip_y[tip]]
            n = keep_in_piece(pieces, k, np.zeros(2), loose, np.empty(5), polygon, 4, spare)
            assert n >= 3
            for x, y in polygon[:n, :2]:
                assert shape.distance(shapely.Point(x, y)) <= 25.0 * loose
            seen += 1
    assert seen


def test_tips_are_where_a_piece_is_sharp() -> None:
    _, pieces, tips = spiked_pieces(1e-3)
    for k, shape in enumerate(shapes_of(pieces)):
        ring = shapely.get_coordinates(shape.exterior)[:-1]
        ahead, back = np.roll(ring, -1, axis=0) - ring, np.roll(ring, 1, axis=0) - ring
        way = (ahead @ [1.0, 1j]) / (back @ [1.0, 1j])
        sharp = ring[np.abs(np.angle(way)) < 0.1]
        a, b = tips.tip_ptr[k : k + 2]
        assert np.column_stack([tips.tip_x[a:b], tips.tip_y[a:b]]).tolist() == sharp.tolist()
        inside = (ring[:, None] - np.column_stack([tips.tip_x, tips.tip_y])[a:b]) * np.column_stack(
            [tips.tip_nx, tips.tip_ny]
        )[a:b]
        assert (inside.sum(axis=2) >= 0.0).all()


def cells_at(space: FreeSpace, contacts: FloatArray) -> tuple[IntArray, complex]:
    """The cells (n, fingers) that meet at the contacts, and w there."""
    at = (contacts - space.origin) @ [1.0, 1j]
    near = [[k for k, p in enumerate(shapes_of(space.pieces))
             if p.distance(shapely.Point(a.real, a.imag)) < 1e-9] for a in at]  # fmt: skip
    cells = np.stack(np.meshgrid(*near, indexing="ij"), axis=-1).reshape(-1, len(at))
    return cells, complex(at[1] - at[0])


def spiked_tips(angle: float, spin: float) -> Tips:
    """The tips of the pieces round the object with its needle."""
    outline, contacts = spiked(angle, spin)
    pieces = FreeSpace.around(outline, HandShape.from_contacts(contacts)).pieces
    return tips_of(pieces, SHARP)


def spiked_pieces(angle: float) -> tuple[Outline, Pieces, Tips]:
    """The object with its needle, the pieces round it, and their tips."""
    outline, contacts = spiked(angle, 2.9)
    pieces = FreeSpace.around(outline, HandShape.from_contacts(contacts)).pieces
    return outline, pieces, tips_of(pieces, SHARP)


def shapes_of(pieces: Pieces) -> list[shapely.Polygon]:
    """The pieces as polygons."""
    corners = [
        pieces.slot_vertex[a:b] for a, b in zip(pieces.ptr[:-1], pieces.ptr[1:], strict=True)
    ]
    return [shapely.Polygon(np.column_stack([pieces.x[v], pieces.y[v]])) for v in corners]
